//! Pictures as PNG: eight bits a channel, sRGB.

use std::path::Path;

use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder, ImageFormat, ImageReader};
use rayon::prelude::*;
use raywarp_kernels::math::Vec3;

use super::{Development, Format, ImageError, Picture, Rgb8};

/// Exposes, tone-maps and encodes a picture as a screen shows it.
pub fn develop(picture: &Picture, development: &Development) -> Rgb8 {
    let tone = development.tone();
    let pixels = picture.pixels.par_iter().map(|&[r, g, b, _]| tone.color(Vec3::new(r, g, b))).collect();
    Rgb8 { width: picture.width, height: picture.height, pixels }
}

/// The bytes of a PNG file.
///
/// # Errors
/// [`ImageError::Encode`] for a picture without pixels.
pub fn encode(picture: &Rgb8) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (picture.width, picture.height);
    let failed = |reason: String| ImageError::Encode { format: Format::Png, width, height, reason };
    if width == 0 || height == 0 || picture.pixels.len() != width as usize * height as usize {
        return Err(failed(format!("it holds {} pixels", picture.pixels.len())));
    }
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytemuck::cast_slice(&picture.pixels), width, height, ExtendedColorType::Rgb8)
        .map_err(|error| failed(error.to_string()))?;
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
