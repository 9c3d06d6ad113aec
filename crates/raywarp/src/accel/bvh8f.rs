//! A hierarchy of eight boxes a node in full precision for the CPU, owned by the host.

use std::time::Instant;

use raywarp_core::ray::MISS;
use raywarp_core::traversal;
use raywarp_core::traversal::bvh2::{MAX_INDEX, MAX_LEAF};
use raywarp_core::traversal::bvh8f::{Block, Node, BLOCK, MAX_DEPTH};
use raywarp_core::triangle::Triangle;

use super::bvh2::Bvh2;
use super::collapse::{collapse, in_order, Link, Shape, WideNode, NOTHING};
use super::view::{lend, Borrowed};
use super::wide::{self, Layout, Region, Told};
use super::{BuildError, Invalid, TreeStats};

const SHAPE: Shape = Shape {
    leaf: MAX_LEAF as usize,
    node_cost: 1.0,
    leaf_cost: |count| 0.6 * count.div_ceil(BLOCK as usize) as f64,
    levels: MAX_DEPTH,
};

/// The tree. Parents come before their children. An empty scene is a root without children, and has one block without
/// triangles.
#[derive(Clone, Debug)]
pub struct Bvh8f {
    pub(crate) nodes: Vec<Node>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) build_seconds: f64,
}

impl Bvh8f {
    /// The best tree of this kind that a binary one can become.
    ///
    /// # Errors
    /// More triangles than links can tell apart if each took a block.
    pub fn from_bvh2(tree: &Bvh2) -> Result<Self, BuildError> {
        let start = Instant::now();
        BuildError::check(tree.triangles.len(), MAX_INDEX / BLOCK)?;
        let wide = collapse::<8>(tree, &SHAPE, in_order);
        let mut blocks = Vec::with_capacity(wide.triangles.len() / 2);
        let nodes = wide.nodes.iter().map(|node| encode(node, &wide.triangles, &mut blocks)).collect();
        if blocks.is_empty() {
            blocks.push(Block::new(&[]));
        }
        Ok(Self { nodes, blocks, build_seconds: tree.build_seconds + start.elapsed().as_secs_f64() })
    }

    /// A tree made elsewhere, if it is valid.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn from_parts(nodes: Vec<Node>, blocks: Vec<Block>) -> Result<Self, Invalid> {
        let tree = Self { nodes, blocks, build_seconds: 0.0 };
        tree.validate().map(|()| tree)
    }

    /// Inner nodes; 0 is the root.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Triangles in the order of the leaves, in fours.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// In the order of the leaves.
    pub fn triangles(&self) -> Vec<Triangle> {
        (0..self.places()).filter_map(|place| self.triangle(place)).collect()
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traversal::Bvh8f> {
        Borrowed::new(traversal::Bvh8f { nodes: lend(&self.nodes), blocks: lend(&self.blocks) })
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        wide::stats(self, self.build_seconds)
    }

    /// See [`Accel::validate`](super::Accel::validate).
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        wide::validate(self)
    }
}

fn encode(wide: &WideNode<8>, triangles: &[Triangle], blocks: &mut Vec<Block>) -> Node {
    let none = [[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]];
    let mut node =
        Node { planes: [none[0], none[0], none[0], none[1], none[1], none[1]], children: [NOTHING; 8], unused: [0; 8] };
    for (place, child) in wide.slots.iter().flatten().enumerate() {
        let link = match child.link {
            Link::Leaf(first, count) => {
                let link = Link::Leaf(blocks.len() as u32 * BLOCK, count);
                let run = &triangles[first as usize..(first + count) as usize];
                blocks.extend(run.chunks(BLOCK as usize).map(Block::new));
                link
            }
            node => node,
        };
        node.children[place] = link.into();
        for axis in 0..3 {
            node.planes[axis][place] = child.bounds.low[axis];
            node.planes[axis + 3][place] = child.bounds.high[axis];
        }
    }
    node
}

/// The children that exist.
/// The children of a node, slot by slot.
pub(super) fn told(node: &Node) -> [Option<Told>; 8] {
    let mut children = [None; 8];
    for (place, &child) in node.children.iter().enumerate() {
        let corner = |first: usize| [0, 1, 2].map(|axis| f64::from(node.planes[first + axis][place]));
        let region = Region { low: corner(0), high: corner(3) };
        if (0..3).all(|axis| region.low[axis] <= region.high[axis]) {
            children[place] = Some(Told { region, link: child.into() });
        }
    }
    children
}

impl Layout for Bvh8f {
    const LEVELS: usize = MAX_DEPTH;

    fn nodes(&self) -> usize {
        self.nodes.len()
    }

    fn children(&self, index: u32) -> Result<[Option<Told>; 8], Invalid> {
        let node = &self.nodes[index as usize];
        // What does not exist links to something all the same: see the kernels' `Node`.
        node.children.iter().try_for_each(|&child| wide::in_range(self, index, child.into()))?;
        let children = told(node);
        let is_off = |child: &Option<Told>| {
            child.is_some_and(|child| matches!(child.link, Link::Leaf(first, _) if first % BLOCK != 0))
        };
        match children.iter().position(is_off) {
            Some(slot) => Err(Invalid::Slot { node: index, slot }),
            None => Ok(children),
        }
    }

    fn places(&self) -> usize {
        self.blocks.len() * BLOCK as usize
    }

    fn triangle(&self, place: usize) -> Option<Triangle> {
        let triangle = self.blocks[place / BLOCK as usize].triangle(place % BLOCK as usize);
        (triangle.primitive != MISS).then_some(triangle)
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }
}
