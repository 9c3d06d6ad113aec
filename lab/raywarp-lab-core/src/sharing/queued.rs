//! Queues of work units, and stealing from them (after Wende 2013; with one queue, Aila and Laine's persistent threads).
//!
//! A unit is a warp's worth of rays. Each queue has a share of the units in one run, and a number that says how many of
//! them are taken: taking one is one atomic addition, whoever takes it. A warp whose own queue is empty goes on to the
//! next ones.

use core::marker::PhantomData;

use super::form::{Form, WhileWhile};
use super::search::Search;
use raywarp_core::arch::{self, WARP};
use raywarp_core::kernels::Thread;
use raywarp_core::ray::Ray;
use raywarp_core::traversal::bvh2::{Bvh2, MAX_DEPTH};
use raywarp_core::traversal::query::Query;
use raywarp_core::traversal::NullStatistics;
use raywarp_core::view::{View, ViewMut};
use raywarp_core::warp_counter::WarpCounter;

/// Answers a batch by as many threads as fit on the device at once.
#[repr(C)]
pub struct Queued<Q: Query> {
    /// Where to find hits.
    pub tree: Bvh2,
    /// The batch.
    pub rays: View<Ray>,
    /// One a ray, written.
    pub answers: Q::Answers,
    /// Units taken from each queue, and behind them the warps that are done; all zero before and after.
    pub taken: ViewMut<u32>,
    /// Warps that share a queue: those of a block, or one.
    pub warps_a_queue: u32,
    /// Queues that a warp looks into before it gives up, its own included.
    pub tries: u32,
    /// Warps of the launch.
    pub warps: u32,
    /// What is asked.
    pub query: PhantomData<Q>,
}

impl<Q: Query> Queued<Q> {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let queues = self.taken.len() - 1;
        let units = self.rays.len().div_ceil(WARP);
        let share = units.div_ceil(queues);
        let mut queue = thread.x / WARP / self.warps_a_queue % queues;
        let mut storage = [const { core::mem::MaybeUninit::uninit() }; MAX_DEPTH + 1];
        let mut search = Search::<Q>::idle(&self.tree, &mut storage);
        let mut tries = 0;
        while tries < self.tries {
            let first = (queue * share).min(units);
            let count = share.min(units - first);
            let warp_counter = WarpCounter::new(&self.taken, queue);
            // Looking costs less than taking, and most queues of others are empty when it comes to stealing.
            let taken = if tries > 0 { warp_counter.look() } else { 0 };
            let taken = if taken < count { warp_counter.take(1) } else { taken };
            if taken < count {
                self.answer((first + taken) * WARP + arch::lane(), &mut search);
            } else {
                tries += 1;
                queue = if queue + 1 < queues { queue + 1 } else { 0 };
            }
        }
        self.leave(queues);
    }

    #[inline(always)]
    fn answer(&self, index: u32, search: &mut Search<Q>) {
        if index < self.rays.len() {
            search.begin(&self.rays.load(index));
            while !search.is_over() {
                WhileWhile::turn(search, &mut NullStatistics);
            }
            // SAFETY: every unit is taken once.
            unsafe { Q::write(&self.answers, index, search.answer()) };
        }
        // SAFETY: all threads of the warp took this unit.
        unsafe { arch::syncwarp(u32::MAX) };
    }

    /// The last warp to leave sets the numbers back, for the next launch.
    #[inline(always)]
    fn leave(&self, queues: u32) {
        let done = WarpCounter::new(&self.taken, queues);
        if done.take(1) + 1 == self.warps {
            let mut index = arch::lane();
            while index <= queues {
                WarpCounter::new(&self.taken, index).clear();
                index += WARP;
            }
        }
    }
}

impl<Q: Query> Clone for Queued<Q> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<Q: Query> Copy for Queued<Q> {}
