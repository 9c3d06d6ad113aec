//! Times pictures while the camera turns.

use std::sync::Arc;
use std::time::{Duration, Instant};

use raywarp_viewer::live::Picture;

use super::case::Case;
use super::scripted_pointer::{Frame, ScriptedPointer};

use crate::failure::Result;

/// Pictures that are timed at least.
const FEWEST: usize = 3;
/// Pictures that are kept, to be encoded later: from all around the scene.
const KEPT: usize = 8;
/// Share of the time that is spent before anything counts.
const BEFORE: f64 = 0.25;

/// What was seen.
#[derive(Default)]
pub struct Watched {
    /// Of each picture, in milliseconds: from the event to the pixels, and the parts of that.
    pub ms: Vec<f64>,
    pub trace_ms: Vec<f64>,
    pub fetch_ms: Vec<f64>,
    /// Pixels traced over pixels shown.
    pub traced: Vec<f64>,
    /// From the first event to the last picture.
    pub seconds: f64,
    /// Some of the pictures, from all of the time.
    pub pictures: Vec<Arc<Picture>>,
}

/// Turns the camera once in so many seconds, after some pictures that do not count.
///
/// # Errors
/// The device fails, or pictures fail to come.
pub fn watch(pointer: &mut ScriptedPointer, case: Case, seconds: f64, warmup: u32) -> Result<Watched> {
    let mut beat = Beat::new(case.period(), seconds);
    let (start, mut before) = (Instant::now(), 0);
    while before < warmup || start.elapsed().as_secs_f64() < BEFORE * seconds {
        pointer.next(beat.turn())?;
        before += 1;
    }
    let (start, mut watched) = (Instant::now(), Watched::default());
    while watched.ms.len() < FEWEST || watched.seconds < seconds {
        watched.take(pointer.next(beat.turn())?, seconds);
        watched.seconds = start.elapsed().as_secs_f64();
    }
    Ok(watched)
}

impl Watched {
    fn take(&mut self, frame: Frame, seconds: f64) {
        self.ms.push(frame.ms);
        self.trace_ms.push(frame.trace_ms);
        self.fetch_ms.push(frame.fetch_ms);
        self.traced.push(frame.traced);
        let due = self.seconds * KEPT as f64 >= self.pictures.len() as f64 * seconds;
        if due && self.pictures.len() < KEPT {
            self.pictures.push(frame.picture);
        }
    }
}

/// When pictures begin, and how far the camera has turned meanwhile.
struct Beat {
    period: Option<Duration>,
    /// Seconds of a whole turn.
    turn: f64,
    last: Instant,
}

impl Beat {
    fn new(period: Option<Duration>, turn: f64) -> Self {
        Self { period, turn, last: Instant::now() }
    }

    /// Waits until the next picture is due. One that comes late makes those after it late, not more.
    fn turn(&mut self) -> f64 {
        if let Some(rest) = self.period.and_then(|period| period.checked_sub(self.last.elapsed())) {
            std::thread::sleep(rest);
        }
        let before = std::mem::replace(&mut self.last, Instant::now());
        (self.last - before).as_secs_f64() / self.turn
    }
}
