//! Pictures for textures: decoded once a scene, replaced by a visible fallback when they cannot be.
//!
//! Eight bits a channel: brighter texels of a Radiance HDR are cut off at 1.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::environment::Texels;
use super::quote::file_name;
use super::source::{read_regular, Unread};
use super::{LoadError, Sources};
use crate::memory::{Budget, Shortage};
use crate::srgb::srgb_to_linear;
use crate::{Image, Scene};

/// Most texels in a row or a column.
const MAX_SIDE: u32 = 32_768;
/// Most bytes that a decoder may hold.
const MAX_BYTES: u64 = 1 << 30;
/// Below this many decoded bytes a picture is never called a bomb.
const HARMLESS_BYTES: u64 = 64 << 20;
/// No honest picture is packed tighter: deflate, the densest of the formats that pack real pictures, ends at 1032 to 1.
const MAX_RATIO: u64 = 1100;

/// Who asks for a picture, for the warning.
#[derive(Clone, Copy)]
pub(super) struct Asker<'a> {
    pub path: &'a Path,
    pub line: Option<usize>,
}

/// Where pictures were put: a hint, as one set of sources may feed several scenes.
#[derive(Default)]
pub(super) struct ImageIndices(HashMap<String, u32>);

impl ImageIndices {
    /// The scene's picture of that name. A name never seen is not searched for: scenes may name many thousands.
    fn find(&self, name: &str, scene: &Scene) -> Option<u32> {
        let hint = *self.0.get(name)?;
        if scene.images.get(hint as usize).is_some_and(|image| image.name == name) {
            return Some(hint);
        }
        scene.images.iter().position(|image| image.name == name).and_then(|index| u32::try_from(index).ok())
    }
}

/// Index in `scene.images` of the picture in a file. A missing or broken one is a warning and a magenta checker.
pub(super) fn from_file(path: &Path, asker: Asker, scene: &mut Scene, sources: &mut Sources) -> Result<u32, LoadError> {
    // `a/./b.png` and `a//b.png` are one picture.
    let path: PathBuf = path.components().collect();
    let name = path.to_string_lossy();
    if let Some(index) = sources.images.find(&name, scene) {
        return Ok(index);
    }
    sources.note(&path);
    let budget = sources.budget().clone();
    let decoded = read(&path, &budget).and_then(|bytes| decode(&name, &bytes, &budget));
    add(&name, decoded, asker, scene, sources)
}

/// Index in `scene.images` of an encoded picture in memory (PNG, JPEG, ...), under a name of its own.
pub(super) fn from_bytes(
    name: &str,
    bytes: &[u8],
    asker: Asker,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<u32, LoadError> {
    if let Some(index) = sources.images.find(name, scene) {
        return Ok(index);
    }
    let decoded = decode(name, bytes, sources.budget());
    add(name, decoded, asker, scene, sources)
}

/// Index in `scene.images` of what stands in for a picture that is not to be had, for a reason given as a phrase.
pub(super) fn missing(
    name: &str,
    reason: String,
    asker: Asker,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<u32, LoadError> {
    match sources.images.find(name, scene) {
        Some(index) => Ok(index),
        None => add(name, Err(Unusable::Reason(reason)), asker, scene, sources),
    }
}

/// Why a picture cannot be used.
#[derive(Debug, PartialEq)]
pub(super) enum Unusable {
    /// A phrase. Something else can stand in for the picture.
    Reason(String),
    /// There is no room for it.
    Memory(Shortage),
}

impl From<String> for Unusable {
    fn from(reason: String) -> Self {
        Self::Reason(reason)
    }
}

fn add(
    name: &str,
    decoded: Result<Image, Unusable>,
    asker: Asker,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<u32, LoadError> {
    let image = match decoded {
        Ok(image) => image,
        Err(Unusable::Memory(shortage)) => {
            let what = format!("the image {}", file_name(name));
            return Err(LoadError::Memory { path: asker.path.to_owned(), what, shortage });
        }
        Err(Unusable::Reason(reason)) => {
            let message = format!(
                "the image {} cannot be used: {reason}; a magenta checker stands in for its colours",
                file_name(name)
            );
            sources.warn(asker.path, asker.line, message)?;
            checker(name)
        }
    };
    let index = u32::try_from(scene.images.len()).map_err(|_| too_many(asker.path))?;
    scene.images.push(image);
    sources.images.0.insert(name.to_owned(), index);
    Ok(index)
}

/// The bytes of a regular file: a pipe or a device might never end.
fn read(path: &Path, budget: &Budget) -> Result<Vec<u8>, Unusable> {
    read_regular(path, budget).map_err(|unread| match unread {
        Unread::Io(error) => Unusable::Reason(error.to_string()),
        Unread::NotAFile { is_directory: true } => Unusable::Reason("it is a directory".to_owned()),
        Unread::NotAFile { is_directory: false } => Unusable::Reason("it is not a regular file".to_owned()),
        Unread::Memory(shortage) => Unusable::Memory(shortage),
    })
}

fn decode(name: &str, bytes: &[u8], budget: &Budget) -> Result<Image, Unusable> {
    let image = picture(name, bytes, budget, 4)?;
    let (width, height) = (image.width(), image.height());
    Ok(Image { name: name.to_owned(), width, height, texels: rgba(image) })
}

/// The same as radiance: what is not that already is display light, and sRGB.
pub(super) fn radiance(name: &str, bytes: &[u8], budget: &Budget) -> Result<Texels, Unusable> {
    let image = picture(name, bytes, budget, 12)?;
    let size = [image.width(), image.height()];
    let is_linear = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let linear = |channel: f32| if is_linear { channel } else { srgb_to_linear(channel) };
    Ok((size, image.into_rgb32f().pixels().map(|pixel| pixel.0.map(linear)).collect()))
}

/// A picture that takes so many bytes a texel where it is kept.
fn picture(name: &str, bytes: &[u8], budget: &Budget, texel: u64) -> Result<DynamicImage, Unusable> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);

    let mut reader = ImageReader::new(Cursor::new(bytes));
    // TGA has no signature: the name decides where the contents do not.
    if let Ok(format) = ImageFormat::from_path(name) {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format().map_err(|error| error.to_string())?;
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder().map_err(sentence)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (u64::from(width), u64::from(height));
    check_size(width, height, bytes.len() as u64)?;
    limits.reserve(decoder.total_bytes()).map_err(sentence)?;
    take(budget, decoder.total_bytes(), texel * width * height)?;
    decoder.set_limits(limits).map_err(sentence)?;
    Ok(DynamicImage::from_decoder(decoder).map_err(sentence)?)
}

/// Takes room for texels; besides, there has to be room for what a decoder and the conversion hold for a moment: what the
/// decoder gives, its own (a progressive JPEG has all coefficients, 16 bits each), and the texels once more.
fn take(budget: &Budget, decoded: u64, texels: u64) -> Result<(), Unusable> {
    let peak = decoded.saturating_mul(3).saturating_add(2 * texels);
    budget.fits(peak).and_then(|()| budget.take(texels)).map_err(Unusable::Memory)
}

/// Refuses what is empty, too large, or far too large for its file: a header is not worth gigabytes.
pub(super) fn check_size(width: u64, height: u64, file_bytes: u64) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err(format!("it has {width}x{height} texels"));
    }
    if width > u64::from(MAX_SIDE) || height > u64::from(MAX_SIDE) {
        return Err(format!("it has {width}x{height} texels and the limit is {MAX_SIDE}x{MAX_SIDE}"));
    }
    let decoded = 4 * width * height;
    let limit = file_bytes.saturating_mul(MAX_RATIO).clamp(HARMLESS_BYTES, MAX_BYTES);
    if decoded > limit {
        return Err(format!(
            "its {width}x{height} texels would take {decoded} bytes, and the limit for a file of {file_bytes} bytes is \
             {limit}"
        ));
    }
    Ok(())
}

fn rgba(image: DynamicImage) -> Vec<[u8; 4]> {
    image.into_rgba8().pixels().map(|pixel| pixel.0).collect()
}

/// A decoder's reason, on one line.
fn sentence(error: image::ImageError) -> String {
    let text = error.to_string();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    file_name(text.trim_end_matches('.'))
}

/// Magenta and black: seen at once, and in no real scene.
fn checker(name: &str) -> Image {
    const SIDE: u32 = 8;
    let texel = |i: u32| if (i % SIDE + i / SIDE).is_multiple_of(2) { [255, 0, 255, 255] } else { [0, 0, 0, 255] };
    Image { name: name.to_owned(), width: SIDE, height: SIDE, texels: (0..SIDE * SIDE).map(texel).collect() }
}

/// Whether the picture is the fallback: fit to show that a colour is missing, but not to bend normals or to cut holes.
pub(super) fn is_fallback(image: &Image) -> bool {
    let fallback = checker("");
    (image.width, image.height) == (fallback.width, fallback.height) && image.texels == fallback.texels
}

fn too_many(path: &Path) -> LoadError {
    LoadError::TooLarge {
        path: path.to_owned(),
        place: super::Place::File,
        what: format!("more than {} images", u32::MAX),
        help: "Split the scene.".to_owned(),
    }
}

#[cfg(test)]
mod tests;
