//! Finding what a ray hits: several structures, one way to ask.
//!
//! A [`Structure`] hands every triangle that may matter to a visitor, roughly near to far, and the visitor answers how
//! far the ray is still of interest. Every query is a few lines on top of that. The answer depends on the triangles
//! alone, never on the structure: ties go to the smaller instance and primitive, see [`Hit::precedes`].

mod all;
pub mod binary;
pub mod brute;
pub mod bvh2;
pub mod bvh2_dual;
pub mod bvh2_quantized;
pub mod bvh8f;
pub mod instances;
pub mod kdtree;
mod nearest;
pub mod query;
mod slabs;
pub mod two_level;

use crate::ray::{Hit, Ray, MISS};
use crate::triangle::{flags, RayShear, Triangle};

pub use all::{all, Keep, Uncollected};
pub use brute::Brute;
pub use bvh2::Bvh2;
pub use bvh2_dual::DualBvh2;
pub use bvh2_quantized::QuantizedBvh2;
pub use bvh8f::Bvh8f;
pub use instances::{Instances, MeshStructure};
pub use kdtree::KdTree;
use query::{ClosestHit, Query};
pub use two_level::TwoLevel;

/// Answer of a visitor that has seen enough: no distance is left.
pub const ENOUGH: f32 = f32::NEG_INFINITY;

/// Something that holds triangles and finds those along a ray.
pub trait Structure: Copy + Send + Sync {
    /// What the names of its kernels end in.
    const NAME: &'static str;

    /// In which space the triangles of its hits are.
    type Space: Space;

    /// Shows `visitor` each triangle that the ray might meet between its `t_min` and the distance that the last
    /// call returned, at first its `t_max`. A triangle may come more than once.
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor);

    /// The first hit of a ray.
    #[inline(always)]
    fn nearest(&self, ray: &Ray) -> Hit {
        let mut query = ClosestHit::about(ray);
        self.traverse(ray, &mut NullStatistics, &mut query);
        query.answer()
    }
}

/// In which space the triangles of hits are, as shading finds them by instance and primitive.
pub trait Space {
    /// Whether an instance may have to be brought to world space.
    const OF_MESH: bool;
}

/// All triangles are in world space: shading costs nothing for instances.
pub struct WorldSpace;

/// Meshes that are placed by a transform are in a space of their own.
pub struct MeshSpace;

impl Space for WorldSpace {
    const OF_MESH: bool = false;
}

impl Space for MeshSpace {
    const OF_MESH: bool = true;
}

/// Who looks at the triangles of a traversal. Not a closure: those are inlined as the compiler sees fit, and a visitor
/// that is called instead makes the CPU more than twice as slow.
pub trait Visitor {
    /// Whether near triangles first is best. Where any order will do, binary trees of boxes go on with the larger child:
    /// it holds an obstacle sooner, and nothing has to be compared.
    const ORDERED: bool = true;

    /// Whether an answer may be less than the ray's `t_min`, which ends the traversal.
    const ENDS: bool = true;

    /// Looks at a triangle and answers how far along the ray it is still of interest: [`ENOUGH`] ends the traversal.
    /// `shear` is the traversal's ray, in the space of the triangle.
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32;
}

/// What traversal did, if anyone wants to know: [`NullStatistics`] costs nothing.
pub trait Counter: Default {
    /// A node was visited.
    #[inline(always)]
    fn node(&mut self) {}
    /// The triangles of a leaf come next; binary trees of boxes alone say so.
    #[inline(always)]
    fn leaf(&mut self) {}
    /// A triangle was tested.
    #[inline(always)]
    fn triangle(&mut self) {}
    /// A ray begins.
    #[inline(always)]
    fn ray(&mut self) {}
    /// Shading takes up the next of the rays that wait: a camera ray, or one that a surface sends on.
    #[inline(always)]
    fn branch(&mut self) {}
    /// The rays that follow, until the next branch, are towards a light.
    #[inline(always)]
    fn light(&mut self, _: u32) {}
    /// What follows, until the next call, belongs to a stage.
    #[inline(always)]
    fn stage(&mut self, _: Stage) {}
}

/// What a pixel's thread does in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Makes a camera ray.
    Generation,
    /// Looks for hits.
    Intersection,
    /// Everything else.
    Shading,
}

/// A counter whose counts a kernel keeps, pixel by pixel.
pub trait RecordedStatistics: Counter + Send + Sync {
    /// Whether anything is kept.
    const COUNTS: bool;
    /// What the names of kernels that keep it end in.
    const SUFFIX: &'static str;
    /// What is kept of a pixel.
    type Record: Copy + Send + Sync;
    /// What there was of the pixel, and this; `ticks` is the time that the thread took, see [`crate::arch::clock`].
    fn add_to(&self, record: Self::Record, ticks: u32) -> Self::Record;
}

/// Nobody wants to know.
#[derive(Clone, Copy, Debug, Default)]
pub struct NullStatistics;

impl Counter for NullStatistics {}

impl RecordedStatistics for NullStatistics {
    const COUNTS: bool = false;
    const SUFFIX: &'static str = "";
    type Record = Tests;
    #[inline(always)]
    fn add_to(&self, record: Tests, _: u32) -> Tests {
        record
    }
}

/// What the rays of a pixel cost.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tests {
    /// Nodes visited.
    pub nodes: u32,
    /// Ray-triangle tests, repeated ones included.
    pub triangles: u32,
    /// Rays of all kinds.
    pub rays: u32,
}

impl Counter for Tests {
    #[inline(always)]
    fn node(&mut self) {
        self.nodes += 1;
    }
    #[inline(always)]
    fn triangle(&mut self) {
        self.triangles += 1;
    }
    #[inline(always)]
    fn ray(&mut self) {
        self.rays += 1;
    }
}

impl RecordedStatistics for Tests {
    const COUNTS: bool = true;
    const SUFFIX: &'static str = "_counted";
    type Record = Tests;
    #[inline(always)]
    fn add_to(&self, record: Tests, _: u32) -> Tests {
        Tests {
            nodes: record.nodes.saturating_add(self.nodes),
            triangles: record.triangles.saturating_add(self.triangles),
            rays: record.rays.saturating_add(self.rays),
        }
    }
}

/// The first hit within the ray's limits that comes after `previous` (see [`Hit::precedes`]).
///
/// Stepping from hit to hit needs no epsilon: nothing is met twice and nothing is skipped, however close. Give
/// [`START`] for the first.
#[inline(always)]
pub fn closest(structure: &impl Structure, ray: &Ray, previous: &Hit, counter: &mut impl Counter) -> Hit {
    counter.ray();
    let ray = ray.after(previous);
    let mut nearest = Nearest::of(&ray, previous);
    counter.stage(Stage::Intersection);
    structure.traverse(&ray, counter, &mut nearest);
    counter.stage(Stage::Shading);
    if nearest.best.is_miss() {
        Hit::NONE
    } else {
        nearest.best
    }
}

/// Keeps the first hit after another.
struct Nearest<'a> {
    previous: &'a Hit,
    t_min: f32,
    best: Hit,
}

impl<'a> Nearest<'a> {
    /// Of a ray that begins where hits after `previous` are.
    #[inline(always)]
    fn of(ray: &Ray, previous: &'a Hit) -> Self {
        Self { previous, t_min: ray.t_min, best: Hit { t: ray.t_max, ..Hit::NONE } }
    }
}

impl Visitor for Nearest<'_> {
    const ENDS: bool = false;

    #[inline(always)]
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        triangle.if_hit(shear, |hit| {
            if hit.t >= self.t_min && hit.precedes(&self.best) && self.previous.precedes(&hit) {
                self.best = hit;
            }
        });
        self.best.t
    }
}

/// Before every hit.
pub const START: Hit = Hit { t: f32::NEG_INFINITY, u: 0.0, v: 0.0, primitive: MISS, instance: MISS };

/// What stands between the ends of a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occlusion {
    /// Nothing.
    Clear,
    /// Only triangles that may let light through: [`closest`] has to look at each.
    Filtered,
    /// Something opaque.
    Blocked,
}

/// Whether anything stands within the ray's limits, in any order.
#[inline(always)]
pub fn occlusion(structure: &impl Structure, ray: &Ray, counter: &mut impl Counter) -> Occlusion {
    counter.ray();
    let mut obstacle = Obstacle::of(ray);
    counter.stage(Stage::Intersection);
    structure.traverse(ray, counter, &mut obstacle);
    counter.stage(Stage::Shading);
    obstacle.found
}

/// Stops at the first opaque hit.
pub(crate) struct Obstacle {
    t_min: f32,
    t_max: f32,
    pub found: Occlusion,
}

impl Obstacle {
    /// Between the ends of a ray.
    #[inline(always)]
    pub fn of(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, found: Occlusion::Clear }
    }
}

impl Visitor for Obstacle {
    const ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, shear: &RayShear, triangle: &Triangle) -> f32 {
        let mut met = false;
        triangle.if_hit(shear, |hit| met = hit.t >= self.t_min && hit.t <= self.t_max);
        if !met {
            return self.t_max;
        }
        if triangle.flags & (flags::CUTOUT | flags::TRANSPARENT) == 0 {
            self.found = Occlusion::Blocked;
            return ENOUGH;
        }
        // Once blocked it stays so: where `t_min` is -inf, no answer is enough to end the traversal.
        if self.found == Occlusion::Clear {
            self.found = Occlusion::Filtered;
        }
        self.t_max
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{vec3, Vec3};
    use crate::view::View;

    #[test]
    fn an_opaque_triangle_blocks_whatever_comes_after_it() {
        let triangle =
            |z: f32, flags| Triangle::new(vec3(-1.0, -1.0, z), vec3(1.0, -1.0, z), vec3(0.0, 1.0, z), 0, flags);
        let triangles = [triangle(1.0, 0), triangle(2.0, flags::TRANSPARENT)];
        // SAFETY: the array outlives the view.
        let list = Brute { triangles: unsafe { View::new(triangles.as_ptr(), 2) } };
        for t_min in [0.0, f32::NEG_INFINITY] {
            let ray = Ray { t_min, ..Ray::new(Vec3::ZERO, vec3(0.0, 0.0, 1.0)) };
            assert_eq!(occlusion(&list, &ray, &mut NullStatistics), Occlusion::Blocked);
        }
    }
}
