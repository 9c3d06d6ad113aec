//! A binary bounding volume hierarchy with both child boxes in the parent (after Aila and Laine 2009).

use super::binary::{walk, Boxes, Slab};
use super::nearest::NearestIndex;
use super::{Counter, NullStatistics, Structure, Visitor, WorldSpace};
use crate::arch::{self, Meeting};
use crate::math::Vec3;
use crate::ray::{Hit, Ray};
use crate::triangle::Triangle;
use crate::view::View;

/// Levels that a tree may have: the builder keeps to it and `validate` checks it, so the stack cannot overflow.
pub const MAX_DEPTH: usize = 64;

/// Most triangles of a leaf.
pub const MAX_LEAF: u32 = 15;

/// Most nodes, and most triangles.
pub const MAX_INDEX: u32 = (1 << 28) - 1;

/// A link to an inner node, or to a run of triangles.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

impl Child {
    /// The node at `index`, at most [`MAX_INDEX`].
    pub const fn node(index: u32) -> Self {
        Self(index)
    }

    /// `count` triangles, 1 to [`MAX_LEAF`], from `first` on.
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self(count << 28 | first)
    }

    /// Whether this is a run of triangles.
    #[inline(always)]
    pub const fn is_leaf(self) -> bool {
        self.0 >> 28 != 0
    }

    /// Of the node, or of the first triangle.
    #[inline(always)]
    pub const fn index(self) -> u32 {
        self.0 & MAX_INDEX
    }

    /// Triangles in the run; 0 for a node.
    #[inline(always)]
    pub const fn count(self) -> u32 {
        self.0 >> 28
    }

    /// The link as a number, as the stack keeps it.
    #[inline(always)]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The link of a number that [`bits`](Self::bits) gave.
    #[inline(always)]
    pub const fn of_bits(bits: u32) -> Self {
        Self(bits)
    }
}

/// An inner node: 64 bytes, read as four 128-bit words.
///
/// Boxes hold what is below them with a margin of 2^-22 of each triangle's extent, and of one step of the coordinate at
/// least: hits may lie that far beside a triangle, and a ray that runs in a face must enter.
///
/// A child that does not exist has an inverted box (`low > high`), which only rays whose distances overflow enter. For
/// those its link is to some triangle all the same.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Low corners of the boxes of the left and of the right child.
    pub low: [Vec3; 2],
    /// High corners.
    pub high: [Vec3; 2],
    /// Where the children are.
    pub children: [Child; 2],
    /// Makes 64 bytes.
    pub unused: [u32; 2],
}

impl Node {
    /// Whether there is a child on a side.
    #[inline(always)]
    pub fn has_child(&self, side: usize) -> bool {
        let (low, high) = (self.low[side], self.high[side]);
        low.x <= high.x && low.y <= high.y && low.z <= high.z
    }
}

/// The tree. Node 0 is the root; there always is one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bvh2 {
    /// Inner nodes.
    pub nodes: View<Node>,
    /// Triangles in the order of the leaves.
    pub triangles: View<Triangle>,
    /// Largest distance from zero of any box, axis by axis: the scale of the rounding errors of distances.
    pub reach: Vec3,
}

impl Structure for Bvh2 {
    const NAME: &'static str = "bvh2";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        walk(&Full::<ANY>::new(self, ray), self.triangles, ray, counter, visitor);
    }

    #[inline(always)]
    fn nearest(&self, ray: &Ray) -> Hit {
        let mut nearest = NearestIndex::of(self.triangles, ray);
        walk(&Full::<ANY>::new(self, ray), self.triangles, ray, &mut NullStatistics, &mut nearest);
        nearest.resolve()
    }
}

/// Instead of an octant: rays of any direction.
pub const ANY: u32 = 8;

/// The nodes as a ray sees them. `OCTANT` has a bit for each axis along which the ray runs backwards, known when the
/// kernel is compiled: then nothing has to be selected.
pub struct Full<const OCTANT: u32> {
    nodes: View<Node>,
    inverse: Vec3,
    slabs: [Slab; 3],
}

impl<const OCTANT: u32> Full<OCTANT> {
    /// For a ray in that octant.
    #[inline(always)]
    pub fn new(tree: &Bvh2, ray: &Ray) -> Self {
        let inverse = ray.inverse_direction();
        let slab = |i: u32| Slab::new(-(ray.origin[i] * inverse[i]), tree.reach[i] * inverse[i]);
        Self { nodes: tree.nodes, inverse, slabs: [slab(0), slab(1), slab(2)] }
    }

    #[inline(always)]
    fn backwards(&self, axis: u32) -> bool {
        if OCTANT == ANY {
            self.inverse[axis] < 0.0
        } else {
            OCTANT >> axis & 1 != 0
        }
    }

    #[inline(always)]
    fn meet(&self, low: Vec3, high: Vec3, link: Child, t_min: f32, t_far: f32) -> Meeting {
        // No closures: one that is called more than once is not inlined, and then has no fused instruction on the CPU.
        let (mut enter, mut leave) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let (near, far) = if self.backwards(i) { (high[i], low[i]) } else { (low[i], high[i]) };
            enter[i as usize] = arch::fma(near, self.inverse[i], self.slabs[i as usize].enter);
            leave[i as usize] = arch::fma(far, self.inverse[i], self.slabs[i as usize].leave);
        }
        super::binary::meeting(enter, leave, t_min, t_far, link.bits())
    }
}

impl<const OCTANT: u32> Boxes for Full<OCTANT> {
    #[inline(always)]
    fn children(&self, index: u32, t_min: f32, t_far: f32) -> [Meeting; 2] {
        let node = self.nodes.load(index);
        let left = self.meet(node.low[0], node.high[0], node.children[0], t_min, t_far);
        [left, self.meet(node.low[1], node.high[1], node.children[1], t_min, t_far)]
    }
}

const _: () = assert!(core::mem::size_of::<Node>() == 64);
