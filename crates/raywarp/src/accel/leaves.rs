//! From a binary [`Tree`] with one triangle a leaf to a [`Bvh2`]: subtrees become leaves where that costs less, the tree
//! is brought within traversal's stack, and nodes and triangles get their order in memory.
//!
//! [`Bvh2`]: super::bvh2::Bvh2
//!
//! The larger child follows its parent directly: more rays go there next than to the other.

use raywarp_core::traversal::bvh2::{Child, Node, MAX_DEPTH, MAX_LEAF};

use super::binary::{Tree, ROOT};
use super::bounds::Bounds;
use super::NODE_COST;

/// Cost of a triangle's test where nodes are weighed against leaves. Less than in the heuristic: the triangles of a leaf
/// lie side by side and are tested without a decision in between.
const TEST_COST: f64 = 0.7;

/// What is below a node.
#[derive(Clone, Copy, Default)]
struct Below {
    /// Least expected cost of a ray that meets the node's box, times half its area.
    cost: f64,
    /// References.
    count: u32,
    /// Inner nodes on the longest way down, itself included; 0 for a leaf.
    height: u32,
}

/// Most triangles of a leaf.
const MOST: u32 = 8;

const _: () = assert!(MOST <= MAX_LEAF);

/// The nodes of a [`Bvh2`], and the triangles in the order of its leaves. About `count` of those are to be expected.
pub(super) fn collapse(tree: &Tree, count: usize) -> (Vec<Node>, Vec<u32>) {
    let below = weigh(tree);
    let nodes = Vec::with_capacity(count / 2);
    let mut out = Emission { tree, below, nodes, order: Vec::with_capacity(count) };
    let root = out.child(ROOT, MAX_DEPTH);
    if root.is_leaf() {
        out.nodes.push(alone(root, tree.at(ROOT).bounds));
    }
    (out.nodes, out.order)
}

/// Decides from the leaves up.
fn weigh(tree: &Tree) -> Vec<Below> {
    let mut below = vec![Below::default(); tree.nodes().len()];
    for &index in tree.downwards().iter().rev() {
        let node = tree.at(index);
        let area = node.bounds.half_area();
        let Some(children) = node.link.children() else {
            below[index as usize] = Below { cost: TEST_COST * area, count: 1, height: 0 };
            continue;
        };
        let [left, right] = children.map(|child| below[child as usize]);
        let count = left.count + right.count;
        let inner = NODE_COST * area + left.cost + right.cost;
        let leaf = TEST_COST * area * f64::from(count);
        below[index as usize] = if count <= MOST && leaf <= inner {
            Below { cost: leaf, count, height: 0 }
        } else {
            Below { cost: inner, count, height: 1 + left.height.max(right.height) }
        };
    }
    below
}

struct Emission<'a> {
    tree: &'a Tree,
    below: Vec<Below>,
    nodes: Vec<Node>,
    /// Triangles in the order of the leaves.
    order: Vec<u32>,
}

impl Emission<'_> {
    /// Adds what is below a node, with at most `levels` inner nodes on the way to a leaf.
    fn child(&mut self, index: u32, levels: usize) -> Child {
        let Below { count, height, .. } = self.below[index as usize];
        let Some(children) = self.tree.at(index).link.children().filter(|_| height > 0) else {
            let leaves = self.leaves(index);
            return self.leaf(&leaves);
        };
        if height as usize > levels && halvings(count) >= levels {
            let leaves = self.leaves(index);
            return self.halved(&leaves);
        }
        let slot = self.nodes.len();
        let children = self.tree.by_area(children);
        self.nodes.push(node(&children.map(|child| self.tree.at(child).bounds)));
        let links = children.map(|child| self.child(child, levels - 1));
        self.nodes[slot].children = links;
        Child::node(slot as u32)
    }

    /// The references below a node.
    fn leaves(&self, index: u32) -> Vec<(u32, Bounds)> {
        let (mut leaves, mut open) = (Vec::new(), vec![index]);
        while let Some(index) = open.pop() {
            let node = self.tree.at(index);
            match (node.link.triangle(), node.link.children()) {
                (Some(triangle), _) => leaves.push((triangle, node.bounds)),
                (_, Some([left, right])) => open.extend([right, left]),
                _ => {}
            }
        }
        leaves
    }

    /// A run of triangles, none of them twice.
    fn leaf(&mut self, leaves: &[(u32, Bounds)]) -> Child {
        let first = self.order.len();
        for &(triangle, _) in leaves {
            if !self.order[first..].contains(&triangle) {
                self.order.push(triangle);
            }
        }
        Child::leaf(first as u32, (self.order.len() - first) as u32)
    }

    /// As balanced as can be, where the tree is too deep to keep: within [`halvings`] levels.
    fn halved(&mut self, leaves: &[(u32, Bounds)]) -> Child {
        if leaves.len() <= MOST as usize {
            return self.leaf(leaves);
        }
        let slot = self.nodes.len();
        let (left, right) = leaves.split_at(leaves.len().div_ceil(2));
        let around = |leaves: &[(u32, Bounds)]| leaves.iter().fold(Bounds::EMPTY, |all, (_, bounds)| all.join(bounds));
        self.nodes.push(node(&[around(left), around(right)]));
        let links = [left, right].map(|half| self.halved(half));
        self.nodes[slot].children = links;
        Child::node(slot as u32)
    }
}

/// How often so many references must be halved to become leaves.
fn halvings(count: u32) -> usize {
    count.div_ceil(MOST).next_power_of_two().trailing_zeros() as usize
}

/// With boxes, but no children yet.
pub(super) fn node(bounds: &[Bounds; 2]) -> Node {
    let [[low_left, high_left], [low_right, high_right]] = bounds.each_ref().map(Bounds::corners);
    Node { low: [low_left, low_right], high: [high_left, high_right], children: [NOTHING; 2], unused: [0; 2] }
}

/// Where a child that does not exist links to.
pub(super) const NOTHING: Child = Child::leaf(0, 1);

/// The root of a scene that is one leaf.
pub(super) fn alone(leaf: Child, bounds: Bounds) -> Node {
    Node { children: [leaf, NOTHING], ..node(&[bounds, Bounds::EMPTY]) }
}
