//! One queue of a batch's rays, for lanes that are done.

use crate::arch;
use crate::view::ViewMut;
use crate::warp_counter::WarpCounter;

/// Rays taken, in the numbers that all warps share.
const TAKEN: u32 = 0;

/// Warps that are done.
const DONE: u32 = 1;

/// The rays of a batch from the first to the last, each given to one lane. All threads of a warp ask together.
#[derive(Clone, Copy)]
pub struct Queue<'a> {
    numbers: &'a ViewMut<u32>,
    rays: u32,
}

impl<'a> Queue<'a> {
    /// Of so many rays, by two numbers that are zero before the launch and after.
    #[inline(always)]
    pub fn new(numbers: &'a ViewMut<u32>, rays: u32) -> Self {
        Self { numbers, rays }
    }

    /// A ray for each of these lanes, as a place that may be beyond the last ray; and whether there may be more.
    #[inline(always)]
    pub fn take(&self, lanes: u32) -> (u32, bool) {
        let first = WarpCounter::new(self.numbers, TAKEN).take(lanes.count_ones());
        let mine = first + (lanes & arch::lanes_below()).count_ones();
        (mine, first + lanes.count_ones() < self.rays)
    }

    /// The last of so many warps to leave sets the numbers back for the next launch.
    #[inline(always)]
    pub fn leave(&self, warps: u32) {
        if WarpCounter::new(self.numbers, DONE).take(1) + 1 == warps && arch::lane() == 0 {
            WarpCounter::new(self.numbers, TAKEN).clear();
            WarpCounter::new(self.numbers, DONE).clear();
        }
    }
}
