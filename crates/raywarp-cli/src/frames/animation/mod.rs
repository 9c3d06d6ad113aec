//! All frames in one file.
//!
//! Frames stream out as they come: only one of them is in memory. They go to a file without a name beside the animation,
//! which takes its place when all of them are there.

mod apng;
mod ffmpeg;
mod gif;

use std::fs::File;
use std::io::{self, Seek};
use std::path::{Path, PathBuf};

use raywarp::image::Rgb8;
use raywarp::write;

use crate::failure::{fail, Context, Result};
use crate::interrupt::Interrupt;
use crate::messages;
use crate::output::Target;
use ffmpeg::Container;

/// Kinds of animations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Gif,
    Apng,
    Video(Container),
}

impl Kind {
    fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase().as_str() {
            "gif" => Ok(Self::Gif),
            "png" | "apng" => Ok(Self::Apng),
            "mp4" => Ok(Self::Video(Container::Mp4)),
            "webm" => Ok(Self::Video(Container::WebM)),
            _ => fail!(
                "cannot write the animation {}: its name does not end in .gif, .png, .apng, .mp4 or .webm",
                path.display()
            ),
        }
    }
}

/// Takes frames and makes a file of them.
trait Encoder {
    /// Adds a frame.
    fn add(&mut self, picture: &Rgb8) -> Result<()>;

    /// The whole file.
    fn finish(self: Box<Self>) -> Result<File>;
}

/// An animation that is being written.
pub struct Animation {
    path: PathBuf,
    encoder: Box<dyn Encoder>,
    frames: u32,
    fps: f64,
}

/// Finds out whether an animation can be written, before frames are rendered.
///
/// # Errors
/// For an unknown kind, a place that cannot be written to, a size or rate that the kind cannot have, and without
/// ffmpeg where it is needed.
pub fn check(path: &Path, size: [u32; 2], fps: f64) -> Result<()> {
    let kind = Kind::of(path)?;
    write::check(path)?;
    match kind {
        Kind::Gif => gif::check(path, size, fps),
        Kind::Apng => Ok(()),
        Kind::Video(_) => ffmpeg::check(path),
    }
}

impl Animation {
    /// An animation without frames yet, and how many there will be.
    ///
    /// # Errors
    /// As [`check`].
    pub fn open(path: &Path, size: [u32; 2], frames: u32, fps: f64, interrupt: &Interrupt) -> Result<Self> {
        let encoder: Box<dyn Encoder> = match Kind::of(path)? {
            Kind::Gif => Box::new(gif::Encoder::new(spool(path)?, size, fps)?),
            Kind::Apng => Box::new(apng::Encoder::new(spool(path)?, size, frames, fps)?),
            Kind::Video(container) => Box::new(ffmpeg::Encoder::new(path, container, size, fps, interrupt)?),
        };
        Ok(Self { path: path.to_owned(), encoder, frames, fps })
    }

    /// Adds a frame.
    pub fn add(&mut self, picture: &Rgb8) -> Result<()> {
        self.encoder.add(picture).with_context(|| format!("cannot write {}", self.path.display()))
    }

    /// Puts the file in its place, and returns a line about it.
    pub fn finish(self, target: Target) -> Result<String> {
        let name = messages::path(&self.path);
        let mut spool = self.encoder.finish().with_context(|| format!("cannot write {name}"))?;
        let failed = || format!("cannot read {name} again before it is put in its place");
        let bytes = spool.metadata().with_context(failed)?.len();
        spool.rewind().with_context(failed)?;
        let _held = target.interrupt.hold();
        let fill = |file: &mut File| io::copy(&mut spool, &mut target.interrupt.stop(file)).map(drop);
        target.run.with(&self.path, bytes, fill)?;
        let frames = messages::count(self.frames, "frame");
        Ok(format!("{name}: {frames}, {} a second, {}", self.fps, messages::bytes(bytes)))
    }
}

/// A file without a name, where there has to be room for the animation anyway.
fn spool(path: &Path) -> Result<File> {
    let directory = write::directory_of(path);
    tempfile::tempfile_in(&directory).with_context(|| format!("cannot write into {}", directory.display()))
}
