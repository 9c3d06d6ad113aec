//! One thread a ray.

use core::marker::PhantomData;

use super::form::Form;
use super::search::Search;
use raywarp_core::kernels::Thread;
use raywarp_core::ray::Ray;
use raywarp_core::traversal::bvh2::{Bvh2, MAX_DEPTH};
use raywarp_core::traversal::query::Query;
use raywarp_core::traversal::NullStatistics;
use raywarp_core::view::View;

/// Answers a batch, one thread a ray.
#[repr(C)]
pub struct Direct<F, Q: Query> {
    /// Where to find hits.
    pub tree: Bvh2,
    /// The batch.
    pub rays: View<Ray>,
    /// One a ray, written.
    pub answers: Q::Answers,
    /// In what order the threads of a warp take steps.
    pub form: PhantomData<F>,
}

impl<F: Form, Q: Query> Direct<F, Q> {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.rays.len() {
            return;
        }
        let mut storage = [const { core::mem::MaybeUninit::uninit() }; MAX_DEPTH + 1];
        let mut search = Search::<Q>::idle(&self.tree, &mut storage);
        search.begin(&self.rays.load(thread.x));
        while !search.is_over() {
            F::turn(&mut search, &mut NullStatistics);
        }
        // SAFETY: one thread a ray.
        unsafe { Q::write(&self.answers, thread.x, search.answer()) };
    }
}

impl<F, Q: Query> Clone for Direct<F, Q> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<F, Q: Query> Copy for Direct<F, Q> {}
