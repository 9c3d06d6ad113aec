//! Trees one after the other in one pair of arrays.

use std::collections::VecDeque;
use std::time::Instant;

use raywarp_core::traversal::bvh2::{Child, Node};
use raywarp_core::traversal::two_level::Instance;
use raywarp_core::triangle::Triangle;

use super::{InstancedStats, Part, TwoLevel};
use crate::accel::bounds::Bounds;
use crate::accel::bvh2::{child_box, children_of, Bvh2};
use crate::accel::BuildError;

/// The arrays under construction; the upper tree's nodes come first.
pub(super) struct Arrays {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    parts: Vec<Part>,
}

impl Arrays {
    pub fn new(upper: Vec<Node>) -> Self {
        Self { nodes: upper, triangles: Vec::new(), parts: Vec::new() }
    }

    /// # Errors
    /// More nodes or triangles than links can tell apart.
    pub fn add_all(&mut self, trees: Vec<Bvh2>) -> Result<(), BuildError> {
        let total = |count: fn(&Bvh2) -> usize| trees.iter().map(count).sum::<usize>();
        let (nodes, triangles) = (total(|tree| tree.nodes.len()), total(|tree| tree.triangles.len()));
        BuildError::check_index("triangles in different meshes", triangles)?;
        BuildError::check_index("nodes", self.nodes.len() + nodes)?;
        self.nodes.reserve_exact(nodes);
        self.triangles.reserve_exact(triangles);
        trees.into_iter().for_each(|tree| self.add(tree));
        Ok(())
    }

    fn add(&mut self, tree: Bvh2) {
        let part = Part { node: self.nodes.len() as u32, triangle: self.triangles.len() as u32 };
        let moved = |child: Child| match child.is_leaf() {
            true => Child::leaf(child.index() + part.triangle, child.count()),
            false => Child::node(child.index() + part.node),
        };
        self.nodes.extend(tree.nodes.iter().map(|node| Node { children: node.children.map(moved), ..*node }));
        self.triangles.extend(tree.triangles);
        self.parts.push(part);
    }

    /// Of the tree that was added as number `part`.
    pub fn root(&self, part: usize) -> Child {
        Child::node(self.parts[part].node)
    }

    pub fn finish(self, instances: Vec<Instance>, slack: f32, stats: InstancedStats, start: Instant) -> TwoLevel {
        let Self { nodes, triangles, parts } = self;
        let stats = InstancedStats {
            meshes: parts.len(),
            triangles: triangles.len(),
            bytes: size_of_val(&nodes[..]) + size_of_val(&triangles[..]) + size_of_val(&instances[..]),
            build_seconds: start.elapsed().as_secs_f64(),
            ..stats
        };
        TwoLevel { nodes, triangles, instances, slack, parts, stats }
    }
}

/// A box of an instance is that of about this many boxes of the mesh, each turned by itself: tighter than one.
const COVER: usize = 64;

/// Boxes that hold a tree together, whose root is at `root`; none where it is empty.
pub(super) fn cover(nodes: &[Node], root: Child) -> Vec<Bounds> {
    let mut open = VecDeque::from([root]);
    let mut boxes = Vec::new();
    while let Some(node) = open.pop_front().map(|node| &nodes[node.index() as usize]) {
        // As soon as there are enough, what is left to open is taken as it is.
        let enough = boxes.len() + open.len() >= COVER;
        for side in children_of(node) {
            let child = node.children[side];
            if child.is_leaf() || enough {
                boxes.push(child_box(node, side));
            } else {
                open.push_back(child);
            }
        }
    }
    boxes
}
