//! The boxes of a structure by their distance from the root, to be looked at.

use std::borrow::Cow;

use raywarp_kernels::traverse;
use raywarp_kernels::triangle::Triangle;

use super::bounds::Bounds;
use super::bvh2::{child_box, children_of};
use super::collapse::Link;
use super::wide::Told;
use super::{bvh4, bvh8, bvh8f, bvh8w, compact, kdtree, Accel, Resident};
use crate::backend::DeviceError;

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
        let nodes = match self {
            Self::Brute(list) | Self::Staged(list) => Nodes::List(Cow::from(list.triangles())),
            Self::Kd(tree) | Self::KdSah(tree) | Self::KdTrail(tree) => {
                Nodes::Kd(tree.nodes().into(), tree.bounds().map(|corner| corner.to_array()))
            }
            Self::Bvh2(tree) => Nodes::Bvh2(tree.nodes().into()),
            Self::Bvh2c(tree) => Nodes::Bvh2c(tree.nodes().into(), tree.grid),
            Self::Bvh(tree) => Nodes::Bvh2(tree.full.nodes().into()),
            Self::Bvh4(tree) => Nodes::Bvh4(tree.nodes().into()),
            Self::Bvh8(tree) => Nodes::Bvh8(tree.nodes().into()),
            Self::Bvh8w(tree) => Nodes::Bvh8w(tree.nodes().into()),
            Self::Bvh8f(tree) => Nodes::Bvh8f(tree.nodes().into()),
        };
        nodes.boxes(level)
    }
}

impl Resident {
    /// See [`Accel::boxes`]. Reads all nodes back from the device, as they are now.
    pub fn boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        let nodes = match self {
            Self::Brute { triangles } | Self::Staged { triangles } => Nodes::List(triangles.items()?),
            Self::Kd(tree) | Self::KdTrail(tree) => {
                Nodes::Kd(tree.nodes.items()?, tree.bounds.map(|corner| corner.to_array()))
            }
            Self::Bvh2 { nodes, .. } | Self::Bvh { full: nodes, .. } => Nodes::Bvh2(nodes.items()?),
            Self::Bvh2c { nodes, grid, .. } => Nodes::Bvh2c(nodes.items()?, *grid),
            Self::Bvh4 { nodes, .. } => Nodes::Bvh4(nodes.items()?),
            Self::Bvh8 { nodes, .. } => Nodes::Bvh8(nodes.items()?),
            Self::Bvh8w { nodes, .. } => Nodes::Bvh8w(nodes.items()?),
            Self::Bvh8f { nodes, .. } => Nodes::Bvh8f(nodes.items()?),
        };
        Ok(nodes.boxes(level))
    }
}

/// What is read of a structure for its boxes.
enum Nodes<'a> {
    List(Cow<'a, [Triangle]>),
    /// With the low and high corner of the root.
    Kd(Cow<'a, [traverse::kdtree::Node]>, [[f32; 3]; 2]),
    Bvh2(Cow<'a, [traverse::bvh2::Node]>),
    Bvh2c(Cow<'a, [traverse::compact::Node]>, traverse::compact::Grid),
    Bvh4(Cow<'a, [traverse::bvh4::Node]>),
    Bvh8(Cow<'a, [traverse::bvh8::Node]>),
    Bvh8w(Cow<'a, [traverse::bvh8w::Node]>),
    Bvh8f(Cow<'a, [traverse::bvh8f::Node]>),
}

/// The boxes in one, and the nodes that tell what is in those; leaves that are no nodes have none.
type Parts = [Option<(Bounds, Option<u32>)>; 8];

impl Nodes<'_> {
    fn boxes(&self, level: u32) -> Vec<TreeBox> {
        let root = match self {
            Self::List(triangles) => triangles.iter().map(Bounds::of).fold(Bounds::EMPTY, |all, b| all.join(&b)),
            // The tree of an empty scene is a leaf.
            Self::Kd(nodes, _) if matches!(&nodes[..], [node] if node.count() == 0) => Bounds::EMPTY,
            Self::Kd(_, [low, high]) => Bounds { low: *low, high: *high },
            _ => self.parts(0, &Bounds::ALL).iter().flatten().fold(Bounds::EMPTY, |all, (part, _)| all.join(part)),
        };
        walk(root, level, |node, cell| self.parts(node, cell))
    }

    /// What is in a node, which has the box `cell`.
    fn parts(&self, node: u32, cell: &Bounds) -> Parts {
        match self {
            Self::List(_) => [None; 8],
            Self::Kd(nodes, _) => at(nodes, node, |node| cells(node, cell)),
            Self::Bvh2(nodes) => at(nodes, node, sides),
            Self::Bvh2c(nodes, grid) => at(nodes, node, |node| sides(&compact::expand(node, grid))),
            Self::Bvh4(nodes) => at(nodes, node, |node| told(bvh4::told(node))),
            Self::Bvh8(nodes) => at(nodes, node, |node| told(bvh8::told(node).unwrap_or_default())),
            Self::Bvh8w(nodes) => at(nodes, node, |node| told(bvh8w::told(node))),
            Self::Bvh8f(nodes) => at(nodes, node, |node| told(bvh8f::told(node))),
        }
    }
}

fn at<N>(nodes: &[N], node: u32, parts: impl Fn(&N) -> Parts) -> Parts {
    nodes.get(node as usize).map_or([None; 8], parts)
}

fn cells(node: &traverse::kdtree::Node, cell: &Bounds) -> Parts {
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

fn sides(node: &traverse::bvh2::Node) -> Parts {
    let mut parts = [None; 8];
    for side in children_of(node) {
        let child = node.children[side];
        parts[side] = Some((child_box(node, side), (!child.is_leaf()).then(|| child.index())));
    }
    parts
}

fn told(children: [Option<Told>; 8]) -> Parts {
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
