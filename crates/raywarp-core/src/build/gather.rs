//! Puts triangles into the order of the leaves.

use crate::kernels::Thread;
use crate::triangle::Triangle;
use crate::view::{View, ViewMut};

/// Copies triangles, one thread a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct GatherTriangles {
    /// As given.
    pub triangles: View<Triangle>,
    /// Which one is at each place.
    pub order: View<u32>,
    /// In that order, written.
    pub ordered: ViewMut<Triangle>,
}

impl GatherTriangles {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x < self.ordered.len() {
            // SAFETY: one thread a triangle.
            unsafe { self.ordered.set(thread.x, self.triangles.load(self.order.at(thread.x))) };
        }
    }
}
