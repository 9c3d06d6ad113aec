//! Environments: pictures of radiance, .hdr and .exr, or any other picture as display light.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use exr::meta::MetaData;
use exr::prelude::{read, ReadChannels, ReadLayers};

use super::images::{self, Unusable};
use super::{LoadError, LoadOptions, Place, Sources};
use crate::memory::Budget;
use crate::{Environment, Radiance};

/// Reads a picture as the environment of a scene, neither turned nor scaled.
///
/// # Errors
/// [`LoadError`] for a file that is missing, too large for the memory of this machine, or no picture.
pub fn environment(path: &Path, options: &LoadOptions) -> Result<Environment, LoadError> {
    from_file(path, &mut Sources::new(options))
}

/// The same as part of a scene.
pub(super) fn from_file(path: &Path, sources: &mut Sources) -> Result<Environment, LoadError> {
    let bytes = sources.bytes(path)?;
    let name = path.to_string_lossy();
    let picture = decode(&name, &bytes, sources.budget()).map_err(|unusable| match unusable {
        Unusable::Memory(shortage) => LoadError::memory(path, "the environment")(shortage),
        Unusable::Reason(reason) => LoadError::Unsupported {
            path: path.to_owned(),
            place: Place::File,
            what: format!("this picture as an environment ({reason})"),
            help: "Convert it to Radiance HDR or OpenEXR.".to_owned(),
        },
    })?;
    Ok(Environment { picture: Arc::new(picture), rotation: 0.0, strength: 1.0 })
}

/// Bytes that an OpenEXR file begins with.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

fn decode(name: &str, bytes: &[u8], budget: &Budget) -> Result<Radiance, Unusable> {
    let ([width, height], mut texels) = match bytes.starts_with(&EXR) {
        true => exr(bytes, budget)?,
        false => images::radiance(name, bytes, budget)?,
    };
    for channel in texels.iter_mut().flatten() {
        // What is not light is none.
        *channel = if *channel > 0.0 { channel.min(f32::MAX) } else { 0.0 };
    }
    Ok(Radiance { name: name.to_owned(), width, height, texels })
}

/// Size and texels.
pub(super) type Texels = ([u32; 2], Vec<[f32; 3]>);

fn exr(bytes: &[u8], budget: &Budget) -> Result<Texels, Unusable> {
    let reason = |error: exr::error::Error| Unusable::Reason(error.to_string());
    let data = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(reason)?;
    for header in &data.headers {
        let [width, height] = [header.layer_size.x(), header.layer_size.y()].map(|side| side as u64);
        images::check_size(width, height, bytes.len() as u64)?;
        // The texels here, and those of a decoder, of any number of channels.
        let channels = header.channels.list.len() as u64;
        budget.fits(width * height * (12 + 8 * channels)).map_err(Unusable::Memory)?;
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.x(), vec![[0.0f32; 3]; size.x() * size.y()]),
            |(width, texels), at, (r, g, b): (f32, f32, f32)| texels[at.y() * *width + at.x()] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(reason)?;
    let layer = image.layer_data;
    let (_, texels) = layer.channel_data.pixels;
    budget.take(12 * texels.len() as u64).map_err(Unusable::Memory)?;
    Ok(([layer.size.x() as u32, layer.size.y() as u32], texels))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Radiance HDR of 2x1 texels, not run-length encoded: red of 1 and green of 2.
    const TWO: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\0\0\x81\0\x80\0\x82";

    fn decoded(bytes: &[u8]) -> Result<Radiance, Unusable> {
        decode("x.hdr", bytes, &Budget::of_machine())
    }

    #[test]
    fn radiance_above_one_is_kept() {
        let picture = decoded(TWO).unwrap();
        assert_eq!((picture.width, picture.height), (2, 1));
        assert_eq!(picture.texels, [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
    }

    #[test]
    fn open_exr_is_read_whatever_its_name() {
        use exr::prelude::*;
        let channels = SpecificChannels::rgb(|at: Vec2<usize>| (at.x() as f32 * 100.0, -1.0f32, f32::NAN));
        let mut bytes = Cursor::new(Vec::new());
        Image::from_channels((2, 1), channels).write().non_parallel().to_buffered(&mut bytes).unwrap();
        let picture = decoded(bytes.get_ref()).unwrap();
        assert_eq!(picture.texels, [[0.0; 3], [100.0, 0.0, 0.0]]);
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        for bytes in [&b"nonsense"[..], &EXR, &TWO[..TWO.len() - 9], b""] {
            assert!(matches!(decoded(bytes), Err(Unusable::Reason(_))));
        }
        let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 30000\n";
        assert!(matches!(decoded(huge), Err(Unusable::Reason(_))));
    }
}
