//! A picture cut in stripes, each encoded on its own: by all cores here, and by all cores of the browser.

use axum::body::Bytes;
use jpeg_encoder::{ColorType, SamplingFactor};
use rayon::prelude::*;

use super::protocol::{Kind, StripeHead};
use super::quality;
use crate::live::Picture;

/// Rows of a stripe are a multiple of the block of JPEG with halved colour.
const BLOCK: u32 = 16;
/// Smallest stripe that is worth its own head and tables.
const FEWEST_ROWS: u32 = 64;
/// Most stripes of a lossy picture. A lossless one has more, as each is a portion.
const MOST: u32 = 16;
const MOST_LOSSLESS: u32 = 64;

/// How a picture is encoded for a browser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coding {
    /// JPEG with colours at half the resolution.
    Lossy {
        /// From 1 to 100.
        quality: u8,
    },
    /// PNG.
    Lossless,
}

impl Coding {
    /// Of a picture while something moves, for a browser whose link keeps up.
    pub const MOVING: Self = Self::Lossy { quality: quality::BEST as u8 };
}

/// Why a picture cannot be encoded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StripeError {
    /// A stripe cannot be written as JPEG.
    #[error(transparent)]
    Jpeg(#[from] jpeg_encoder::EncodingError),
    /// A stripe cannot be written as PNG.
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    /// Columns, rows and bytes do not go together, or a side is 0 or more than 65535.
    #[error("a picture of {0}x{1} pixels has {2} bytes")]
    Size(u32, u32, usize),
}

/// The messages that bring a picture to a browser, from top to bottom, encoded on all threads as for
/// [`Server`](super::Server): a picture in motion with [`Coding::MOVING`], at best, and one at rest with
/// [`Coding::Lossless`].
///
/// # Errors
/// [`StripeError`] where the picture's bytes are not those of its size, or a side is 0 or more than 65535.
pub fn messages(picture: &Picture, coding: Coding) -> Result<Vec<impl AsRef<[u8]>>, StripeError> {
    encode(picture, coding, 0, 0)
}

/// The stripes of a picture as they are sent, from top to bottom.
pub fn encode(picture: &Picture, coding: Coding, frame: u32, mark: u32) -> Result<Vec<Bytes>, StripeError> {
    let [width, height] = picture.size;
    let unfit = || StripeError::Size(width, height, picture.rgba.len());
    let side = |side: u32| u16::try_from(side).ok().filter(|&side| side > 0).ok_or_else(unfit);
    let size = [side(width)?, side(height)?];
    if picture.rgba.len() != 4 * width as usize * height as usize {
        return Err(unfit());
    }
    let rows = rows_of_a_stripe(height, coding);
    let count = height.div_ceil(rows) as u16;
    let kind = if coding == Coding::Lossless { Kind::Png } else { Kind::Jpeg };
    let stripe = |(index, pixels): (usize, &[u8])| {
        let (row, rows) = (index as u32 * rows, (pixels.len() / (4 * width as usize)) as u16);
        let (index, row) = (index as u16, row as u16);
        let head = StripeHead { kind, settled: picture.settled, index, count, size, row, rows, frame, mark };
        let mut bytes = Vec::with_capacity(StripeHead::BYTES + pixels.len() / 4);
        bytes.extend(head.to_bytes());
        match coding {
            Coding::Lossy { quality } => jpeg(&mut bytes, pixels, [size[0], rows], quality)?,
            Coding::Lossless => png(&mut bytes, pixels, [size[0], rows])?,
        }
        Ok(Bytes::from(bytes))
    };
    picture.rgba.par_chunks(4 * width as usize * rows as usize).enumerate().map(stripe).collect()
}

fn rows_of_a_stripe(height: u32, coding: Coding) -> u32 {
    let most = if coding == Coding::Lossless { MOST_LOSSLESS } else { MOST };
    height.div_ceil(most).next_multiple_of(BLOCK).max(FEWEST_ROWS)
}

fn jpeg(bytes: &mut Vec<u8>, rgba: &[u8], [width, height]: [u16; 2], quality: u8) -> Result<(), StripeError> {
    let mut encoder = jpeg_encoder::Encoder::new(bytes, quality);
    encoder.set_sampling_factor(SamplingFactor::F_2_2);
    Ok(encoder.encode(rgba, width, height, ColorType::Rgba)?)
}

fn png(bytes: &mut Vec<u8>, rgba: &[u8], [width, height]: [u16; 2]) -> Result<(), StripeError> {
    let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let mut encoder = png::Encoder::new(bytes, width.into(), height.into());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture with something in each channel and row.
    fn picture(width: u32, height: u32) -> Picture {
        let pixel = |i: u32| [(i % 251) as u8, (i / width) as u8, (i * 7 % 256) as u8, 255];
        Picture { size: [width, height], rgba: (0..width * height).flat_map(pixel).collect(), settled: true }
    }

    fn joined(stripes: &[Bytes]) -> Vec<u8> {
        let decode =
            |stripe: &Bytes| image::load_from_memory(&stripe[StripeHead::BYTES..]).unwrap().to_rgba8().into_raw();
        stripes.iter().flat_map(decode).collect()
    }

    #[test]
    fn lossless_stripes_are_the_picture() {
        for (width, height) in [(1, 1), (1, 300), (33, 64), (200, 1000), (7, 4096)] {
            let picture = picture(width, height);
            let stripes = encode(&picture, Coding::Lossless, 3, 4).unwrap();
            assert_eq!(joined(&stripes), picture.rgba, "{width}x{height}");
            assert!(stripes.len() <= MOST_LOSSLESS as usize);
        }
    }

    #[test]
    fn messages_are_those_of_the_first_picture() {
        let picture = picture(64, 200);
        let sent = encode(&picture, Coding::MOVING, 0, 0).unwrap();
        let messages = messages(&picture, Coding::MOVING).unwrap();
        assert!(messages.iter().map(AsRef::as_ref).eq(sent.iter().map(|stripe| &stripe[..])));
        assert_eq!(Coding::MOVING, Coding::Lossy { quality: 90 });
    }

    #[test]
    fn lossy_stripes_are_near_it() {
        let mut grey = picture(100, 1000);
        grey.rgba.chunks_exact_mut(4).enumerate().for_each(|(i, pixel)| pixel[..3].fill((i / 500) as u8));
        let stripes = encode(&grey, Coding::Lossy { quality: 90 }, 1, 0).unwrap();
        assert!(stripes.len() > 1 && stripes.len() <= MOST as usize);
        let far = joined(&stripes).iter().zip(&grey.rgba).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(far.unwrap() < 8, "{far:?}");
    }

    #[test]
    fn a_picture_that_is_none_is_refused() {
        for (size, bytes) in [([0, 0], 0), ([2, 2], 15), ([70_000, 1], 280_000)] {
            let picture = Picture { size, rgba: vec![0; bytes], settled: false };
            assert!(encode(&picture, Coding::Lossless, 1, 0).is_err(), "{size:?}");
        }
    }
}
