//! Rays of a queue in an order in which neighbours go the same way: by octant of the direction and place of the origin.
//!
//! A counting sort: [`Tell`] finds each ray's bin and its number there, [`Sum`] and [`Begin`] where each bin begins, [`Move`]
//! moves. Which
//! of a bin's rays comes first is left open.

use super::paths::Waiting;
use raywarp_core::arch;
use raywarp_core::kernels::Thread;
use raywarp_core::math::Vec3;
use raywarp_core::view::{View, ViewMut};

/// Bits of a place along an axis.
const BITS: u32 = 3;

/// Cells along an axis.
pub const CELLS: u32 = 1 << BITS;

/// Bins that are added up together.
const RUN: u32 = 64;

/// Runs of bins.
pub const RUNS: u32 = BINS / RUN;

/// Bins: places, and octants within each.
pub const BINS: u32 = 8 << (3 * BITS);

/// Finds the bins of a queue's rays.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Tell {
    /// The rays.
    pub queue: View<Waiting>,
    /// Rays of each bounce, and which bounce the queue is of.
    pub counts: View<u32>,
    /// Its index.
    pub bounce: u32,
    /// Low corner of the scene.
    pub low: Vec3,
    /// Cells a scene unit, by axis.
    pub scale: Vec3,
    /// Rays of each bin: zero before.
    pub bins: ViewMut<u32>,
    /// Bin of each ray and its number there, written.
    pub places: ViewMut<[u32; 2]>,
}

impl Tell {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.counts.at(self.bounce) {
            return;
        }
        let ray = self.queue.load(thread.x).ray;
        let cell = |x: f32| arch::min(arch::max(x, 0.0), (CELLS - 1) as f32) as u32;
        let place = (ray.origin - self.low) * self.scale;
        let (x, y, z) = (cell(place.x), cell(place.y), cell(place.z));
        let mut bin = 0;
        let mut bit = BITS;
        while bit > 0 {
            bit -= 1;
            bin = bin << 3 | (x >> bit & 1) << 2 | (y >> bit & 1) << 1 | (z >> bit & 1);
        }
        let backwards = |x: f32| x.is_sign_negative() as u32;
        let d = ray.direction;
        bin = bin << 3 | backwards(d.x) << 2 | backwards(d.y) << 1 | backwards(d.z);
        // SAFETY: only ever added to, by this launch; a bin is below `BINS`.
        let number = unsafe { arch::add(self.bins.shared(bin), 1) };
        // SAFETY: one thread a ray.
        unsafe { self.places.set(thread.x, [bin, number]) };
    }
}

/// Adds up runs of bins, one thread a run.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sum {
    /// Rays of each bin.
    pub bins: View<u32>,
    /// Rays of each run, written.
    pub sums: ViewMut<u32>,
}

impl Sum {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x < RUNS {
            // SAFETY: one thread a run.
            unsafe { self.sums.set(thread.x, total(&self.bins, thread.x * RUN, RUN)) };
        }
    }
}

/// Of so many numbers from the first on.
#[inline(always)]
fn total(numbers: &View<u32>, first: u32, count: u32) -> u32 {
    let mut sum = 0;
    for index in first..first + count {
        sum += numbers.at(index);
    }
    sum
}

/// Finds where each bin begins, one thread a bin.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Begin {
    /// Rays of each bin.
    pub bins: View<u32>,
    /// Rays of each run of bins.
    pub sums: View<u32>,
    /// First place of each, written.
    pub begins: ViewMut<u32>,
}

impl Begin {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.bins.len() {
            return;
        }
        let run = thread.x / RUN;
        let begin = total(&self.sums, 0, run) + total(&self.bins, run * RUN, thread.x % RUN);
        // SAFETY: one thread a bin.
        unsafe { self.begins.set(thread.x, begin) };
    }
}

/// Moves the rays of a queue to their places, and empties the bins for the next.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// The rays.
    pub queue: View<Waiting>,
    /// Rays of each bounce.
    pub counts: View<u32>,
    /// Which bounce the queue is of.
    pub bounce: u32,
    /// As [`Tell`] found them.
    pub places: View<[u32; 2]>,
    /// As [`Begin`] found them.
    pub begins: View<u32>,
    /// Zero after.
    pub bins: ViewMut<u32>,
    /// In order, written.
    pub sorted: ViewMut<Waiting>,
}

impl Move {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x < self.bins.len() {
            // SAFETY: one thread a bin.
            unsafe { self.bins.set(thread.x, 0) };
        }
        if thread.x < self.counts.at(self.bounce) {
            let [bin, number] = self.places.at(thread.x);
            // SAFETY: every place is given out once.
            unsafe { self.sorted.set(self.begins.at(bin) + number, self.queue.load(thread.x)) };
        }
    }
}
