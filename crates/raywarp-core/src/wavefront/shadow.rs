//! The share of light that comes along each ray where surfaces may have holes.

use super::has_ended;
use crate::kernels::Thread;
use crate::ray::Ray;
use crate::surface::Scene;
use crate::traversal::{closest, occlusion, NullStatistics, Occlusion, Structure, START};
use crate::view::{View, ViewMut};

/// As [`Occluded`](crate::kernels::Occluded), where what covers part takes its part. Both sides of all surfaces count.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Shadow<S> {
    /// Where to find hits.
    pub structure: S,
    /// What is there.
    pub scene: Scene,
    /// The batch.
    pub rays: View<Ray>,
    /// From 0 to 1 a ray, written.
    pub shares: ViewMut<f32>,
}

/// Less light than this is none: a quarter of an 8-bit step.
const FAINT: f32 = 1.0 / 1024.0;

impl<S: Structure> Shadow<S> {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.rays.len() {
            return;
        }
        let ray = self.rays.load(thread.x);
        let share = if has_ended(&ray) { 1.0 } else { self.share(&ray) };
        // SAFETY: one thread a ray.
        unsafe { self.shares.set(thread.x, share) };
    }

    #[inline(always)]
    fn share(&self, ray: &Ray) -> f32 {
        match occlusion(&self.structure, ray, &mut NullStatistics) {
            Occlusion::Clear => 1.0,
            Occlusion::Blocked => 0.0,
            Occlusion::Filtered => self.filter(ray),
        }
    }

    #[inline(always)]
    fn filter(&self, ray: &Ray) -> f32 {
        let (mut share, mut hit) = (1.0, START);
        loop {
            hit = closest(&self.structure, ray, &hit, &mut NullStatistics);
            if hit.is_miss() {
                return share;
            }
            let material = self.scene.material::<S::Space>(&hit);
            share *= 1.0 - self.scene.coverage::<S::Space>(&hit, material);
            if share <= FAINT {
                return 0.0;
            }
        }
    }
}
