//! What is asked of a ray.

use super::{Nearest, Obstacle, Occlusion, Visitor, START};
use crate::ray::{Hit, Ray};
use crate::triangle::{Across, Triangle};

/// A question about one ray, while it is being answered.
pub trait Question: Visitor {
    /// One a ray, as kernels write it.
    type Answer: Copy + Send + Sync;
    /// The question about a ray.
    fn about(ray: &Ray) -> Self;
    /// What the triangles seen so far say.
    fn answer(&self) -> Self::Answer;
    /// What a hit says that is found some other way: the first one, or where the visitor is not
    /// [`ORDERED`](Visitor::ORDERED) any one.
    fn from_hit(hit: Hit) -> Self::Answer;
}

/// The first hit.
pub struct ClosestHit(Nearest<'static>);

impl Visitor for ClosestHit {
    #[inline(always)]
    fn visit(&mut self, across: &Across, triangle: &Triangle) -> f32 {
        self.0.visit(across, triangle)
    }
}

impl Question for ClosestHit {
    type Answer = Hit;

    #[inline(always)]
    fn about(ray: &Ray) -> Self {
        Self(Nearest::of(ray, &START))
    }

    #[inline(always)]
    fn answer(&self) -> Hit {
        if self.0.best.is_miss() {
            Hit::NONE
        } else {
            self.0.best
        }
    }

    #[inline(always)]
    fn from_hit(hit: Hit) -> Hit {
        hit
    }
}

/// Whether there is any hit: 0 or 1.
pub struct AnyHit(Obstacle);

impl Visitor for AnyHit {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, across: &Across, triangle: &Triangle) -> f32 {
        self.0.visit(across, triangle)
    }
}

impl Question for AnyHit {
    type Answer = u32;

    #[inline(always)]
    fn about(ray: &Ray) -> Self {
        Self(Obstacle::of(ray))
    }

    #[inline(always)]
    fn answer(&self) -> u32 {
        (self.0.found != Occlusion::Clear) as u32
    }

    #[inline(always)]
    fn from_hit(hit: Hit) -> u32 {
        !hit.is_miss() as u32
    }
}
