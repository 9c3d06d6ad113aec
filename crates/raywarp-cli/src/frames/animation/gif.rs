//! GIF: 256 colours a frame, everywhere.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use color_quant::NeuQuant;
use gif::{Frame, Repeat};
use raywarp::image::Rgb8;

/// Hundredths of a second below which players take their own time instead.
const SHORTEST: f64 = 2.0;

/// Frames of 256 colours.
pub struct Encoder {
    writer: gif::Encoder<BufWriter<File>>,
    fps: f64,
    frames: u32,
}

/// Finds out whether a GIF can be so large and so fast.
pub fn check(path: &Path, [width, height]: [u32; 2], fps: f64) -> anyhow::Result<()> {
    anyhow::ensure!(
        width.max(height) <= u32::from(u16::MAX),
        "a GIF has at most {} pixels each way: choose a smaller --size for {}",
        u16::MAX,
        path.display()
    );
    anyhow::ensure!(
        100.0 / fps >= SHORTEST,
        "a GIF shows at most {} frames a second: give a smaller --fps for {}, or write a .png, .mp4 or .webm",
        100.0 / SHORTEST,
        path.display()
    );
    anyhow::ensure!(
        100.0 / fps <= f64::from(u16::MAX),
        "a GIF shows a frame for at most {} s: give a larger --fps for {}",
        u16::MAX / 100,
        path.display()
    );
    Ok(())
}

impl Encoder {
    /// An endless loop.
    pub fn new(file: File, [width, height]: [u32; 2], fps: f64) -> anyhow::Result<Self> {
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
    fn add(&mut self, picture: &Rgb8) -> anyhow::Result<()> {
        let (palette, buffer) = quantised(picture);
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

    fn finish(self: Box<Self>) -> anyhow::Result<File> {
        let mut buffered = self.writer.into_inner()?;
        buffered.flush()?;
        Ok(buffered.into_inner()?)
    }
}

/// The palette, as bytes of red, green and blue, and an index into it for every pixel.
fn quantised(picture: &Rgb8) -> (Vec<u8>, Vec<u8>) {
    let rgba: Vec<u8> = picture.pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    let quantiser = NeuQuant::new(10, 256, &rgba);
    let mut known = vec![None; 1 << 18];
    let mut index = |pixel: &[u8; 3]| {
        let [r, g, b] = pixel.map(|channel| usize::from(channel >> 2));
        *known[r << 12 | g << 6 | b]
            .get_or_insert_with(|| quantiser.index_of(&[pixel[0], pixel[1], pixel[2], 255]) as u8)
    };
    let indices = picture.pixels.iter().map(&mut index).collect();
    (quantiser.color_map_rgb(), indices)
}
