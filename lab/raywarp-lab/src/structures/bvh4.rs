//! A quantised hierarchy of four boxes a node, owned by the host.

use std::time::Instant;

use raywarp::Triangle;
use raywarp_core::traversal::bvh2::MAX_LEAF;
use raywarp_lab_core::structures as kernels;
use raywarp_lab_core::structures::bvh4::{Node, MAX_DEPTH};

use super::grid::{byte, set_byte, Grid};
use super::lend;
use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::collapse::{collapse, in_order, Shape, WideNode, NOTHING};
use raywarp::accel::wide::{self, Layout, Told};
use raywarp::accel::{Borrowed, Invalid, TreeStats};

const SHAPE: Shape =
    Shape { leaf: MAX_LEAF as usize, node_cost: 1.0, leaf_cost: |count| 0.5 * count as f64, levels: MAX_DEPTH };

/// The tree. Parents come before their children. An empty scene is a root without children, and has one triangle
/// without area.
#[derive(Clone, Debug)]
pub struct Bvh4 {
    pub(crate) nodes: Vec<Node>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) build_seconds: f64,
}

impl Bvh4 {
    /// The best tree of this kind that a binary one can become.
    pub fn from_bvh2(tree: &Bvh2) -> Self {
        let start = Instant::now();
        let wide = collapse::<4>(tree, &SHAPE, in_order);
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
    pub fn view(&self) -> Borrowed<'_, kernels::Bvh4> {
        // SAFETY: the arrays are borrowed as long, and the builder keeps indices in range.
        unsafe { Borrowed::of(kernels::Bvh4 { nodes: lend(&self.nodes), triangles: lend(&self.triangles) }) }
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

fn encode(wide: &WideNode<4>) -> Node {
    let grid = Grid::around(&wide.bounds);
    let mut node = Node {
        origin: grid.origin.into(),
        spacing: grid.spacing.into(),
        low: [u32::MAX; 3],
        high: [0; 3],
        children: [NOTHING; 4],
    };
    for (place, child) in wide.slots.iter().flatten().enumerate() {
        node.children[place] = child.link.into();
        for (axis, [low, high]) in grid.planes(&child.bounds).into_iter().enumerate() {
            set_byte(&mut node.low[axis], place, low);
            set_byte(&mut node.high[axis], place, high);
        }
    }
    node
}

fn grid(node: &Node) -> Grid {
    Grid { origin: node.origin.to_array(), spacing: node.spacing.to_array() }
}

/// The children that exist.
pub(super) fn told(node: &Node) -> [Option<Told>; 8] {
    let mut children = [None; 8];
    for (place, &child) in node.children.iter().enumerate() {
        let planes = [0, 1, 2].map(|axis| [byte(node.low[axis], place), byte(node.high[axis], place)]);
        if planes.iter().all(|[low, high]| low <= high) {
            children[place] = Some(Told { region: grid(node).region(planes), link: child.into() });
        }
    }
    children
}

impl Layout for Bvh4 {
    const LEVELS: usize = MAX_DEPTH;

    fn nodes(&self) -> usize {
        self.nodes.len()
    }

    fn children(&self, index: u32) -> Result<[Option<Told>; 8], Invalid> {
        let node = &self.nodes[index as usize];
        if !grid(node).is_sound() {
            return Err(Invalid::Grid { node: index });
        }
        // What does not exist links to something all the same: see the kernels' `Node`.
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
