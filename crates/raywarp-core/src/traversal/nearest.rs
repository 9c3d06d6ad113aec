//! The nearest hit of a structure whose triangles lie in one array: the loop keeps its index there, and reads behind the loop by
//! which instance and primitive it goes. In the loop those would take a register that traversal needs.

use super::binary::LeafVisitor;
use crate::ray::{Hit, Ray, MISS};
use crate::triangle::{RayShear, Triangle};
use crate::view::View;

/// Keeps the first hit.
pub(super) struct NearestIndex {
    triangles: View<Triangle>,
    t_min: f32,
    /// Distance and weights of the best so far; at first the ray's end.
    t: f32,
    u: f32,
    v: f32,
    /// Its place in the array; [`MISS`] for none.
    index: u32,
}

impl NearestIndex {
    /// Of a ray.
    #[inline(always)]
    pub fn of(triangles: View<Triangle>, ray: &Ray) -> Self {
        Self { triangles, t_min: ray.t_min, t: ray.t_max, u: 0.0, v: 0.0, index: MISS }
    }

    /// The hit, once the ray's way is over.
    #[inline(always)]
    pub fn resolve(&self) -> Hit {
        if self.index == MISS {
            return Hit::NONE;
        }
        let Triangle { primitive, instance, .. } = *self.triangles.item(self.index);
        Hit { t: self.t, u: self.u, v: self.v, primitive, instance }
    }

    /// Whether a hit at the distance of the best one comes before it.
    #[inline(always)]
    fn wins_tie(&self, hit: &Hit) -> bool {
        self.index == MISS || {
            let best = self.triangles.item(self.index);
            hit.id() < (best.instance, best.primitive)
        }
    }
}

impl LeafVisitor for NearestIndex {
    const ORDERED: bool = true;
    const ENDS: bool = false;

    #[inline(always)]
    fn visit_at(&mut self, index: u32, shear: &RayShear, triangle: &Triangle) -> f32 {
        triangle.if_hit(shear, |hit| {
            let nearer = hit.t < self.t || (hit.t == self.t && self.wins_tie(&hit));
            if hit.t >= self.t_min && nearer {
                (self.t, self.u, self.v, self.index) = (hit.t, hit.u, hit.v, index);
            }
        });
        self.t
    }
}
