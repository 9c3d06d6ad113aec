//! Animated PNG: every pixel as it is, in every browser.

use std::fs::File;
use std::io::BufWriter;

use raywarp::image::Rgb8;

use crate::failure::{Context, Result};

/// Frames that are PNGs within a PNG.
pub struct Encoder {
    writer: png::Writer<BufWriter<File>>,
    /// The same file.
    file: File,
}

impl Encoder {
    /// An endless loop of so many frames.
    pub fn new(file: File, [width, height]: [u32; 2], frames: u32, fps: f64) -> Result<Self> {
        let same = file.try_clone()?;
        let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_animated(frames, 0)?;
        let (seconds, parts) = delay(fps);
        encoder.set_frame_delay(seconds, parts)?;
        Ok(Self { writer: encoder.write_header()?, file: same })
    }
}

/// Seconds a frame, as a fraction.
fn delay(fps: f64) -> (u16, u16) {
    // The larger the numbers, the finer the rate: but both have 16 bits.
    let scales = [1000.0, 100.0, 10.0, 1.0];
    let exact =
        [1.0, 10.0, 100.0, 1000.0].into_iter().find(|scale| fps * scale <= 65535.0 && (fps * scale).fract() == 0.0);
    let scale = exact.or_else(|| scales.into_iter().find(|scale| fps * scale <= 65535.0)).unwrap_or(1.0);
    (scale as u16, ((fps * scale).round() as u16).max(1))
}

impl super::Encoder for Encoder {
    fn add(&mut self, picture: &Rgb8) -> Result<()> {
        Ok(self.writer.write_image_data(picture.pixels.as_flattened())?)
    }

    fn finish(self: Box<Self>) -> Result<File> {
        self.writer.finish().context("the last frame is missing")?;
        Ok(self.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_fractions_of_sixteen_bits() {
        for (fps, expected) in [
            (24.0, (1, 24)),
            (12.5, (10, 125)),
            (23.976, (1000, 23976)),
            (1000.0, (1, 1000)),
            (0.01, (100, 1)),
            (59.94, (100, 5994)),
            (0.123456, (1000, 123)),
        ] {
            assert_eq!(delay(fps), expected, "{fps}");
        }
    }
}
