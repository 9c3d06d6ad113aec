//! Pictures as PNG: eight bits a channel, sRGB.

use std::path::Path;

use ::image::{ImageFormat, ImageReader};
use rayon::prelude::*;
use raywarp_core::math::Vec3;

use super::provenance::PNG_FINGERPRINT;
use super::{Development, Format, ImageError, Picture, Provenance, Rgb8};

/// Exposes, tone-maps and encodes a picture as a screen shows it.
pub fn tone_map_film(picture: &Picture, development: &Development) -> Rgb8 {
    let tone = development.tone();
    let pixels = picture.pixels.par_iter().map(|&[r, g, b, _]| tone.color(Vec3::new(r, g, b))).collect();
    Rgb8 { width: picture.width, height: picture.height, pixels }
}

/// The bytes of a PNG file.
///
/// # Errors
/// [`ImageError::Encode`] for a picture without pixels.
pub fn encode(picture: &Rgb8) -> Result<Vec<u8>, ImageError> {
    encode_described(picture, None)
}

/// The bytes of a PNG file that says how it was made.
///
/// # Errors
/// As for [`encode`].
pub fn encode_described(picture: &Rgb8, provenance: Option<&Provenance>) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (picture.width, picture.height);
    let failed = |reason: String| ImageError::Encode { format: Format::Png, width, height, reason };
    if width == 0 || height == 0 || picture.pixels.len() != width as usize * height as usize {
        return Err(failed(format!("it holds {} pixels", picture.pixels.len())));
    }
    write(picture, provenance).map_err(|error| failed(error.to_string()))
}

fn write(picture: &Rgb8, provenance: Option<&Provenance>) -> Result<Vec<u8>, ::png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(::png::Compression::Balanced);
    encoder.set_filter(::png::Filter::Adaptive);
    if let Some(Provenance { software, comment, fingerprint }) = provenance {
        for (keyword, text) in [("Software", software), ("Comment", comment)] {
            encoder.add_itxt_chunk(keyword.to_owned(), text.clone())?;
        }
        encoder.add_text_chunk(PNG_FINGERPRINT.to_owned(), fingerprint.clone())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(picture.pixels.as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}

/// The pixels of a PNG file, as eight bits a channel whatever it holds.
///
/// # Errors
/// [`ImageError::Read`] for a file that is not there or no PNG.
pub fn read(path: &Path) -> Result<Rgb8, ImageError> {
    let failed = |reason: String| ImageError::Read { path: path.to_owned(), reason };
    let mut reader = ImageReader::open(path).map_err(|error| failed(error.to_string()))?;
    reader.set_format(ImageFormat::Png);
    let image = reader.decode().map_err(|error| failed(error.to_string()))?.into_rgb8();
    let (width, height) = image.dimensions();
    Ok(Rgb8 { width, height, pixels: image.pixels().map(|pixel| pixel.0).collect() })
}
