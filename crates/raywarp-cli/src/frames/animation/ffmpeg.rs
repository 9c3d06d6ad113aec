//! Video by way of ffmpeg: it gets the frames as raw pixels, and makes of them what browsers and players show.

use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use raywarp::image::Rgb8;
use raywarp::write;
use tempfile::NamedTempFile;

use crate::failure::{Context, Failure, Result};
use crate::interrupt::Interrupt;

/// What ffmpeg makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// H.264 in MP4, where ffmpeg has that.
    Mp4,
    /// VP9 in WebM.
    WebM,
}

impl Container {
    /// Good to look at, in what every browser decodes: 4:2:0, with even sides.
    fn arguments(self) -> &'static [&'static str] {
        match self {
            Self::Mp4 => &["-crf", "18", "-movflags", "+faststart", "-f", "mp4"],
            Self::WebM => &["-crf", "24", "-b:v", "0", "-row-mt", "1", "-f", "webm"],
        }
    }
}

/// Finds out whether there is an ffmpeg.
pub fn check(path: &Path) -> Result<()> {
    let found = Command::new("ffmpeg").arg("-version").stdin(Stdio::null()).output();
    found.map(drop).map_err(|error| without(path, &error))
}

fn without(path: &Path, error: &io::Error) -> Failure {
    let why = match error.kind() {
        io::ErrorKind::NotFound => "there is none on the PATH".to_owned(),
        _ => format!("it does not run: {error}"),
    };
    Failure::new(format_args!(
        "cannot write {}: that takes ffmpeg, and {why}. Install ffmpeg, or write a .gif or .png (an animated PNG), or \
         single frames with -o alone",
        path.display()
    ))
}

/// ffmpeg at work.
pub struct Encoder {
    child: Child,
    target: NamedTempFile,
    /// What it complains about.
    said: File,
}

impl Encoder {
    /// Starts it, with a file beside the video to write to.
    pub fn new(path: &Path, container: Container, size: [u32; 2], fps: f64, interrupt: &Interrupt) -> Result<Self> {
        let target = write::temporary(path)?;
        interrupt.unfinished(target.path().to_owned());
        let said = tempfile::tempfile().context("cannot keep what ffmpeg says")?;
        let mut command = command(container, size, fps, target.path());
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(said.try_clone()?);
        let child = command.spawn().map_err(|error| without(path, &error))?;
        Ok(Self { child, target, said })
    }

    /// Why it ended.
    fn failure(&mut self) -> Failure {
        let status = self.child.wait().map_or_else(|error| error.to_string(), |status| status.to_string());
        let mut said = Vec::new();
        // Without its words there is still its end to tell.
        let _ = self.said.rewind().and_then(|()| (&mut self.said).take(2000).read_to_end(&mut said));
        let said = String::from_utf8_lossy(&said).split_whitespace().collect::<Vec<_>>().join(" ");
        Failure::new(format_args!(
            "ffmpeg ended with {status}: {}",
            if said.is_empty() { "it said nothing" } else { &said }
        ))
    }
}

fn command(container: Container, [width, height]: [u32; 2], fps: f64, target: &Path) -> Command {
    let mut command = Command::new("ffmpeg");
    command.args(["-y", "-hide_banner", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]);
    command.args(["-video_size", &format!("{width}x{height}"), "-framerate", &fps.to_string(), "-i", "pipe:0"]);
    // A screen takes the colours for Rec. 709, and chroma for two rows and columns at once.
    let even = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv";
    command.args(["-vf", even, "-pix_fmt", "yuv420p"]);
    command.args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"]);
    // A name with a colon would be a protocol.
    let mut file = std::ffi::OsString::from("file:");
    file.push(target);
    command.args(container.arguments()).arg(file);
    #[cfg(unix)]
    {
        // Ctrl-C is for raywarp, and ffmpeg then finds its input at an end.
        use std::os::unix::process::CommandExt;
        command.process_group(0);
    }
    command
}

impl super::Encoder for Encoder {
    fn add(&mut self, picture: &Rgb8) -> Result<()> {
        let pixels = picture.pixels.as_flattened();
        let written = self.child.stdin.as_mut().map(|input| input.write_all(pixels));
        match written {
            Some(Ok(())) => Ok(()),
            // A pipe that breaks is no reader that has seen enough: it is ffmpeg that failed.
            _ => Err(self.failure()),
        }
    }

    fn finish(mut self: Box<Self>) -> Result<File> {
        drop(self.child.stdin.take());
        let status = self.child.wait().context("ffmpeg cannot be waited for")?;
        if !status.success() {
            return Err(self.failure());
        }
        self.target.reopen().context("ffmpeg's file cannot be read")
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        // One that is done takes no notice; one that is not must not write on.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
