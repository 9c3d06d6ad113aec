//! A binary hierarchy with 32-byte nodes: a child's box and link in one 16-byte word.
//!
//! Planes are 16 bits on a grid over the whole tree. A ray reads half as much as from [`bvh2`](super::bvh2) and computes
//! as much: a plane becomes a number by one permutation of bytes, which picks the near or the far one on the way. On a
//! GPU incoherent rays are limited by what they read, and gain; rays that go the same way are not.

use super::binary::{meeting, walk, Boxes, Slab};
use super::bvh2::Child;
use super::nearest::NearestIndex;
use super::{Counter, NullStatistics, Structure, Visitor, WorldSpace};
use crate::arch::{self, Meeting};
use crate::math::Vec3;
use crate::ray::{Hit, Ray};
use crate::triangle::Triangle;
use crate::view::View;

/// A child: its box on the grid, and where it is.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Low plane in the lower half and high plane in the upper half, for each axis.
    pub planes: [u32; 3],
    /// What is in the box.
    pub link: Child,
}

/// Both children. One that does not exist has low planes above its high ones.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// Left and right.
    pub children: [Corner; 2],
}

/// The grid: a plane `code` lies at `base + scale * position(code)`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Where position 0 would be.
    pub base: Vec3,
    /// Scene units per unit of position.
    pub scale: Vec3,
}

/// Positions are below this.
pub const END: f32 = 8.0;

/// Where a plane lies on its axis, from 2 to [`END`]: the code is the middle of a floating-point number, so that it
/// need not be converted. The lower third of the grid is twice as fine as the rest.
#[inline(always)]
pub fn position(code: u32) -> f32 {
    f32::from_bits(0x4000_0000 | code << 8)
}

/// Of the bytes of a plane pair and of `0x4000_0000`: the number of the low plane.
const LOW: u32 = 0x7104;
/// That of the high plane.
const HIGH: u32 = 0x7324;

/// The tree. Node 0 is the root; there always is one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct QuantizedBvh2 {
    /// Inner nodes.
    pub nodes: View<Node>,
    /// Triangles in the order of the leaves.
    pub triangles: View<Triangle>,
    /// What the planes mean.
    pub grid: Grid,
}

impl Structure for QuantizedBvh2 {
    const NAME: &'static str = "bvh2c";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        walk(&OnGrid::new(self, ray), self.triangles, ray, counter, visitor);
    }

    #[inline(always)]
    fn nearest(&self, ray: &Ray) -> Hit {
        let mut nearest = NearestIndex::of(self.triangles, ray);
        walk(&OnGrid::new(self, ray), self.triangles, ray, &mut NullStatistics, &mut nearest);
        nearest.resolve()
    }
}

/// The nodes as a ray sees them.
pub struct OnGrid {
    nodes: View<Node>,
    scale: Vec3,
    slabs: [Slab; 3],
    near: [u32; 3],
}

impl OnGrid {
    /// For any ray.
    #[inline(always)]
    pub fn new(tree: &QuantizedBvh2, ray: &Ray) -> Self {
        let inverse = ray.inverse_direction();
        let scale = tree.grid.scale * inverse;
        let slab = |i: u32| Slab::new((tree.grid.base[i] - ray.origin[i]) * inverse[i], END * scale[i]);
        let slabs = [slab(0), slab(1), slab(2)];
        // Without a limit the sums must not become NaN.
        let finite = |i: u32| if slabs[i as usize].leave < f32::INFINITY { scale[i] } else { 0.0 };
        let near = |i: u32| if inverse[i] < 0.0 { HIGH } else { LOW };
        Self {
            nodes: tree.nodes,
            scale: Vec3::new(finite(0), finite(1), finite(2)),
            slabs,
            near: [near(0), near(1), near(2)],
        }
    }

    #[inline(always)]
    fn meet(&self, child: Corner, t_min: f32, t_far: f32) -> Meeting {
        // No closures: see `bvh2`.
        let (mut enter, mut leave) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let near = f32::from_bits(arch::permute(child.planes[i], 0x4000_0000, self.near[i]));
            let far = f32::from_bits(arch::permute(child.planes[i], 0x4000_0000, self.near[i] ^ LOW ^ HIGH));
            enter[i] = arch::fma(near, self.scale[i as u32], self.slabs[i].enter);
            leave[i] = arch::fma(far, self.scale[i as u32], self.slabs[i].leave);
        }
        meeting(enter, leave, t_min, t_far, child.link.bits())
    }
}

impl Boxes for OnGrid {
    #[inline(always)]
    fn children(&self, index: u32, t_min: f32, t_far: f32) -> [Meeting; 2] {
        let [left, right] = self.nodes.load(index).children;
        [self.meet(left, t_min, t_far), self.meet(right, t_min, t_far)]
    }
}

const _: () = assert!(core::mem::size_of::<Node>() == 32);
