//! Options of frames.

use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueHint};

use super::range::Range;

/// Options of `render` for more than one picture.
#[derive(Debug, Args)]
#[command(next_help_heading = "Frames", group = ArgGroup::new("flight"))]
pub struct FrameOptions {
    /// Render these frames: FIRST..LAST, both included, or FIRST..LAST/STEP, or one; to files with #### or {frame} in
    /// their names; none of them: raywarp-####.png, or only the animation
    #[arg(long = "frames", value_name = "RANGE", requires = "flight", value_parser = Range::parse)]
    pub range: Option<Range>,
    /// Where --frames are a part, such as one machine's, all frames of the flight: 1 to N, or FIRST..LAST
    #[arg(long, value_name = "N|RANGE", requires = "range", value_parser = Range::parse_whole)]
    pub of: Option<Range>,
    /// Turn the camera about its target, counter-clockwise seen from above: once, or by DEGREES
    #[arg(long, value_name = "DEGREES", num_args = 0..=1, require_equals = true, default_missing_value = "360")]
    #[arg(group = "flight", requires = "range", value_parser = degrees)]
    pub orbit: Option<f64>,
    /// Fly along a camera path of the scene, by its name or its number from 0
    #[arg(long, value_name = "NAME|INDEX", group = "flight", requires = "range", conflicts_with_all = ["camera", "eye"])]
    pub path: Option<String>,
    /// Write the frames as one file too: .gif, .png or .apng (animated PNG), or by way of ffmpeg .mp4 or .webm
    #[arg(long, value_name = "FILE", requires = "range")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub animation: Option<PathBuf>,
    /// Frames a second of the animation
    #[arg(long, value_name = "N", default_value = "24", requires = "animation", value_parser = rate)]
    pub fps: f64,
    /// Render frames anew that are there already, instead of keeping them
    #[arg(long, requires = "range")]
    pub overwrite: bool,
}

/// An angle, in degrees.
fn degrees(text: &str) -> Result<f64, String> {
    let degrees = text.parse().ok().filter(|degrees: &f64| degrees.abs() <= 1e6);
    degrees.ok_or_else(|| "give an angle from -1000000 to 1000000 degrees".to_owned())
}

/// Frames a second.
fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (0.01..=1000.0).contains(rate));
    rate.ok_or_else(|| "give a number from 0.01 to 1000".to_owned())
}
