//! Where a thread's time goes.

use raywarp_core::arch;
use raywarp_core::traversal::{Counter, RecordedStatistics, Stage};

/// A clock that is read wherever a stage begins. What it measures on a GPU is the time that passes while the thread is in
/// the stage, waiting for other threads of its warp included.
#[derive(Clone, Copy, Debug)]
pub struct Clocks {
    stage: Stage,
    since: u32,
    spent: StageTimes,
}

/// Time in each stage, in units of [`arch::clock`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageTimes {
    /// Making camera rays.
    pub generation: u32,
    /// Looking for hits.
    pub intersection: u32,
    /// Everything else.
    pub shading: u32,
}

impl Default for Clocks {
    #[inline(always)]
    fn default() -> Self {
        Self { stage: Stage::Shading, since: arch::clock(), spent: StageTimes::default() }
    }
}

impl Counter for Clocks {
    #[inline(always)]
    fn stage(&mut self, stage: Stage) {
        let now = arch::clock();
        let passed = now.wrapping_sub(self.since);
        let spent = match self.stage {
            Stage::Generation => &mut self.spent.generation,
            Stage::Intersection => &mut self.spent.intersection,
            Stage::Shading => &mut self.spent.shading,
        };
        *spent = spent.saturating_add(passed);
        (self.stage, self.since) = (stage, now);
    }
}

impl RecordedStatistics for Clocks {
    const COUNTS: bool = true;
    const SUFFIX: &'static str = "_clocked";
    type Record = StageTimes;

    #[inline(always)]
    fn add_to(&self, record: StageTimes, _: u32) -> StageTimes {
        StageTimes {
            generation: record.generation.saturating_add(self.spent.generation),
            intersection: record.intersection.saturating_add(self.spent.intersection),
            shading: record.shading.saturating_add(self.spent.shading),
        }
    }
}
