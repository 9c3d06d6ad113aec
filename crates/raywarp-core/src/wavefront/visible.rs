//! The closest hit of each ray where surfaces may have holes, or a side from which they are not seen.

use super::has_ended;
use crate::kernels::Thread;
use crate::material::flags;
use crate::ray::{Hit, HitArrays, Ray};
use crate::sample::{combine, number};
use crate::surface::Scene;
use crate::traversal::{closest, NullStatistics, Structure, START};
use crate::view::View;

/// As [`Closest`](crate::kernels::Closest), past what the ray does not meet. A surface that covers part is met as often as it
/// covers, by numbers that depend on the ray and the triangle alone.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Visible<S> {
    /// Where to find hits.
    pub structure: S,
    /// What is there.
    pub scene: Scene,
    /// The batch.
    pub rays: View<Ray>,
    /// 0: both sides of all surfaces are met.
    pub cull: u32,
    /// One a ray, written.
    pub hits: HitArrays,
}

impl<S: Structure> Visible<S> {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.rays.len() {
            return;
        }
        let ray = self.rays.load(thread.x);
        let mut hit = START;
        loop {
            hit = if has_ended(&ray) { Hit::NONE } else { closest(&self.structure, &ray, &hit, &mut NullStatistics) };
            if hit.is_miss() || self.meets(&ray, &hit) {
                break;
            }
        }
        // SAFETY: one thread a ray.
        unsafe { self.hits.set(thread.x, &hit) };
    }

    #[inline(always)]
    fn meets(&self, ray: &Ray, hit: &Hit) -> bool {
        let material = self.scene.material::<S::Space>(hit);
        if self.cull != 0 && material.flags & flags::SINGLE_SIDED != 0 && self.scene.is_inside::<S::Space>(ray, hit) {
            return false;
        }
        let coverage = self.scene.coverage::<S::Space>(hit, material);
        coverage >= 1.0 || number(key(ray), combine(hit.instance, hit.primitive)) < coverage
    }
}

/// From all bits of a ray.
#[inline(always)]
fn key(ray: &Ray) -> u32 {
    let mut key = 0;
    for axis in 0..3 {
        key = combine(combine(key, ray.origin[axis].to_bits()), ray.direction[axis].to_bits());
    }
    key
}
