//! What was measured, as the JSON has it.

use std::fmt;

use raywarp::accel::Quality;
use raywarp::device::KernelInfo;
use raywarp::query::{Answers, Cost, RayKind};
use serde::Serialize;

use super::machine::Machine;
use super::peers::About;
use super::spread::Spread;
use crate::messages;

/// A whole run.
#[derive(Debug, Serialize)]
pub struct Results {
    /// On what, with what.
    #[serde(flatten)]
    pub machine: Machine,
    /// Of the picture of the primary rays, in pixels.
    pub size: [u32; 2],
    /// Timed ones, and those before.
    pub repeats: u32,
    pub warmup: u32,
    /// Of raywarp: a structure, a tree and a kind of rays each.
    pub rows: Vec<Row>,
    /// Of the others: a kind of rays each.
    pub peers: Vec<PeerRow>,
    /// What could not be measured.
    pub notes: Vec<Note>,
}

/// Rays that everyone was given.
#[derive(Clone, Debug, Serialize)]
pub struct Task {
    /// The scene's name.
    pub scene: String,
    /// Its triangles that can be hit.
    pub triangles: usize,
    /// The kind of rays.
    pub rays: RayKind,
    /// Whether any hit will do.
    pub any_hit: bool,
    /// How many rays.
    pub count: usize,
}

/// How long a task took.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Speed {
    /// Million rays a second: the median, the worst and the best.
    pub mrays_per_s: f64,
    pub mrays_per_s_least: f64,
    pub mrays_per_s_most: f64,
    /// Of one repeat.
    pub ms: Spread,
}

/// What one structure made of a task.
#[derive(Debug, Serialize)]
pub struct Row {
    #[serde(flatten)]
    pub task: Task,
    pub layout: String,
    pub tree: Quality,
    #[serde(flatten)]
    pub speed: Speed,
    /// Rays that hit something, of 1.
    pub hit_share: f64,
    /// Rays whose answer is not to the bit that of the first structure: 0, or there is a mistake.
    pub differ: usize,
    /// Bytes of what traversal reads.
    pub node_bytes: usize,
    pub triangle_bytes: usize,
    /// Expected cost of a ray by the surface area heuristic.
    pub sah_cost: f64,
    pub build_seconds: f64,
    /// Null on the CPU.
    pub kernel: Option<KernelInfo>,
    /// Null unless counted.
    pub cost: Option<Cost>,
}

/// What a peer made of a task.
#[derive(Debug, Serialize)]
pub struct PeerRow {
    #[serde(flatten)]
    pub task: Task,
    #[serde(flatten)]
    pub peer: About,
    /// The fastest of its ways: builder, size of blocks.
    pub variant: String,
    #[serde(flatten)]
    pub speed: Speed,
    pub build_seconds: f64,
    pub agreement: Agreement,
}

/// How a peer's hits differ from raywarp's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Agreement {
    /// Rays that one of the two has as a miss.
    pub hit_or_miss: usize,
    /// Rays whose distances differ by more than a thousandth; 0 where any hit will do.
    pub distance: usize,
    /// The largest difference of distances that both have, relative to raywarp's.
    pub largest: f64,
}

/// A relative difference of distances that rounding does not explain.
const FAR_APART: f64 = 1e-3;

/// Something that is not in the results.
#[derive(Clone, Debug, Serialize)]
pub struct Note {
    /// The scene or the peer.
    pub about: String,
    /// Why.
    pub reason: String,
}

impl Results {
    /// Says something at once, and keeps it.
    pub fn note(&mut self, about: &str, reason: impl Into<String>) {
        self.notes.push(Note::said(about, reason));
    }
}

impl Note {
    /// Says it at once.
    pub fn said(about: &str, reason: impl Into<String>) -> Self {
        let note = Self { about: about.to_owned(), reason: reason.into() };
        messages::line(&format!("note: {note}"));
        note
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.about, self.reason)
    }
}

impl Speed {
    /// Of so many rays in each of these times, in seconds.
    pub fn of(rays: usize, seconds: Vec<f64>) -> Self {
        let seconds = Spread::of(seconds);
        // A clock too coarse for a few rays says 0.
        let rates = seconds.falling(|seconds| 1e-6 * rays as f64 / seconds.max(1e-9));
        Self {
            mrays_per_s: rates.median,
            mrays_per_s_least: rates.least,
            mrays_per_s_most: rates.most,
            ms: Spread { median: seconds.median * 1e3, least: seconds.least * 1e3, most: seconds.most * 1e3 },
        }
    }
}

impl Agreement {
    /// Of raywarp's answers and a peer's distances.
    pub fn of(answers: &Answers, distances: &[f32]) -> Self {
        let mut agreement = Self::default();
        match answers {
            Answers::Occluded(occluded) => {
                let pairs = occluded.iter().zip(distances);
                agreement.hit_or_miss = pairs.filter(|(&any, t)| any != t.is_finite()).count();
            }
            Answers::Closest(hits) => hits.iter().zip(distances).for_each(|(hit, &t)| agreement.add(hit.t, t)),
        }
        agreement
    }

    fn add(&mut self, ours: f32, theirs: f32) {
        if ours.is_finite() && theirs.is_finite() {
            let difference = f64::from(ours - theirs).abs() / f64::from(ours.abs()).max(f64::MIN_POSITIVE);
            self.largest = self.largest.max(difference);
            self.distance += (difference > FAR_APART) as usize;
        } else {
            self.hit_or_miss += (ours.is_finite() != theirs.is_finite()) as usize;
        }
    }
}

/// Answers that are not the same to the bit.
pub fn differing(a: &Answers, b: &Answers) -> usize {
    match (a, b) {
        (Answers::Closest(a), Answers::Closest(b)) => a.iter().zip(b).filter(|(a, b)| a != b).count(),
        (Answers::Occluded(a), Answers::Occluded(b)) => a.iter().zip(b).filter(|(a, b)| a != b).count(),
        (Answers::Closest(all), _) => all.len(),
        (Answers::Occluded(all), _) => all.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywarp::Hit;

    #[test]
    fn rates_are_rays_over_times() {
        let speed = Speed::of(2_000_000, vec![0.5, 1.0, 4.0]);
        assert_eq!((speed.mrays_per_s, speed.mrays_per_s_least, speed.mrays_per_s_most), (2.0, 0.5, 4.0));
        assert_eq!(speed.ms.median, 1000.0);
    }

    #[test]
    fn agreement_counts_misses_and_distances() {
        let hit = |t| Hit { t, primitive: 0, ..Hit::NONE };
        let ours = Answers::Closest(vec![hit(2.0), hit(1.0), Hit::NONE, Hit::NONE, hit(1.0)]);
        let theirs = [2.5, 1.0, f32::INFINITY, 3.0, f32::INFINITY];
        assert_eq!(Agreement::of(&ours, &theirs), Agreement { hit_or_miss: 2, distance: 1, largest: 0.25 });
        let any = Answers::Occluded(vec![true, false, true]);
        assert_eq!(Agreement::of(&any, &[0.0, 0.0, f32::INFINITY]).hit_or_miss, 2);
    }
}
