//! Textures: which picture, which coordinates, how sampled.

use ::gltf::json::deserialize::from_value;
use ::gltf::json::extensions::texture::TextureTransform;
use ::gltf::json::material::NormalTexture;
use ::gltf::json::texture::{Info, MagFilter, Sampler, WrappingMode};
use ::gltf::json::validation::Checked;

use super::super::images::{self, Asker};
use super::super::quote::file_name;
use super::super::LoadError;
use super::material::Sets;
use super::origin::Origin;
use super::uri::{resolve, Resource};
use super::Reader;
use crate::{Filter, Image, Scene, Texture, UvSet, Wrap};

/// A material's use of a texture.
pub(super) struct Slot {
    texture: usize,
    /// Which set of texture coordinates.
    pub set: u32,
    transform: Option<TextureTransform>,
}

impl Slot {
    fn new(texture: usize, set: u32, transform: Option<TextureTransform>) -> Self {
        let set = transform.as_ref().and_then(|transform| transform.tex_coord).unwrap_or(set);
        Self { texture, set, transform }
    }

    /// A normal map. The `gltf` crate leaves the transform of these unparsed.
    pub fn of_normal_map(origin: Origin, map: &NormalTexture) -> Result<Self, LoadError> {
        let value = map.extensions.as_ref().and_then(|extensions| extensions.others.get("KHR_texture_transform"));
        let transform = value.map(|value| from_value(value.clone())).transpose().map_err(|error| {
            origin.broken(
                format!("the KHR_texture_transform of a normal map: {}", file_name(&error.to_string())),
                "offset, rotation and scale",
            )
        })?;
        Ok(Self::new(map.index.value(), map.tex_coord, transform))
    }
}

impl From<&Info> for Slot {
    fn from(info: &Info) -> Self {
        let extensions = info.extensions.as_ref();
        Self::new(info.index.value(), info.tex_coord, extensions.and_then(|e| e.texture_transform.clone()))
    }
}

/// A texture of colours. A picture that is not to be had is replaced by one that shows it.
pub(super) fn read_color(reader: &mut Reader, slot: &Slot, sets: Sets) -> Result<Option<Texture>, LoadError> {
    read(reader, slot, sets, true)
}

/// A texture of numbers, such as normals. `None` also where its picture is not to be had: nothing can stand in for it.
pub(super) fn read_data(reader: &mut Reader, slot: &Slot, sets: Sets) -> Result<Option<Texture>, LoadError> {
    let texture = read(reader, slot, sets, false)?;
    Ok(texture.filter(|texture| !images::is_fallback(&reader.scene.images[texture.image as usize])))
}

/// The texture of a slot, its picture decoded. `None`, and a warning, where it names no picture.
fn read(reader: &mut Reader, slot: &Slot, sets: Sets, srgb: bool) -> Result<Option<Texture>, LoadError> {
    let Some(source) = source(reader, slot)? else { return Ok(None) };
    let image = match reader.cache.images.get(&source) {
        Some(&image) => image,
        None => {
            let mut scene = std::mem::take(&mut reader.scene);
            let decoded = decode(reader, source, &mut scene);
            reader.scene = scene;
            *reader.cache.images.entry(source).or_insert(decoded?)
        }
    };
    let mut texture = Texture::new(image, srgb);
    texture.uv_set = if sets[1] == Some(slot.set) { UvSet::Second } else { UvSet::First };
    if let Some(sampler) = reader.root.textures[slot.texture].sampler {
        let sampler = reader.root.samplers.get(sampler.value()).ok_or_else(|| {
            let read = format!("textures[{}] uses samplers[{sampler}]", slot.texture);
            reader.origin.broken(read, format!("an index below {}", reader.root.samplers.len()))
        })?;
        texture.wrap = [wrap(sampler.wrap_s), wrap(sampler.wrap_t)];
        texture.filter = filter(sampler);
    }
    if let Some(transform) = &slot.transform {
        texture.transform = with_v_up(transform);
    }
    Ok(Some(texture))
}

/// The mean texel of a slot's picture, as it stands in the file, from 0 to 1; ones where there is none to be had.
///
/// Only its mean is used: a picture that is not in the scene for another reason is not kept.
pub(super) fn mean(reader: &mut Reader, slot: &Slot) -> Result<[f32; 4], LoadError> {
    let Some(source) = source(reader, slot)? else { return Ok([1.0; 4]) };
    if let Some(&mean) = reader.cache.means.get(&source) {
        return Ok(mean);
    }
    let mean = match reader.cache.images.get(&source) {
        Some(&index) => mean_texel(&reader.scene.images[index as usize]),
        None => {
            let mut scratch = Scene::default();
            let index = decode(reader, source, &mut scratch)?;
            mean_texel(&scratch.images[index as usize])
        }
    };
    reader.cache.means.insert(source, mean);
    Ok(mean)
}

fn mean_texel(image: &Image) -> [f32; 4] {
    if images::is_fallback(image) {
        return [1.0; 4];
    }
    let mut sums = [0u64; 4];
    for texel in &image.texels {
        for (sum, &value) in sums.iter_mut().zip(texel) {
            *sum += u64::from(value);
        }
    }
    sums.map(|sum| (sum as f64 / (255.0 * image.texels.len().max(1) as f64)) as f32)
}

/// Index of the picture of a slot; WebP where the file has it.
fn source(reader: &mut Reader, slot: &Slot) -> Result<Option<usize>, LoadError> {
    let textures = &reader.root.textures;
    let texture = textures.get(slot.texture).ok_or_else(|| {
        let expected = format!("an index below {}, the number of textures", textures.len());
        reader.origin.broken(format!("a material uses textures[{}]", slot.texture), expected)
    })?;
    let extensions = texture.extensions.as_ref();
    let webp = extensions.and_then(|e| e.others.get("EXT_texture_webp")?.get("source")?.as_u64());
    let plain = texture.source.value();
    // The `gltf` crate's value for a texture without a source.
    let none = u32::MAX as usize;
    let source = webp.and_then(|source| usize::try_from(source).ok()).unwrap_or(plain);
    if source == none {
        reader.warn(format!("textures[{}] names no picture that raywarp can read: it is left out", slot.texture))?;
        return Ok(None);
    }
    Ok(Some(source))
}

fn decode(reader: &mut Reader, index: usize, scene: &mut Scene) -> Result<u32, LoadError> {
    let (origin, root, buffers) = (reader.origin, reader.root, reader.buffers);
    let owner = format!("images[{index}]");
    let image = root.images.get(index).ok_or_else(|| {
        let expected = format!("an index below {}, the number of images", root.images.len());
        origin.broken(format!("a texture uses {owner}"), expected)
    })?;
    let asker = Asker { path: origin.path, line: None };
    let name = format!("{}#{owner}", origin.path.display());
    match (&image.uri, image.buffer_view) {
        (Some(uri), _) => match resolve(origin, &owner, uri) {
            Ok(Resource::File(path)) => images::from_file(&path, asker, scene, reader.sources),
            Ok(Resource::Bytes(bytes)) => images::from_bytes(&name, &bytes, asker, scene, reader.sources),
            Err(error) => images::missing(&name, reason(error)?, asker, scene, reader.sources),
        },
        (None, Some(view)) => {
            let bytes = buffers.view(origin, &owner, view)?.bytes;
            images::from_bytes(&name, bytes, asker, scene, reader.sources)
        }
        (None, None) => Err(origin.broken(format!("{owner} has neither uri nor bufferView"), "one of them")),
    }
}

/// Why a URI leads to no picture, as a phrase. That is no reason to refuse all the rest.
fn reason(error: LoadError) -> Result<String, LoadError> {
    match error {
        LoadError::Unsupported { what, .. } => Ok(format!("{what} is not supported")),
        LoadError::Syntax { read, expected, .. } => Ok(format!("{read}; expected {expected}")),
        other => Err(other),
    }
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}

/// There are no smaller copies of pictures, so the filter for magnification is the one used.
fn filter(sampler: &Sampler) -> Filter {
    match sampler.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => Filter::Nearest,
        _ => Filter::Bilinear,
    }
}

/// The map of KHR_texture_transform, `translation * rotation * scale` with v down, for coordinates with v up.
///
/// A positive rotation turns coordinates counter-clockwise as seen in the picture. With `v = 1 - V` on both sides the
/// rows follow by substitution.
fn with_v_up(transform: &TextureTransform) -> [[f32; 3]; 2] {
    let ([offset_u, offset_v], [scale_u, scale_v]) = (transform.offset.0, transform.scale.0);
    let (sin, cos) = transform.rotation.0.sin_cos();
    let rows = [
        [cos * scale_u, -sin * scale_v, sin * scale_v + offset_u],
        [sin * scale_u, cos * scale_v, 1.0 - cos * scale_v - offset_v],
    ];
    match rows.iter().flatten().all(|value| value.is_finite()) {
        true => rows,
        false => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::gltf::json::extensions::texture::{TextureTransformOffset, TextureTransformRotation, TextureTransformScale};

    /// The specification's formula, v down.
    fn specified(offset: [f32; 2], rotation: f32, scale: [f32; 2], [u, v]: [f32; 2]) -> [f32; 2] {
        let (sin, cos) = rotation.sin_cos();
        let (u, v) = (u * scale[0], v * scale[1]);
        [cos * u + sin * v + offset[0], -sin * u + cos * v + offset[1]]
    }

    #[test]
    fn transforms_with_v_up_reach_the_same_texel() {
        let (offset, rotation, scale) = ([0.25, -0.5], 0.7, [2.0, 3.0]);
        let rows = with_v_up(&TextureTransform {
            offset: TextureTransformOffset(offset),
            rotation: TextureTransformRotation(rotation),
            scale: TextureTransformScale(scale),
            ..TextureTransform::default()
        });
        for uv in [[0.0, 0.0], [1.0, 0.0], [0.3, 0.9]] {
            let expected = specified(offset, rotation, scale, uv);
            let up = [uv[0], 1.0 - uv[1], 1.0];
            let [u, v] = rows.map(|row| row.iter().zip(up).map(|(a, b)| a * b).sum::<f32>());
            assert!((u - expected[0]).abs() < 1e-5 && (1.0 - v - expected[1]).abs() < 1e-5);
        }
    }

    #[test]
    fn no_transform_is_the_identity() {
        assert_eq!(with_v_up(&TextureTransform::default()), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }
}
