//! A compressed hierarchy of eight boxes a node, owned by the host (Ylitie, Karras and Laine 2017).

use std::time::Instant;

use raywarp::Triangle;
use raywarp_lab_core::structures as kernels;
use raywarp_lab_core::structures::bvh8::{Node, Slot, MAX_DEPTH, MAX_LEAF};

use super::grid::{byte, set_byte, Grid};
use super::lend;
use super::slots::by_octant;
use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::collapse::{collapse, Link, Shape, WideNode};
use raywarp::accel::wide::{self, Layout, Told};
use raywarp::accel::{Borrowed, Invalid, TreeStats};

const SHAPE: Shape =
    Shape { leaf: MAX_LEAF as usize, node_cost: 1.0, leaf_cost: |count| 0.3 * count as f64, levels: MAX_DEPTH };

/// The tree. Parents come before their children. An empty scene is a root without children, and has one triangle
/// without area.
#[derive(Clone, Debug)]
pub struct Bvh8 {
    pub(crate) nodes: Vec<Node>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) build_seconds: f64,
}

impl Bvh8 {
    /// The best tree of this kind that a binary one can become.
    pub fn from_bvh2(tree: &Bvh2) -> Self {
        let start = Instant::now();
        let wide = collapse::<8>(tree, &SHAPE, by_octant);
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
    pub fn view(&self) -> Borrowed<'_, kernels::Bvh8> {
        // SAFETY: the arrays are borrowed as long, and the builder keeps indices in range.
        unsafe { Borrowed::of(kernels::Bvh8 { nodes: lend(&self.nodes), triangles: lend(&self.triangles) }) }
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
    let grid = Grid::of_powers(&wide.bounds);
    let exponents = grid.spacing.map(|spacing| spacing.to_bits() >> 23);
    let mut node = Node {
        origin: grid.origin.into(),
        exponents: exponents[0] | exponents[1] << 8 | exponents[2] << 16,
        nodes: 0,
        triangles: 0,
        slots: [u32::from_ne_bytes([Slot::EMPTY; 4]); 2],
        low: [[0; 2]; 3],
        high: [[0; 2]; 3],
    };
    let links = || wide.slots.iter().flatten().map(|slot| slot.link);
    node.nodes = links().find_map(|link| if let Link::Node(index) = link { Some(index) } else { None }).unwrap_or(0);
    let first = links().find_map(|link| if let Link::Leaf(first, _) = link { Some(first) } else { None });
    node.triangles = first.unwrap_or(0);
    for (slot, child) in wide.slots.iter().enumerate() {
        let Some(child) = child else { continue };
        let (half, place) = (slot / 4, slot % 4);
        let what = match child.link {
            Link::Node(_) => Slot::node(slot as u8),
            Link::Leaf(first, count) => Slot::leaf((first - node.triangles) as u8, count as u8),
        };
        node.exponents |= u32::from(matches!(child.link, Link::Node(_))) << (24 + slot);
        set_byte(&mut node.slots[half], place, what);
        for (axis, [low, high]) in grid.planes(&child.bounds).into_iter().enumerate() {
            set_byte(&mut node.low[axis][half], place, low);
            set_byte(&mut node.high[axis][half], place, high);
        }
    }
    node
}

impl Layout for Bvh8 {
    const LEVELS: usize = MAX_DEPTH;

    fn nodes(&self) -> usize {
        self.nodes.len()
    }

    fn children(&self, index: u32) -> Result<[Option<Told>; 8], Invalid> {
        let node = &self.nodes[index as usize];
        if !grid(node).is_sound() {
            return Err(Invalid::Grid { node: index });
        }
        told(node).map_err(|slot| Invalid::Slot { node: index, slot })
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

fn grid(node: &Node) -> Grid {
    let spacing = [0, 1, 2].map(|axis| f32::from_bits(u32::from(byte(node.exponents, axis)) << 23));
    Grid { origin: node.origin.to_array(), spacing }
}

/// The children, or the first slot that makes no sense.
pub(super) fn told(node: &Node) -> Result<[Option<Told>; 8], usize> {
    let mut children = [None; 8];
    for (slot, child) in children.iter_mut().enumerate() {
        let planes = |words: [[u32; 2]; 3], axis: usize| byte(words[axis][slot / 4], slot % 4);
        let region = grid(node).region([0, 1, 2].map(|axis| [planes(node.low, axis), planes(node.high, axis)]));
        *child = link(node, slot).map_err(|()| slot)?.map(|link| Told { region, link });
    }
    Ok(children)
}

/// What a slot holds, if that makes sense.
fn link(node: &Node, slot: usize) -> Result<Option<Link>, ()> {
    let what = byte(node.slots[slot / 4], slot % 4);
    let nodes = node.exponents >> 24;
    let is_node = nodes >> slot & 1 == 1;
    if is_node {
        let before = (nodes & ((1 << slot) - 1)).count_ones();
        return (what == Slot::node(slot as u8))
            .then_some(Some(Link::Node(node.nodes.saturating_add(before))))
            .ok_or(());
    }
    let (count, first) = ((what >> 5).count_ones() as u8, what & 31);
    let leaf = || (1..=MAX_LEAF as u8).contains(&count) && first + count <= 24 && what == Slot::leaf(first, count);
    match what {
        Slot::EMPTY => Ok(None),
        _ if leaf() => Ok(Some(Link::Leaf(node.triangles.saturating_add(u32::from(first)), u32::from(count)))),
        _ => Err(()),
    }
}
