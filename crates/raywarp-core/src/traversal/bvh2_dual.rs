//! Two layouts of one tree, each for the rays that it suits.

use super::binary::{walk, LeafVisitor};
use super::bvh2::{Bvh2, Full};
use super::bvh2_quantized::{OnGrid, QuantizedBvh2};
use super::nearest::NearestIndex;
use super::{Counter, NullStatistics, Structure, Visitor, WorldSpace};
use crate::arch;
use crate::ray::{Hit, Ray};

/// Where all rays of a warp run in the same octant the full nodes are walked, by a loop that is compiled for the octant
/// and has nothing to select; other warps walk the compact nodes.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DualBvh2 {
    /// For rays that go the same way.
    pub full: Bvh2,
    /// For the rest, with the same triangles.
    pub quantized: QuantizedBvh2,
}

/// A bit for each axis along which the ray runs backwards; zero counts with its own sign, as in
/// [`inverse_direction`](Ray::inverse_direction).
#[inline(always)]
pub fn octant(ray: &Ray) -> u32 {
    let backwards = |x: f32| x.is_sign_negative() as u32;
    let d = ray.direction;
    backwards(d.x) | backwards(d.y) << 1 | backwards(d.z) << 2
}

impl Structure for DualBvh2 {
    const NAME: &'static str = "bvh";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        self.walk(ray, counter, visitor);
    }

    #[inline(always)]
    fn nearest(&self, ray: &Ray) -> Hit {
        let mut nearest = NearestIndex::of(self.full.triangles, ray);
        self.walk(ray, &mut NullStatistics, &mut nearest);
        nearest.resolve()
    }
}

impl DualBvh2 {
    #[inline(always)]
    fn walk(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl LeafVisitor) {
        let octant = octant(ray);
        let triangles = self.full.triangles;
        if !arch::uniform(octant) {
            return walk(&OnGrid::new(&self.quantized, ray), triangles, ray, counter, visitor);
        }
        match octant {
            0 => walk(&Full::<0>::new(&self.full, ray), triangles, ray, counter, visitor),
            1 => walk(&Full::<1>::new(&self.full, ray), triangles, ray, counter, visitor),
            2 => walk(&Full::<2>::new(&self.full, ray), triangles, ray, counter, visitor),
            3 => walk(&Full::<3>::new(&self.full, ray), triangles, ray, counter, visitor),
            4 => walk(&Full::<4>::new(&self.full, ray), triangles, ray, counter, visitor),
            5 => walk(&Full::<5>::new(&self.full, ray), triangles, ray, counter, visitor),
            6 => walk(&Full::<6>::new(&self.full, ray), triangles, ray, counter, visitor),
            _ => walk(&Full::<7>::new(&self.full, ray), triangles, ray, counter, visitor),
        }
    }
}
