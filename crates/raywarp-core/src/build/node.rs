//! A node of the binary tree as it is built: one triangle a leaf, and what is known of what is below.

use super::bounds::Bounds;
use crate::math::Vec3;

/// A link to a node, or to a triangle by its place in the sorted order.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Link(u32);

/// Set in the link to a triangle.
const LEAF: u32 = 1 << 31;

impl Link {
    /// To nothing.
    pub const NONE: Self = Self(u32::MAX);

    /// To the node of a number.
    #[inline(always)]
    pub const fn node(number: u32) -> Self {
        Self(number)
    }

    /// To the triangle at a place.
    #[inline(always)]
    pub const fn leaf(place: u32) -> Self {
        Self(LEAF | place)
    }

    /// Whether this is to a triangle.
    #[inline(always)]
    pub const fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    /// The place of the triangle, or the number of the node.
    #[inline(always)]
    pub const fn index(self) -> u32 {
        self.0 & !LEAF
    }

    /// As a number.
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

/// What is below a node, or a triangle alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Below {
    /// Least expected cost of a ray that meets the box, times half its area: what decides about leaves.
    pub cost: f32,
    /// The same by the costs of the surface area heuristic: what is told of the tree.
    pub sah: f32,
    /// Triangles.
    pub count: u32,
    /// Nodes that remain when subtrees have become leaves, the node itself included: 0 where it has become one.
    pub nodes: u32,
    /// Of those, how many are on the longest way down; in the upper half most triangles of a leaf.
    pub shape: u32,
}

/// Cost of a step to a node.
const NODE_COST: f32 = 1.0;

/// Cost of a triangle's test where nodes are weighed against leaves. Less than in the heuristic: the triangles of a leaf
/// lie side by side and are tested without a decision in between.
const TEST_COST: f32 = 0.7;

impl Below {
    /// Of one triangle, whose box has half this area.
    #[inline(always)]
    pub fn triangle(area: f32) -> Self {
        Self { cost: TEST_COST * area, sah: area, count: 1, nodes: 0, shape: 1 << 16 }
    }

    /// Of two parts in a box of half this area. They become a leaf where that costs less.
    #[inline(always)]
    pub fn join(area: f32, a: &Self, b: &Self) -> Self {
        let count = a.count + b.count;
        let (inner, leaf) = (NODE_COST * area + (a.cost + b.cost), TEST_COST * area * count as f32);
        if count <= super::MAX_LEAF && leaf <= inner {
            return Self { cost: leaf, sah: area * count as f32, count, nodes: 0, shape: count << 16 };
        }
        let height = 1 + a.height().max(b.height());
        let shape = a.largest_leaf().max(b.largest_leaf()) << 16 | height;
        Self { cost: inner, sah: area + (a.sah + b.sah), count, nodes: 1 + a.nodes + b.nodes, shape }
    }

    /// Nodes on the longest way down.
    #[inline(always)]
    pub fn height(&self) -> u32 {
        self.shape & 0xffff
    }

    /// Most triangles of a leaf.
    #[inline(always)]
    pub fn largest_leaf(&self) -> u32 {
        self.shape >> 16
    }
}

/// A node. Number 0 is the root.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Low corner of the box.
    pub low: Vec3,
    /// See [`Below::cost`].
    pub cost: f32,
    /// High corner.
    pub high: Vec3,
    /// See [`Below::sah`].
    pub sah: f32,
    /// The one with the larger box first.
    pub children: [Link; 2],
    /// See [`Below::count`].
    pub count: u32,
    /// See [`Below::nodes`].
    pub nodes: u32,
    /// See [`Below::shape`].
    pub shape: u32,
    /// The number that the node above gets if it takes this one in on the right.
    pub leader: u32,
    /// Number of the node above; of no meaning for the root.
    pub parent: u32,
    /// Makes 64 bytes.
    pub unused: u32,
}

const _: () = assert!(size_of::<Node>() == 64);

impl Node {
    /// Its box.
    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        Bounds { low: self.low, high: self.high }
    }

    /// What is below it.
    #[inline(always)]
    pub fn below(&self) -> Below {
        let Self { cost, sah, count, nodes, shape, .. } = *self;
        Below { cost, sah, count, nodes, shape }
    }
}
