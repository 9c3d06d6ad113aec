//! A binary bounding volume hierarchy with both child boxes in the parent (after Aila and Laine 2009).

use super::{Counter, Structure, Visitor};
use crate::arch;
use crate::math::{vec3, Vec3};
use crate::ray::Ray;
use crate::stack::Stack;
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

/// The tree. Node 0 is the root; there always is one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bvh2 {
    /// Inner nodes.
    pub nodes: View<Node>,
    /// Triangles in the order of the leaves.
    pub triangles: View<Triangle>,
}

impl Structure for Bvh2 {
    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let slabs = Slabs::new(ray);
        let mut stack = Stack::<Child, MAX_DEPTH>::new();
        let mut t_far = ray.t_max;
        let mut next = Child::node(0);
        loop {
            // Go down to the nearest leaf, putting the other child aside where both are entered.
            while !next.is_leaf() {
                counter.node();
                let node = self.nodes.load(next.index());
                let left = slabs.enter(node.low[0], node.high[0], t_far);
                let right = slabs.enter(node.low[1], node.high[1], t_far);
                let [near, far] = node.children;
                next = match (left, right) {
                    (Some(left), Some(right)) => {
                        let (near, far) = if right < left { (far, near) } else { (near, far) };
                        stack.push(far);
                        near
                    }
                    (Some(_), None) => near,
                    (None, Some(_)) => far,
                    (None, None) => match stack.pop() {
                        Some(child) => child,
                        None => return,
                    },
                };
            }
            for index in next.index()..next.index() + next.count() {
                counter.triangle();
                t_far = visitor.visit(ray, &self.triangles.load(index));
                if t_far < ray.t_min {
                    return;
                }
            }
            next = match stack.pop() {
                Some(child) => child,
                None => return,
            };
        }
    }
}

/// A ray made ready for many boxes: each plane costs one fused step.
pub(super) struct Slabs {
    pub inverse: Vec3,
    /// `-origin * inverse`, rounded towards earlier; for the planes where a box is entered.
    pub enter: Vec3,
    /// The same rounded towards later; for the planes where a box is left.
    pub leave: Vec3,
    pub negative: [bool; 3],
    pub t_min: f32,
}

/// A few roundings of single precision, see [`Slabs::enter`].
pub(super) const SLACK: f32 = 8.0 / 16_777_216.0;

impl Slabs {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let inverse = ray.inverse_direction();
        let shift = -(ray.origin * inverse);
        let slack = vec3(shift.x.abs(), shift.y.abs(), shift.z.abs()) * SLACK;
        Self {
            inverse,
            enter: shift - slack,
            leave: shift + slack,
            negative: [inverse.x < 0.0, inverse.y < 0.0, inverse.z < 0.0],
            t_min: ray.t_min,
        }
    }

    /// Where the ray enters a box, if it does before `t_far`.
    ///
    /// Conservative, after Ize 2013: the distance `plane * inverse + shift` is off by at most two roundings of itself
    /// and two of `shift`; `enter` and `leave` already hold the latter, the end holds the former. NaN, which only
    /// infinite coordinates could make, counts as no limit.
    #[inline(always)]
    fn enter(&self, low: Vec3, high: Vec3, t_far: f32) -> Option<f32> {
        let select = |negative: bool, a: f32, b: f32| if negative { b } else { a };
        let [nx, ny, nz] = self.negative;
        let first = arch::max(
            arch::max(
                arch::fma(select(nx, low.x, high.x), self.inverse.x, self.enter.x),
                arch::fma(select(ny, low.y, high.y), self.inverse.y, self.enter.y),
            ),
            arch::max(arch::fma(select(nz, low.z, high.z), self.inverse.z, self.enter.z), self.t_min),
        );
        let last = arch::min(
            arch::min(
                arch::fma(select(nx, high.x, low.x), self.inverse.x, self.leave.x),
                arch::fma(select(ny, high.y, low.y), self.inverse.y, self.leave.y),
            ),
            arch::min(arch::fma(select(nz, high.z, low.z), self.inverse.z, self.leave.z), t_far),
        );
        (first <= arch::fma(last.abs(), SLACK, last)).then_some(first)
    }
}

const _: () = assert!(core::mem::size_of::<Node>() == 64);
