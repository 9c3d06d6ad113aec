//! What is asked of a ray.

use super::{NullStatistics, Structure, Visitor, ENOUGH};
use crate::ray::{Hit, HitArrays, Ray};
use crate::triangle::{RayShear, Triangle};
use crate::view::ViewMut;

/// A question about one ray, while it is being answered. Every triangle counts as opaque.
pub trait Query: Visitor + Sized {
    /// One a ray.
    type Answer: Copy + Send + Sync;
    /// Where the answers of a batch go.
    type Answers: Copy + Send + Sync;
    /// The question about a ray.
    fn about(ray: &Ray) -> Self;
    /// What the triangles seen so far say.
    fn answer(&self) -> Self::Answer;
    /// Asks a structure.
    #[inline(always)]
    fn search(structure: &impl Structure, ray: &Ray) -> Self::Answer {
        let mut query = Self::about(ray);
        structure.traverse(ray, &mut NullStatistics, &mut query);
        query.answer()
    }
    /// What a hit says that is found some other way: the first one, or where the visitor is not
    /// [`ORDERED`](Visitor::ORDERED) any one.
    fn from_hit(hit: Hit) -> Self::Answer;
    /// Writes the answer to ray `index`.
    ///
    /// # Safety
    /// No other thread has this index.
    unsafe fn write(answers: &Self::Answers, index: u32, answer: Self::Answer);
}

/// The answer about a ray.
#[inline(always)]
pub fn query<Q: Query>(structure: &impl Structure, ray: &Ray) -> Q::Answer {
    Q::search(structure, ray)
}

/// The first hit.
pub struct ClosestHit {
    t_min: f32,
    best: Hit,
}

impl Visitor for ClosestHit {
    const ENDS: bool = false;

    #[inline(always)]
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        triangle.if_hit(shear, |hit| {
            if hit.t >= self.t_min && hit.precedes(&self.best) {
                self.best = hit;
            }
        });
        self.best.t
    }
}

impl Query for ClosestHit {
    type Answer = Hit;
    type Answers = HitArrays;

    #[inline(always)]
    fn about(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, best: Hit { t: ray.t_max, ..Hit::NONE } }
    }

    #[inline(always)]
    fn answer(&self) -> Hit {
        if self.best.is_miss() {
            Hit::NONE
        } else {
            self.best
        }
    }

    #[inline(always)]
    fn search(structure: &impl Structure, ray: &Ray) -> Hit {
        structure.nearest(ray)
    }

    #[inline(always)]
    fn from_hit(hit: Hit) -> Hit {
        hit
    }

    #[inline(always)]
    unsafe fn write(answers: &HitArrays, index: u32, answer: Hit) {
        // SAFETY: the caller's promise.
        unsafe { answers.set(index, &answer) };
    }
}

/// Whether there is any hit: 0 or 1.
pub struct AnyHit {
    t_min: f32,
    t_max: f32,
    found: bool,
}

impl Visitor for AnyHit {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        triangle.if_hit(shear, |hit| self.found |= hit.t >= self.t_min && hit.t <= self.t_max);
        if self.found {
            ENOUGH
        } else {
            self.t_max
        }
    }
}

impl Query for AnyHit {
    type Answer = u32;
    type Answers = ViewMut<u32>;

    #[inline(always)]
    fn about(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, found: false }
    }

    #[inline(always)]
    fn answer(&self) -> u32 {
        self.found as u32
    }

    #[inline(always)]
    fn from_hit(hit: Hit) -> u32 {
        !hit.is_miss() as u32
    }

    #[inline(always)]
    unsafe fn write(answers: &ViewMut<u32>, index: u32, answer: u32) {
        // SAFETY: the caller's promise.
        unsafe { answers.set(index, answer) };
    }
}
