//! Pictures as PNG: eight bits a channel, sRGB.

use std::path::Path;

use ::image::{ImageFormat, ImageReader};
use rayon::prelude::*;
use raywarp_core::display::byte;
use raywarp_core::math::Vec3;

use super::provenance::PNG_FINGERPRINT;
use super::{Development, Format, ImageError, Picture, Provenance, Rgb8};

/// Exposes, tone-maps and encodes a picture as a screen shows it.
pub fn tone_map(picture: &Picture, development: &Development) -> Rgb8 {
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
    let pixels = (::png::ColorType::Rgb, picture.pixels.as_flattened());
    write([width, height], pixels, provenance).map_err(|error| failed(error.to_string()))
}

/// The bytes of a PNG file with the coverage of each pixel as its alpha, of a picture whose radiance is premultiplied by
/// it.
///
/// # Errors
/// As for [`encode`].
pub fn encode_transparent(
    picture: &Picture,
    development: &Development,
    provenance: Option<&Provenance>,
) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (picture.width, picture.height);
    let failed = |reason: String| ImageError::Encode { format: Format::Png, width, height, reason };
    if width == 0 || height == 0 || picture.pixels.len() != width as usize * height as usize {
        return Err(failed(format!("it holds {} pixels", picture.pixels.len())));
    }
    let tone = development.tone();
    let covered = |&[r, g, b, share]: &[f32; 4]| {
        let whole = if share > 0.0 { 1.0 / share } else { 0.0 };
        let [r, g, b] = tone.color(Vec3::new(r, g, b) * whole);
        [r, g, b, byte(share)]
    };
    let pixels: Vec<[u8; 4]> = picture.pixels.par_iter().map(covered).collect();
    let pixels = (::png::ColorType::Rgba, pixels.as_flattened());
    write([width, height], pixels, provenance).map_err(|error| failed(error.to_string()))
}

fn write(
    [width, height]: [u32; 2],
    (color, pixels): (::png::ColorType, &[u8]),
    provenance: Option<&Provenance>,
) -> Result<Vec<u8>, ::png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
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
    writer.write_image_data(pixels)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_is_alpha_and_colours_are_those_of_what_covers() {
        let pixels = vec![[0.0; 4], [0.25, 0.25, 0.0, 0.25], [1.0, 0.0, 0.0, 1.0]];
        let picture = Picture { width: 3, height: 1, origin: [0; 2], whole: [3, 1], pixels };
        let bytes = encode_transparent(&picture, &Development::default(), None).unwrap();
        let read = ::image::load_from_memory(&bytes).unwrap().into_rgba8();
        let read: Vec<_> = read.pixels().map(|pixel| pixel.0).collect();
        assert_eq!(read, [[0; 4], [255, 255, 0, 64], [255, 0, 0, 255]]);
        assert!(encode_transparent(&Picture::default(), &Development::default(), None).is_err());
    }
}
