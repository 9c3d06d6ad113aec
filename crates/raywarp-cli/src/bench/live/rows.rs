//! What was measured of the viewer, as the JSON has it.

use raywarp_viewer::live::view_settings::ViewSettings;
use raywarp_viewer::live::{Picture, Status};
use raywarp_viewer::serve::Coding;
use serde::Serialize;

use super::super::machine::Machine;
use super::super::results::Note;
use super::super::spread::{quantile, Spread};
use super::case::{aim, Case};
use super::encode::{self, Encoded};
use super::watch::Watched;

use crate::failure::Result;

/// A whole run.
#[derive(Debug, Serialize)]
pub struct Live {
    /// On what, with what.
    #[serde(flatten)]
    pub machine: Machine,
    /// What was typed.
    pub command: String,
    /// Of each row, at least; and pictures before it, at least.
    pub seconds: f64,
    pub warmup: u32,
    /// Of every picture.
    pub max_depth: u32,
    pub shadows: bool,
    /// Of JPEG.
    pub jpeg_quality: u8,
    /// Pictures a second that the held case aims at.
    pub aim: f32,
    /// A scene, structure, size and case each.
    pub rows: Vec<Row>,
    /// What could not be measured.
    pub notes: Vec<Note>,
}

/// A case.
#[derive(Debug, Serialize)]
pub struct Row {
    pub scene: String,
    pub triangles: u64,
    pub layout: String,
    pub tree: String,
    /// Of the picture on show, in pixels.
    pub size: [u32; 2],
    pub case: Case,
    /// Pictures that were timed, in so many seconds.
    pub frames: usize,
    pub seconds: f64,
    pub frames_per_s: f64,
    /// From an event to the pixels, in milliseconds; what 95 of 100 pictures do not exceed; share of those that took
    /// longer than the aim.
    pub ms: Spread,
    pub ms_95: f64,
    pub late: f64,
    /// Pixels traced over pixels shown: mean and least.
    pub traced: f64,
    pub traced_least: f64,
    /// Where the time of a picture goes that is sent to a browser.
    pub parts: Parts,
    /// Pictures of the moving camera as JPEG, and the one before it moved as PNG.
    pub jpeg: Encoded,
    pub png: Encoded,
}

/// One thing after the other.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Parts {
    /// Kernels that trace.
    pub trace: Part,
    /// From samples to pixels in the host's memory.
    pub fetch: Part,
    /// What else the viewer does.
    pub other: Part,
    /// JPEG.
    pub encode: Part,
}

/// Of a picture.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Part {
    /// Mean.
    pub ms: f64,
    /// Of all parts together.
    pub share: f64,
}

impl Live {
    /// Without any row.
    pub fn new(machine: Machine, seconds: f64, warmup: u32) -> Self {
        let view_settings = ViewSettings::default();
        let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
        Self {
            machine,
            command: std::iter::once("raywarp".to_owned()).chain(words).collect::<Vec<_>>().join(" "),
            seconds,
            warmup,
            max_depth: view_settings.render.max_depth(),
            shadows: view_settings.render.shadows(),
            jpeg_quality: match Coding::MOVING {
                Coding::Lossy { quality } => quality,
                Coding::Lossless => 100,
            },
            aim: view_settings.frame_rate,
            rows: Vec::new(),
            notes: Vec::new(),
        }
    }
}

impl Row {
    /// Of what was seen and of the picture at rest.
    ///
    /// # Errors
    /// A picture cannot be encoded.
    pub fn new(scene: &str, status: &Status, case: Case, watched: &Watched, rest: &Picture) -> Result<Self> {
        let jpeg = encode::moving(watched.pictures.iter().map(|picture| &**picture))?;
        let (layout, tree) = status.accel.split_once(", ").unwrap_or((&status.accel, ""));
        let (frames, late) = (watched.ms.len(), aim().as_secs_f64() * 1e3);
        Ok(Self {
            scene: scene.to_owned(),
            triangles: status.triangles,
            layout: layout.to_owned(),
            tree: tree.to_owned(),
            size: status.size,
            case,
            frames,
            seconds: watched.seconds,
            frames_per_s: frames as f64 / watched.seconds.max(1e-9),
            ms: Spread::of(watched.ms.clone()),
            ms_95: quantile(&watched.ms, 0.95),
            late: watched.ms.iter().filter(|&&ms| ms > late).count() as f64 / frames.max(1) as f64,
            traced: mean(&watched.traced),
            traced_least: quantile(&watched.traced, 0.0),
            parts: Parts::of(mean(&watched.ms), mean(&watched.trace_ms), mean(&watched.fetch_ms), jpeg.ms_mean),
            jpeg,
            png: encode::still(rest)?,
        })
    }
}

impl Parts {
    /// Of a frame and two parts of it, and of what follows it, in milliseconds.
    fn of(frame: f64, trace: f64, fetch: f64, encode: f64) -> Self {
        let other = (frame - trace - fetch).max(0.0);
        let whole = (trace + fetch + other + encode).max(f64::MIN_POSITIVE);
        let [trace, fetch, other, encode] = [trace, fetch, other, encode].map(|ms| Part { ms, share: ms / whole });
        Self { trace, fetch, other, encode }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_shares_of_the_whole() {
        let parts = Parts::of(10.0, 6.0, 3.0, 10.0);
        assert_eq!(parts.other.ms, 1.0);
        assert_eq!(
            [parts.trace, parts.fetch, parts.other, parts.encode].map(|part| part.share),
            [0.3, 0.15, 0.05, 0.5]
        );
        // Two clocks may disagree a little.
        assert_eq!(Parts::of(1.0, 1.01, 0.0, 0.0).other.ms, 0.0);
        assert_eq!(Parts::of(0.0, 0.0, 0.0, 0.0).trace.share, 0.0);
    }
}
