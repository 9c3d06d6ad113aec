//! The boxes of a structure by their distance from the root, to be looked at.

use raywarp_core::math::Vec3;
use raywarp_core::traversal;
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::bvh2::{child_box, children_of};
use super::collapse::Link;
use super::wide::Told;
use super::{bvh2_quantized, bvh8f, kdtree, Accel};

/// Most boxes of a structure that are told at once.
pub const MAX_BOXES: usize = 1 << 14;

/// A box of a structure: a cell of a k-d tree that is not empty, else what a node or a leaf of a hierarchy is in.
///
/// Boxes of hierarchies are as traversal meets them, with their margins: those on a grid are a little larger than what is
/// in them, and may stick out of the box around them by less than two steps of that grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeBox {
    /// Low and high corner.
    pub bounds: [[f32; 3]; 2],
    /// Steps from the root, whose level is 0.
    pub level: u32,
    /// Whether it has triangles in it, or nothing, rather than boxes.
    pub is_leaf: bool,
}

impl Accel {
    /// The boxes down to a level, in the order of their levels. Those of one level and the leaves above it together hold
    /// all triangles. The last levels are left out, each as a whole, where there would be more than [`MAX_BOXES`]. A list
    /// of triangles has one box, an empty scene none.
    pub fn boxes(&self, level: u32) -> Vec<TreeBox> {
        match self {
            Self::Brute(list) => of_list(list.triangles(), level),
            Self::Kd(tree) => of_cells(tree.nodes(), tree.bounds(), level),
            Self::Bvh2(tree) => of_bvh2(tree.nodes(), level),
            Self::Bvh(tree) => of_bvh2(tree.full.nodes(), level),
            Self::Bvh8f(tree) => of_wide(tree.nodes(), level, bvh8f::told),
        }
    }
}

/// The boxes in one, and the nodes that tell what is in those; leaves that are no nodes have none.
type Parts = [Option<(Bounds, Option<u32>)>; 8];

/// The box of a list.
pub fn of_list(triangles: &[Triangle], level: u32) -> Vec<TreeBox> {
    let root = triangles.iter().map(Bounds::of).fold(Bounds::EMPTY, |all, bounds| all.join(&bounds));
    walk(root, level, |_, _| [None; 8])
}

/// The cells of a k-d tree, whose root goes from a low to a high corner.
pub fn of_cells(nodes: &[traversal::kdtree::Node], corners: [Vec3; 2], level: u32) -> Vec<TreeBox> {
    // The tree of an empty scene is a leaf.
    let is_empty = matches!(nodes, [node] if node.count() == 0);
    let [low, high] = corners.map(|corner| corner.to_array());
    let root = if is_empty { Bounds::EMPTY } else { Bounds { low, high } };
    walk(root, level, |node, cell| at(nodes, node, |node| cells(node, cell)))
}

/// The boxes of a binary hierarchy.
pub fn of_bvh2(nodes: &[traversal::bvh2::Node], level: u32) -> Vec<TreeBox> {
    of_nodes(level, |node| at(nodes, node, sides))
}

/// The same on a grid.
pub fn of_compact(
    nodes: &[traversal::bvh2_quantized::Node],
    grid: &traversal::bvh2_quantized::Grid,
    level: u32,
) -> Vec<TreeBox> {
    of_nodes(level, |node| at(nodes, node, |node| sides(&bvh2_quantized::expand(node, grid))))
}

/// The boxes of a hierarchy with many children a node, which `told` reads.
pub fn of_wide<N>(nodes: &[N], level: u32, told: impl Fn(&N) -> [Option<Told>; 8]) -> Vec<TreeBox> {
    of_nodes(level, |node| at(nodes, node, |node| parts(told(node))))
}

/// Around what is in node 0.
fn of_nodes(level: u32, parts: impl Fn(u32) -> Parts) -> Vec<TreeBox> {
    let root = parts(0).iter().flatten().fold(Bounds::EMPTY, |all, (part, _)| all.join(part));
    walk(root, level, |node, _| parts(node))
}

fn at<N>(nodes: &[N], node: u32, parts: impl Fn(&N) -> Parts) -> Parts {
    nodes.get(node as usize).map_or([None; 8], parts)
}

fn cells(node: &traversal::kdtree::Node, cell: &Bounds) -> Parts {
    let mut parts = [None; 8];
    if !node.is_leaf() {
        // A median may lie outside of the cell: one side of it is empty then.
        for ((part, place), link) in kdtree::cut(cell, *node).iter().zip(&mut parts).zip(node.below()..) {
            let part = part.meet(cell);
            *place = (!is_empty(&part)).then_some((part, Some(link)));
        }
    }
    parts
}

fn is_empty(Bounds { low, high }: &Bounds) -> bool {
    (0..3).any(|i| low[i] > high[i])
}

fn sides(node: &traversal::bvh2::Node) -> Parts {
    let mut parts = [None; 8];
    for side in children_of(node) {
        let child = node.children[side];
        parts[side] = Some((child_box(node, side), (!child.is_leaf()).then(|| child.index())));
    }
    parts
}

fn parts(children: [Option<Told>; 8]) -> Parts {
    children.map(|child| {
        child.map(|Told { region, link }| match link {
            Link::Node(node) => (region.bounds(), Some(node)),
            Link::Leaf(..) => (region.bounds(), None),
        })
    })
}

/// Opens node 0 and what is in it, level by level.
fn walk(root: Bounds, level: u32, parts: impl Fn(u32, &Bounds) -> Parts) -> Vec<TreeBox> {
    if is_empty(&root) {
        return Vec::new();
    }
    let leaf = |Bounds { low, high }, level| TreeBox { bounds: [low, high], level, is_leaf: true };
    let mut boxes = vec![leaf(root, 0)];
    // Places in `boxes`, and the nodes that are there.
    let mut open = vec![(0, 0)];
    for depth in 1.. {
        let (mut below, mut next) = (Vec::new(), Vec::new());
        for (place, node) in open {
            let [low, high] = boxes[place].bounds;
            for (bounds, node) in parts(node, &Bounds { low, high }).into_iter().flatten() {
                boxes[place].is_leaf = false;
                next.extend(node.map(|node| (boxes.len() + below.len(), node)));
                below.push(leaf(bounds, depth));
            }
        }
        if below.is_empty() || depth > level || boxes.len() + below.len() > MAX_BOXES {
            break;
        }
        boxes.append(&mut below);
        open = next;
    }
    boxes
}
