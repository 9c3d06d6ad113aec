//! A hierarchy of eight boxes a node in full precision, laid out for the vector registers of a CPU.
//!
//! The loops over eight boxes and over four triangles have no branches and become vector instructions by themselves. (After
//! the 8-wide nodes and triangles in fours of Embree, Wald and others 2014.)

use super::binary::SLACK;
use super::bvh2::Child;
use super::slabs::Slabs;
use super::{Counter, Structure, Visitor, WorldSpace};
use crate::arch;
use crate::math::Vec3;
use crate::packet::TrianglePacket;
use crate::ray::Ray;
use crate::stack::{Stack, Storage};
use crate::triangle::RayShear;
use crate::view::View;

/// Levels that a tree may have: the builder keeps to it and `validate` checks it, so the stack cannot overflow.
pub const MAX_DEPTH: usize = 32;

/// A node: four cache lines of a CPU.
///
/// Children that do not exist have inverted boxes (low plane infinite, high plane minus infinite), which only rays of
/// NaN enter. For those their links are to some triangle all the same. Boxes hold what is below them with the margin of
/// [`bvh2::Node`](super::bvh2::Node).
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Low planes of x, y and z of all children, then high planes.
    pub planes: [[f32; 8]; 6],
    /// Nodes, or runs of triangles whose first is the first of a block.
    pub children: [Child; 8],
    /// Makes 256 bytes.
    pub unused: [u32; 8],
}

/// Four triangles; those of a leaf that does not fill its last block come first.
pub type Block = TrianglePacket;

/// Triangles of a block.
pub const BLOCK: u32 = 4;

/// The tree. Node 0 is the root; there always is one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bvh8f {
    /// Inner nodes.
    pub nodes: View<Node>,
    /// Triangles in the order of the leaves, [`BLOCK`] each: triangle `i` is in block `i / BLOCK`.
    pub blocks: View<Block>,
}

/// A child that waits, and where the ray enters it.
#[derive(Clone, Copy)]
struct Entry {
    t: f32,
    child: Child,
}

impl Structure for Bvh8f {
    const NAME: &'static str = "bvh8f";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let slabs = Slabs::new(ray);
        let sides = Sides::new(&slabs);
        let shear = RayShear::new(ray);
        let mut storage = Storage::<Entry, { 7 * MAX_DEPTH + 1 }>::new();
        let mut stack = Stack::new(&mut storage);
        let mut t_far = ray.t_max;
        let mut next = Child::node(0);
        loop {
            while !next.is_leaf() {
                counter.node();
                let node = self.nodes.item(next.index());
                let (entered, at) = node.entered(&slabs, &sides, t_far);
                next = match nearest_first(entered, &at, &node.children, &mut stack) {
                    Some(child) => child,
                    None => match pop(&mut stack, t_far) {
                        Some(child) => child,
                        None => return,
                    },
                };
            }
            let (mut index, mut left) = (next.index() / BLOCK, next.count());
            while left > 0 {
                let block = self.blocks.item(index);
                let count = if left < BLOCK { left } else { BLOCK };
                (index, left) = (index + 1, left - count);
                for _ in 0..count {
                    counter.triangle();
                }
                let mut close = block.may_be_hit(&shear) & ((1 << count) - 1);
                while close != 0 {
                    let lane = close.trailing_zeros();
                    close &= close - 1;
                    t_far = visitor.visit(&shear, &block.triangle(lane as usize));
                    if t_far < ray.t_min {
                        return;
                    }
                }
            }
            next = match pop(&mut stack, t_far) {
                Some(child) => child,
                None => return,
            };
        }
    }
}

/// Which planes a ray meets where it enters a box, as indices of [`Node::planes`]; it leaves at the opposite ones.
struct Sides([usize; 3]);

impl Sides {
    #[inline(always)]
    fn new(slabs: &Slabs) -> Self {
        let [x, y, z] = slabs.negative;
        Self([3 * x as usize, 1 + 3 * y as usize, 2 + 3 * z as usize])
    }
}

impl Node {
    /// Which children the ray enters before `t_far`, and where; as conservative as [`Slabs`]'s own test.
    #[inline(always)]
    fn entered(&self, slabs: &Slabs, sides: &Sides, t_far: f32) -> (u32, [f32; 8]) {
        let [inverse, enter, leave] = [slabs.inverse, slabs.enter, slabs.leave].map(Vec3::to_array);
        let (mut first, mut last) = ([slabs.t_min; 8], [t_far; 8]);
        for axis in 0..3 {
            let near = &self.planes[sides.0[axis]];
            let far = &self.planes[opposite(sides.0[axis])];
            for i in 0..8 {
                first[i] = greater(arch::fma(near[i], inverse[axis], enter[axis]), first[i]);
                last[i] = lesser(arch::fma(far[i], inverse[axis], leave[axis]), last[i]);
            }
        }
        let mut reach = [0.0; 8];
        for i in 0..8 {
            reach[i] = arch::fma(last[i].abs(), SLACK, last[i]);
        }
        (arch::at_most(&first, &reach), first)
    }
}

#[inline(always)]
fn opposite(side: usize) -> usize {
    if side < 3 {
        side + 3
    } else {
        side - 3
    }
}

/// Of two distances, `known` where the other is NaN: one instruction of a vector.
#[inline(always)]
fn greater(t: f32, known: f32) -> f32 {
    if t > known {
        t
    } else {
        known
    }
}

#[inline(always)]
fn lesser(t: f32, known: f32) -> f32 {
    if t < known {
        t
    } else {
        known
    }
}

/// The nearest of the children that are entered; the others go onto the stack, the nearer the later.
#[inline(always)]
fn nearest_first<const N: usize>(
    mut entered: u32,
    at: &[f32; 8],
    children: &[Child; 8],
    stack: &mut Stack<'_, Entry, N>,
) -> Option<Child> {
    if entered == 0 {
        return None;
    }
    let entry = |entered: u32| {
        let i = entered.trailing_zeros() as usize & 7;
        Entry { t: at[i], child: children[i] }
    };
    let mut nearest = entry(entered);
    entered &= entered - 1;
    if entered == 0 {
        return Some(nearest.child);
    }
    let base = stack.len();
    while entered != 0 {
        let mut other = entry(entered);
        entered &= entered - 1;
        if other.t < nearest.t {
            core::mem::swap(&mut other, &mut nearest);
        }
        stack.insert(other, base, |below, above| below.t < above.t);
    }
    Some(nearest.child)
}

/// The nearest child that still matters.
#[inline(always)]
fn pop<const N: usize>(stack: &mut Stack<'_, Entry, N>, t_far: f32) -> Option<Child> {
    let reach = arch::fma(t_far.abs(), SLACK, t_far);
    loop {
        let entry = stack.pop()?;
        if entry.t <= reach {
            return Some(entry.child);
        }
    }
}

const _: () = assert!(core::mem::size_of::<Node>() == 256);
