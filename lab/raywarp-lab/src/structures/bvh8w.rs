//! A quantised hierarchy of eight boxes a node with a link for each child, owned by the host.

use std::time::Instant;

use raywarp::Triangle;
use raywarp_core::traversal::bvh2::MAX_LEAF;
use raywarp_lab_core::structures as kernels;
use raywarp_lab_core::structures::bvh8w::{Boxes, Node, MAX_DEPTH};

use super::grid::{byte, set_byte, Grid};
use super::lend;
use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::collapse::{collapse, in_order, Shape, WideNode, NOTHING};
use raywarp::accel::wide::{self, Layout, Told};
use raywarp::accel::{Borrowed, Invalid, TreeStats};

const SHAPE: Shape =
    Shape { leaf: MAX_LEAF as usize, node_cost: 1.0, leaf_cost: |count| 0.3 * count as f64, levels: MAX_DEPTH };

/// The tree. Parents come before their children. An empty scene is a root without children, and has one triangle
/// without area.
#[derive(Clone, Debug)]
pub struct Bvh8w {
    pub(crate) nodes: Vec<Node>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) build_seconds: f64,
}

impl Bvh8w {
    /// The best tree of this kind that a binary one can become.
    pub fn from_bvh2(tree: &Bvh2) -> Self {
        let start = Instant::now();
        let wide = collapse::<8>(tree, &SHAPE, in_order);
        let nodes = wide.nodes.iter().map(encode).collect();
        Self { nodes, triangles: wide.triangles, build_seconds: tree.build_seconds() + start.elapsed().as_secs_f64() }
    }

    /// A tree made elsewhere, if it is valid.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn from_parts(nodes: Vec<Node>, triangles: Vec<Triangle>) -> Result<Self, Invalid> {
        let tree = Self { nodes, triangles, build_seconds: 0.0 };
        tree.validate().map(|()| tree)
    }

    /// Inner nodes; 0 is the root.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// In the order of the leaves.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, kernels::Bvh8w> {
        // SAFETY: the arrays are borrowed as long, and the builder keeps indices in range.
        unsafe { Borrowed::of(kernels::Bvh8w { nodes: lend(&self.nodes), triangles: lend(&self.triangles) }) }
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        wide::stats(self, self.build_seconds)
    }

    /// See [`Accel::validate`](raywarp::accel::Accel::validate).
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        wide::validate(self)
    }
}

fn encode(wide: &WideNode<8>) -> Node {
    let grid = Grid::around(&wide.bounds);
    let mut boxes = Boxes {
        origin: grid.origin.into(),
        unused: 0,
        spacing: grid.spacing.into(),
        unused_too: 0,
        low: [[u32::MAX; 2]; 3],
        high: [[0; 2]; 3],
    };
    let mut children = [NOTHING; 8];
    for (slot, child) in wide.slots.iter().flatten().enumerate() {
        children[slot] = child.link.into();
        for (axis, [low, high]) in grid.planes(&child.bounds).into_iter().enumerate() {
            set_byte(&mut boxes.low[axis][slot / 4], slot % 4, low);
            set_byte(&mut boxes.high[axis][slot / 4], slot % 4, high);
        }
    }
    Node { boxes, children, unused: [0; 4] }
}

fn grid(boxes: &Boxes) -> Grid {
    Grid { origin: boxes.origin.to_array(), spacing: boxes.spacing.to_array() }
}

/// The children that exist.
pub(super) fn told(node: &Node) -> [Option<Told>; 8] {
    let boxes = &node.boxes;
    let mut children = [None; 8];
    for (slot, &child) in node.children.iter().enumerate() {
        let plane = |words: [[u32; 2]; 3], axis: usize| byte(words[axis][slot / 4], slot % 4);
        let planes = [0, 1, 2].map(|axis| [plane(boxes.low, axis), plane(boxes.high, axis)]);
        if planes.iter().all(|[low, high]| low <= high) {
            children[slot] = Some(Told { region: grid(boxes).region(planes), link: child.into() });
        }
    }
    children
}

impl Layout for Bvh8w {
    const LEVELS: usize = MAX_DEPTH;

    fn nodes(&self) -> usize {
        self.nodes.len()
    }

    fn children(&self, index: u32) -> Result<[Option<Told>; 8], Invalid> {
        let node = &self.nodes[index as usize];
        if !grid(&node.boxes).is_sound() {
            return Err(Invalid::Grid { node: index });
        }
        // What does not exist links to something all the same: see the kernels' `Boxes`.
        node.children.iter().try_for_each(|&child| wide::in_range(self, index, child.into()))?;
        Ok(told(node))
    }

    fn places(&self) -> usize {
        self.triangles.len()
    }

    fn triangle(&self, place: usize) -> Option<Triangle> {
        Some(self.triangles[place])
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..])
    }
}
