//! GIF: 256 colours a frame, everywhere.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use color_quant::NeuQuant;
use gif::{Frame, Repeat};
use raywarp::image::Rgb8;

use crate::failure::{ensure, Result};

/// Hundredths of a second below which players take their own time instead.
const SHORTEST: f64 = 2.0;

/// Frames of 256 colours.
pub struct Encoder {
    writer: gif::Encoder<BufWriter<File>>,
    fps: f64,
    frames: u32,
}

/// Finds out whether a GIF can be so large and so fast.
pub fn check(path: &Path, [width, height]: [u32; 2], fps: f64) -> Result<()> {
    ensure!(
        width.max(height) <= u32::from(u16::MAX),
        "a GIF has at most {} pixels each way: choose a smaller --size for {}",
        u16::MAX,
        path.display()
    );
    ensure!(
        100.0 / fps >= SHORTEST,
        "a GIF shows at most {} frames a second: give a smaller --fps for {}, or write a .png, .mp4 or .webm",
        100.0 / SHORTEST,
        path.display()
    );
    ensure!(
        100.0 / fps <= f64::from(u16::MAX),
        "a GIF shows a frame for at most {} s: give a larger --fps for {}",
        u16::MAX / 100,
        path.display()
    );
    Ok(())
}

impl Encoder {
    /// An endless loop.
    pub fn new(file: File, [width, height]: [u32; 2], fps: f64) -> Result<Self> {
        let mut writer = gif::Encoder::new(BufWriter::new(file), width as u16, height as u16, &[])?;
        writer.set_repeat(Repeat::Infinite)?;
        Ok(Self { writer, fps, frames: 0 })
    }

    /// Hundredths of a second of the next frame: what is rounded off one is given to another.
    fn delay(&mut self) -> u16 {
        let until = |frame: u32| (100.0 * f64::from(frame) / self.fps).round();
        let delay = until(self.frames + 1) - until(self.frames);
        self.frames += 1;
        delay as u16
    }
}

impl super::Encoder for Encoder {
    fn add(&mut self, picture: &Rgb8) -> Result<()> {
        let (palette, buffer) = indexed(picture);
        let frame = Frame {
            delay: self.delay(),
            width: picture.width as u16,
            height: picture.height as u16,
            palette: Some(palette),
            buffer: buffer.into(),
            ..Frame::default()
        };
        Ok(self.writer.write_frame(&frame)?)
    }

    fn finish(self: Box<Self>) -> Result<File> {
        let mut buffered = self.writer.into_inner()?;
        buffered.flush()?;
        Ok(buffered.into_inner().map_err(|error| error.into_error())?)
    }
}

/// Steps of a palette between which ordered dithering mixes, in the units of a channel.
const SPREAD: i32 = 14;

/// Bayer's matrix: thresholds of 4x4 pixels.
const THRESHOLDS: [[i32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// The palette, as bytes of red, green and blue, and an index into it for every pixel.
fn indexed(picture: &Rgb8) -> (Vec<u8>, Vec<u8>) {
    let mut colors: Vec<[u8; 3]> = Vec::new();
    let mut places = HashMap::new();
    let mut indices = Vec::with_capacity(picture.pixels.len());
    for &pixel in &picture.pixels {
        let place = *places.entry(pixel).or_insert_with(|| {
            colors.push(pixel);
            colors.len() - 1
        });
        match u8::try_from(place) {
            Ok(index) => indices.push(index),
            Err(_) => return quantised(picture),
        }
    }
    (colors.as_flattened().to_vec(), indices)
}

/// As [`indexed`] for a picture of more colours than there are: the nearest of the 256 that serve it best.
///
/// Dithered by a matrix: from frame to frame it stays where it is, and does not shimmer.
fn quantised(picture: &Rgb8) -> (Vec<u8>, Vec<u8>) {
    let rgba: Vec<u8> = picture.pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    let quantiser = NeuQuant::new(sampling(picture.pixels.len()), 256, &rgba);
    let mut nearest = vec![None; 1 << 18];
    let width = picture.width as usize;
    let index = |(at, pixel): (usize, &[u8; 3])| {
        let threshold = THRESHOLDS[at / width % 4][at % width % 4];
        let shift = SPREAD * (2 * threshold - 15) / 32;
        // Six bits a channel tell colours apart better than the palette does.
        let [r, g, b] = pixel.map(|channel| (i32::from(channel) + shift).clamp(0, 255) as usize >> 2);
        let middle = [r, g, b].map(|channel| (channel << 2 | channel >> 4) as u8);
        *nearest[r << 12 | g << 6 | b]
            .get_or_insert_with(|| quantiser.index_of(&[middle[0], middle[1], middle[2], 255]) as u8)
    };
    let indices = picture.pixels.iter().enumerate().map(index).collect();
    (quantiser.color_map_rgb(), indices)
}

/// Of how many pixels one is looked at for the palette: all of a small picture, a few hundred thousand of a large one.
fn sampling(pixels: usize) -> i32 {
    (pixels / 300_000).clamp(1, 30) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(picture: &Rgb8) -> Vec<i32> {
        let (palette, indices) = indexed(picture);
        assert!(palette.len() <= 3 * 256 && palette.len() % 3 == 0);
        let color = |index: u8| &palette[3 * usize::from(index)..][..3];
        let error = |(pixel, &index): (&[u8; 3], &u8)| {
            pixel.iter().zip(color(index)).map(|(a, b)| (i32::from(*a) - i32::from(*b)).abs()).max().unwrap()
        };
        picture.pixels.iter().zip(&indices).map(error).collect()
    }

    #[test]
    fn few_colours_are_kept_as_they_are() {
        for count in [1usize, 2, 255, 256] {
            let pixels = (0..count).map(|i| [i as u8, 255 - i as u8, (7 * i) as u8]).collect();
            let picture = Rgb8 { width: count as u32, height: 1, pixels };
            assert!(errors(&picture).iter().all(|&error| error == 0), "{count}");
        }
    }

    #[test]
    fn many_colours_are_replaced_by_near_ones() {
        let pixel = |i: u32| [(i % 64 * 4) as u8, (i / 64 * 4) as u8, 128];
        let picture = Rgb8 { width: 64, height: 64, pixels: (0..4096).map(pixel).collect() };
        let errors = errors(&picture);
        let mean = f64::from(errors.iter().sum::<i32>()) / errors.len() as f64;
        assert!(mean < 16.0, "{mean}");
    }

    #[test]
    fn delays_add_up() {
        for fps in [24.0, 30.0, 50.0, 7.3] {
            let mut encoder = Encoder::new(tempfile::tempfile().unwrap(), [1, 1], fps).unwrap();
            let sum: u32 = (0..100).map(|_| u32::from(encoder.delay())).sum();
            assert!((f64::from(sum) - 10_000.0 / fps).abs() <= 0.5, "{fps}: {sum}");
        }
    }
}
