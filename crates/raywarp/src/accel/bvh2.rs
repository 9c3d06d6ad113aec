//! A binary hierarchy of boxes, owned by the host.

use raywarp_kernels::math::Vec3;
use raywarp_kernels::traverse;
use raywarp_kernels::traverse::bvh2::{Child, Node, MAX_DEPTH};
use raywarp_kernels::triangle::Triangle;

use super::bounds::Bounds;
use super::view::{lend, Borrowed};
use super::{Invalid, TreeStats};

/// The tree. Parents come before their children.
///
/// A child that does not exist has an inverted box and, lest a ray of NaN follow it, a link to triangle 0. An empty
/// scene has one triangle without area for that.
#[derive(Clone, Debug)]
pub struct Bvh2 {
    pub(crate) nodes: Vec<Node>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) build_seconds: f64,
}

impl Bvh2 {
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
    pub fn view(&self) -> Borrowed<'_, traverse::Bvh2> {
        Borrowed::new(traverse::Bvh2 {
            nodes: lend(&self.nodes),
            triangles: lend(&self.triangles),
            reach: self.reach(),
        })
    }

    /// Around everything; [`Bounds::EMPTY`] where there is nothing.
    pub(crate) fn bounds(&self) -> Bounds {
        let Some(root) = self.nodes.first() else { return Bounds::EMPTY };
        children_of(root).fold(Bounds::EMPTY, |all, side| all.join(&child_box(root, side)))
    }

    /// See [`traverse::Bvh2::reach`].
    pub(crate) fn reach(&self) -> Vec3 {
        let Bounds { low, high } = self.bounds();
        let [x, y, z] = [0, 1, 2].map(|i| if low[i] <= high[i] { low[i].abs().max(high[i].abs()) } else { 0.0 });
        Vec3::new(x, y, z)
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        let mut stats = TreeStats {
            nodes: self.nodes.len(),
            bytes: size_of_val(&self.nodes[..]) + size_of_val(&self.triangles[..]),
            build_seconds: self.build_seconds,
            ..TreeStats::default()
        };
        let root = self.bounds();
        let mut open = vec![(0, 0, 1.0)];
        while let Some((index, above, area)) = open.pop() {
            let Some(node) = self.nodes.get(index as usize) else { continue };
            stats.inner(above, area);
            for side in children_of(node) {
                let (child, area) = (node.children[side], child_box(node, side).area_within(&root));
                if child.is_leaf() {
                    stats.leaf(child.count() as usize, area);
                } else {
                    open.push((child.index(), above + 1, area));
                }
            }
        }
        stats
    }

    /// See [`Accel::validate`](super::Accel::validate).
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        if self.nodes.is_empty() {
            return Err(Invalid::NoRoot);
        }
        let mut walk =
            Walk { tree: self, reached: vec![false; self.nodes.len()], leaves: vec![0; self.triangles.len()] };
        walk.node(0, 0)?;
        walk.everything_reached()
    }
}

/// The sides on which a node has a child.
pub(super) fn children_of(node: &Node) -> impl Iterator<Item = usize> + '_ {
    (0..2).filter(|&side| has_child(node, side))
}

fn has_child(node: &Node, side: usize) -> bool {
    (0..3).all(|axis| node.low[side][axis] <= node.high[side][axis])
}

pub(super) fn child_box(node: &Node, side: usize) -> Bounds {
    Bounds { low: node.low[side].to_array(), high: node.high[side].to_array() }
}

/// What has been seen of a tree on the way down.
struct Walk<'a> {
    tree: &'a Bvh2,
    reached: Vec<bool>,
    leaves: Vec<u32>,
}

impl Walk<'_> {
    /// Checks a node with `above` others on the way to it, and gives the box of the triangles below it.
    fn node(&mut self, index: u32, above: usize) -> Result<Bounds, Invalid> {
        if above >= MAX_DEPTH {
            return Err(Invalid::TooDeep { node: index, limit: MAX_DEPTH });
        }
        if std::mem::replace(&mut self.reached[index as usize], true) {
            return Err(Invalid::Reached { node: index });
        }
        let node = &self.tree.nodes[index as usize];
        let mut all = Bounds::EMPTY;
        for side in 0..2 {
            let child = node.children[side];
            self.in_range(index, child)?;
            if !has_child(node, side) {
                continue;
            }
            let below = if child.is_leaf() { self.leaf(child) } else { self.node(child.index(), above + 1)? };
            if !child_box(node, side).contains(&below) {
                return Err(Invalid::Outside { node: index });
            }
            all = all.join(&below);
        }
        Ok(all)
    }

    /// Of a child that does not exist too: see [`Bvh2`].
    fn in_range(&self, node: u32, child: Child) -> Result<(), Invalid> {
        let (what, end, count) = if child.is_leaf() {
            ("triangle", u64::from(child.index()) + u64::from(child.count()), self.tree.triangles.len())
        } else {
            ("node", u64::from(child.index()) + 1, self.tree.nodes.len())
        };
        if end > count as u64 {
            return Err(Invalid::OutOfRange { node, what, index: end - 1, count });
        }
        Ok(())
    }

    fn leaf(&mut self, child: Child) -> Bounds {
        let run = child.index() as usize..(child.index() + child.count()) as usize;
        self.leaves[run.clone()].iter_mut().for_each(|leaves| *leaves += 1);
        self.tree.triangles[run].iter().fold(Bounds::EMPTY, |all, triangle| all.join(&Bounds::of(triangle)))
    }

    fn everything_reached(&self) -> Result<(), Invalid> {
        let count = self.reached.len();
        let reached = self.reached.iter().filter(|&&reached| reached).count();
        if reached != count {
            return Err(Invalid::Unreached { reached, count });
        }
        let wrong = self.leaves.iter().zip(&self.tree.triangles).position(|(&n, t)| n != 1 && !(n == 0 && is_point(t)));
        match wrong {
            Some(triangle) => {
                Err(Invalid::Leaves { triangle: triangle as u32, leaves: self.leaves[triangle], expected: "1" })
            }
            None => Ok(()),
        }
    }
}

/// Whether this is the triangle of an empty scene, which belongs to no leaf.
pub(super) fn is_point(triangle: &Triangle) -> bool {
    triangle.v0 == triangle.v1 && triangle.v0 == triangle.v2
}
