//! One thread a ray.

use core::marker::PhantomData;

use super::form::Form;
use super::search::Search;
use raywarp_kernels::kernels::Thread;
use raywarp_kernels::ray::Ray;
use raywarp_kernels::traverse::bvh2::{Bvh2, MAX_DEPTH};
use raywarp_kernels::traverse::question::Question;
use raywarp_kernels::traverse::Uncounted;
use raywarp_kernels::view::{View, ViewMut};

/// Answers a batch, one thread a ray.
#[repr(C)]
pub struct Direct<F, Q: Question> {
    /// Where to find hits.
    pub tree: Bvh2,
    /// The batch.
    pub rays: View<Ray>,
    /// One a ray, written.
    pub answers: ViewMut<Q::Answer>,
    /// In what order the threads of a warp take steps.
    pub form: PhantomData<F>,
}

impl<F: Form, Q: Question> Direct<F, Q> {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.rays.len() {
            return;
        }
        let mut room = [const { core::mem::MaybeUninit::uninit() }; MAX_DEPTH + 1];
        let mut search = Search::<Q>::idle(&self.tree, &mut room);
        search.begin(&self.rays.load(thread.x));
        while !search.is_over() {
            F::turn(&mut search, &mut Uncounted);
        }
        // SAFETY: one thread a ray.
        unsafe { self.answers.set(thread.x, search.answer()) };
    }
}

impl<F, Q: Question> Clone for Direct<F, Q> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<F, Q: Question> Copy for Direct<F, Q> {}
