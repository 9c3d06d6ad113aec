//! Rays of numbers that others keep in rows: origin and direction side by side, or each in an array of its own.

use crate::kernels::Thread;
use crate::math::vec3;
use crate::ray::Ray;
use crate::view::{View, ViewMut};

/// Puts origin and direction of each ray together, with ends that are the same for all.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct GatherRays {
    /// Three numbers for each ray, at the beginning of its row.
    pub origins: View<f32>,
    /// Likewise.
    pub directions: View<f32>,
    /// Numbers from the beginning of one row of `origins` to the next, 0 for one origin for all; and of `directions`.
    pub strides: [u32; 2],
    /// `t_min` and `t_max`.
    pub ends: [f32; 2],
    /// Written.
    pub rays: ViewMut<Ray>,
}

impl GatherRays {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let index = thread.x;
        if index < self.rays.len() {
            let vector = |numbers: &View<f32>, at: u32| vec3(numbers.at(at), numbers.at(at + 1), numbers.at(at + 2));
            let origin = vector(&self.origins, index * self.strides[0]);
            let direction = vector(&self.directions, index * self.strides[1]);
            let [t_min, t_max] = self.ends;
            // SAFETY: one thread a ray.
            unsafe { self.rays.set(index, Ray { origin, t_min, direction, t_max }) };
        }
    }
}
