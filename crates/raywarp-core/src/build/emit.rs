//! From the binary tree with one triangle a leaf to the nodes that traversal reads, depth first.
//!
//! A node's place is known from what is below the nodes around it: its first child follows it, its second one comes after
//! all that is below the first. So each thread finds its own place on the way up to the root, and then writes a whole small
//! subtree. The child with the larger box comes first: more rays go there next than to the other.

use core::mem::MaybeUninit;

use super::bounds::Bounds;
use super::node::{Below, Link, Node};
use super::quantize::quantize;
use super::subtrees::MOST;
use super::MAX_LEAF;
use crate::kernels::Thread;
use crate::math::Vec3;
use crate::traversal::bvh2::{self, Child};
use crate::traversal::bvh2_quantized::{self, Grid};
use crate::triangle::Triangle;
use crate::view::{View, ViewMut};

/// Writes the nodes and the order of the triangles, one thread a subtree.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct EmitNodes {
    /// The binary tree.
    pub tree: View<Node>,
    /// As given.
    pub triangles: View<Triangle>,
    /// Numbers of the nodes where threads begin.
    pub subtrees: View<u32>,
    /// Codes in ascending order, and which triangle each is of.
    pub sorted: View<[u32; 2]>,
    /// Around the root, for the small nodes.
    pub grid: Grid,
    /// Parents before their children, written.
    pub full: ViewMut<bvh2::Node>,
    /// The same on the grid, written; none where they are not wanted.
    pub small: ViewMut<bvh2_quantized::Node>,
    /// Which triangle is at each place of the leaves' order, written.
    pub order: ViewMut<u32>,
}

/// Where what is below a link goes: its first node and its first triangle.
#[derive(Clone, Copy)]
struct Place {
    node: u32,
    triangle: u32,
}

/// A child with its box.
#[derive(Clone, Copy)]
struct Part {
    link: Link,
    bounds: Bounds,
    below: Below,
}

impl EmitNodes {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x >= self.subtrees.len() {
            return;
        }
        let number = self.subtrees.at(thread.x);
        let node = self.tree.load(number);
        if node.nodes == 0 {
            return self.root_of_one_leaf(&node);
        }
        self.subtree(number, self.place(number, &node));
    }

    /// Up to the root: what comes before the node.
    #[inline(always)]
    fn place(&self, number: u32, node: &Node) -> Place {
        let (mut place, mut number, mut node) = (Place { node: 0, triangle: 0 }, number, *node);
        while number != 0 {
            let above = self.tree.load(node.parent);
            place.node += 1;
            if above.children[0] != Link::node(number) {
                place.node += above.nodes - 1 - node.nodes;
                place.triangle += above.count - node.count;
            }
            (number, node) = (node.parent, above);
        }
        place
    }

    /// Writes a node, and all below it if they are few: else others do.
    #[inline(always)]
    fn subtree(&self, number: u32, place: Place) {
        let mut open = [const { MaybeUninit::<(u32, Place)>::uninit() }; MOST as usize + 1];
        let mut count = 0;
        let mut next = Some((number, place));
        while let Some((number, place)) = next {
            let node = self.tree.load(number);
            let [first, second] = [self.part(node.children[0]), self.part(node.children[1])];
            let first_place = Place { node: place.node + 1, ..place };
            let second_place =
                Place { node: first_place.node + first.below.nodes, triangle: place.triangle + first.below.count };
            self.write(
                place.node,
                [first.bounds, second.bounds],
                [self.child(&first, first_place), self.child(&second, second_place)],
            );
            let is_small = node.nodes <= MOST;
            next = None;
            if is_small && second.below.nodes > 0 {
                next = Some((second.link.index(), second_place));
            }
            if is_small && first.below.nodes > 0 {
                if let Some(later) = next {
                    open[count].write(later);
                    count += 1;
                }
                next = Some((first.link.index(), first_place));
            }
            if next.is_none() && count > 0 {
                count -= 1;
                // SAFETY: written above, for every place below `count`; a subtree of so few nodes is not deeper.
                next = Some(unsafe { open[count].assume_init() });
            }
        }
    }

    #[inline(always)]
    fn part(&self, link: Link) -> Part {
        if link.is_leaf() {
            let bounds = Bounds::of(&self.triangles.load(self.sorted.at(link.index())[1]));
            return Part { link, bounds, below: Below { count: 1, ..Below::default() } };
        }
        let node = self.tree.load(link.index());
        Part { link, bounds: node.bounds(), below: node.below() }
    }

    /// The link to a child; where that is a leaf its triangles get their order.
    #[inline(always)]
    fn child(&self, part: &Part, place: Place) -> Child {
        if part.below.nodes > 0 {
            return Child::node(place.node);
        }
        self.leaf(part.link, place.triangle);
        Child::leaf(place.triangle, part.below.count)
    }

    /// Puts the triangles below a link into their order.
    #[inline(always)]
    fn leaf(&self, link: Link, mut place: u32) {
        let mut open = [const { MaybeUninit::<Link>::uninit() }; MAX_LEAF as usize];
        let (mut count, mut next) = (0, link);
        loop {
            while !next.is_leaf() {
                let [first, second] = self.tree.item(next.index()).children;
                open[count].write(second);
                count += 1;
                next = first;
            }
            // SAFETY: every triangle has one place.
            unsafe { self.order.set(place, self.sorted.at(next.index())[1]) };
            place += 1;
            if count == 0 {
                return;
            }
            count -= 1;
            // SAFETY: written above, for every place below `count`; a leaf has no more triangles than places here.
            next = unsafe { open[count].assume_init() };
        }
    }

    #[inline(always)]
    fn root_of_one_leaf(&self, root: &Node) {
        self.leaf(if root.count == 1 { root.children[0] } else { Link::node(0) }, 0);
        let nothing = Bounds { low: Vec3::splat(f32::MAX), high: Vec3::splat(-f32::MAX) };
        self.write(0, [root.bounds(), nothing], [Child::leaf(0, root.count), Child::leaf(0, 1)]);
    }

    #[inline(always)]
    fn write(&self, index: u32, [a, b]: [Bounds; 2], children: [Child; 2]) {
        let node = bvh2::Node { low: [a.low, b.low], high: [a.high, b.high], children, unused: [0; 2] };
        // SAFETY: every node has one place.
        unsafe {
            self.full.set(index, node);
            if !self.small.is_empty() {
                self.small.set(index, quantize(&node, &self.grid));
            }
        }
    }
}
