//! Lanes that are done get new rays (after Aila and Laine 2009).

use core::marker::PhantomData;

use super::form::Form;
use super::search::Search;
use raywarp_core::arch::{self, WARP};
use raywarp_core::kernels::Thread;
use raywarp_core::queue::Queue;
use raywarp_core::ray::{Ray, MISS};
use raywarp_core::traversal::bvh2::{Bvh2, MAX_DEPTH};
use raywarp_core::traversal::query::Query;
use raywarp_core::traversal::NullStatistics;
use raywarp_core::view::{View, ViewMut};

/// A warp asks for rays where fewer of 32 threads have one.
const LEAST: u32 = 20;

/// Answers a batch by as many threads as fit on the device at once, from one queue.
#[repr(C)]
pub struct Refill<F, Q: Query> {
    /// Where to find hits.
    pub tree: Bvh2,
    /// The batch.
    pub rays: View<Ray>,
    /// One a ray, written.
    pub answers: Q::Answers,
    /// Rays taken, and behind it the warps that are done; zero before and after.
    pub taken: ViewMut<u32>,
    /// Warps of the launch.
    pub warps: u32,
    /// In what order the threads of a warp take steps.
    pub form: PhantomData<F>,
}

impl<F: Form, Q: Query> Refill<F, Q> {
    #[inline(always)]
    pub(crate) fn run(&self, _: Thread) {
        let mut storage = [const { core::mem::MaybeUninit::uninit() }; MAX_DEPTH + 1];
        let mut search = Search::<Q>::idle(&self.tree, &mut storage);
        let queue = Queue::new(&self.taken, self.rays.len());
        let (mut index, mut left) = (MISS, true);
        // SAFETY: no thread leaves these loops before all of its warp do.
        let vote = |value: bool| unsafe { arch::ballot(u32::MAX, value) };
        loop {
            let wanting = vote(index == MISS);
            if left && wanting != 0 {
                let mine;
                (mine, left) = queue.take(wanting);
                if index == MISS && mine < self.rays.len() {
                    index = mine;
                    search.begin(&self.rays.load(index));
                }
            }
            loop {
                if index != MISS {
                    F::turn(&mut search, &mut NullStatistics);
                    if search.is_over() {
                        // SAFETY: every ray is taken once.
                        unsafe { Q::write(&self.answers, index, search.answer()) };
                        index = MISS;
                    }
                }
                let busy = vote(index != MISS).count_ones();
                if busy == 0 || (left && busy * 32 < LEAST * WARP) {
                    break;
                }
            }
            if !left && vote(index != MISS) == 0 {
                break;
            }
        }
        queue.leave(self.warps);
    }
}

impl<F, Q: Query> Clone for Refill<F, Q> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<F, Q: Query> Copy for Refill<F, Q> {}
