//! A binary hierarchy of boxes, owned by the host.

use rayon::prelude::*;
use raywarp_core::math::Vec3;
use raywarp_core::traversal;
use raywarp_core::traversal::bvh2::{Child, Node, MAX_DEPTH};
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::cover::Parts;
use super::view::{lend, Borrowed};
use super::{Invalid, TreeStats};

/// The tree. Parents come before their children. A triangle may be in several leaves.
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

    /// In the order of the leaves, by value: one that spatial splits put in several leaves is here as often. Count
    /// distinct primitives, or those that the tree was built from.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traversal::Bvh2> {
        Borrowed::new(traversal::Bvh2 {
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

    /// Seconds that the build took.
    pub fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    /// See [`traversal::Bvh2::reach`].
    pub fn reach(&self) -> Vec3 {
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
        stats.add_nodes(&self.nodes, 0, |stats, leaf, _, area| stats.leaf(leaf.count() as usize, area));
        stats.duplicates = self.duplicates();
        stats
    }

    fn duplicates(&self) -> usize {
        let mut primitives: Vec<(u32, u32)> = self.triangles.par_iter().map(|t| (t.instance, t.primitive)).collect();
        primitives.par_sort_unstable();
        primitives.windows(2).filter(|pair| pair[0] == pair[1]).count()
    }

    /// See [`Accel::validate`](super::Accel::validate). A triangle may be in several leaves, none with a box for all of
    /// it, if their boxes cover it together.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        if self.nodes.is_empty() {
            return Err(Invalid::NoRoot);
        }
        let triangles = self.triangles.len();
        let mut walk = Walk {
            tree: self,
            reached: vec![false; self.nodes.len()],
            leaves: vec![0; triangles],
            whole: vec![false; triangles],
            parts: Parts::default(),
        };
        walk.node(&Way { node: 0, inside: EVERYWHERE, before: None }, 0)?;
        walk.everything_covered()?;
        walk.everything_reached()
    }
}

impl TreeStats {
    /// Adds the inner nodes below a root, and what `leaf` makes of a leaf with so many of them above it, whose box has an area
    /// in units of the root's.
    pub(super) fn add_nodes(&mut self, nodes: &[Node], root: u32, leaf: impl Fn(&mut Self, Child, usize, f64)) {
        let Some(top) = nodes.get(root as usize) else { return };
        let bounds = children_of(top).fold(Bounds::EMPTY, |all, side| all.join(&child_box(top, side)));
        let mut open = vec![(root, 0, 1.0)];
        while let Some((index, above, area)) = open.pop() {
            let Some(node) = nodes.get(index as usize) else { continue };
            self.inner(above, area);
            for side in children_of(node) {
                let (child, area) = (node.children[side], child_box(node, side).area_within(&bounds));
                if child.is_leaf() {
                    leaf(self, child, above + 1, area);
                } else {
                    open.push((child.index(), above + 1, area));
                }
            }
        }
    }
}

/// The sides on which a node has a child.
pub(super) fn children_of(node: &Node) -> impl Iterator<Item = usize> + '_ {
    (0..2).filter(|&side| node.has_child(side))
}

pub(super) fn child_box(node: &Node, side: usize) -> Bounds {
    Bounds { low: node.low[side].to_array(), high: node.high[side].to_array() }
}

/// Where nothing is cut off.
const EVERYWHERE: Bounds = Bounds { low: [-f32::MAX; 3], high: [f32::MAX; 3] };

/// What has been seen of a tree on the way down.
struct Walk<'a> {
    tree: &'a Bvh2,
    reached: Vec<bool>,
    leaves: Vec<u32>,
    /// Which triangles are in a leaf with room for all of them.
    whole: Vec<bool>,
    /// The others, and their leaves.
    parts: Parts<'a>,
}

/// A way down: the last node, what all boxes on it contain, and the node before.
struct Way<'a> {
    node: u32,
    inside: Bounds,
    before: Option<&'a Way<'a>>,
}

impl Way<'_> {
    /// The first node on the way whose box further down does not contain `whole`.
    fn first_without(&self, whole: &Bounds) -> u32 {
        match self.before {
            Some(before) if !self.inside.contains(whole) => before.first_without(whole),
            _ => self.node,
        }
    }
}

impl Walk<'_> {
    /// Checks the nodes below one with `above` others on the way to it.
    fn node(&mut self, way: &Way, above: usize) -> Result<(), Invalid> {
        let index = way.node;
        if above >= MAX_DEPTH {
            return Err(Invalid::TooDeep { node: index, limit: MAX_DEPTH });
        }
        if std::mem::replace(&mut self.reached[index as usize], true) {
            return Err(Invalid::Reached { node: index });
        }
        let tree = self.tree;
        let node = &tree.nodes[index as usize];
        for side in 0..2 {
            let child = node.children[side];
            self.in_range(index, child)?;
            match (node.has_child(side), child.is_leaf()) {
                (false, true) => continue,
                (false, false) => return Err(Invalid::NoBox { node: index }),
                (true, _) => {}
            }
            let inside = way.inside.meet(&child_box(node, side));
            if child.is_leaf() {
                self.leaf(way, child, inside);
            } else {
                self.node(&Way { node: child.index(), inside, before: Some(way) }, above + 1)?;
            }
        }
        Ok(())
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

    fn leaf(&mut self, way: &Way, child: Child, inside: Bounds) {
        let tree = self.tree;
        for index in child.index()..child.index() + child.count() {
            self.leaves[index as usize] += 1;
            let triangle = &tree.triangles[index as usize];
            let whole = Bounds::of(triangle);
            if !inside.contains(&whole) {
                self.parts.add(triangle, inside, way.first_without(&whole));
            } else {
                self.whole[index as usize] = true;
            }
        }
    }

    /// Whether triangles of which no leaf has room for all are covered by several.
    fn everything_covered(&mut self) -> Result<(), Invalid> {
        if !self.parts.is_empty() {
            for (triangle, _) in self.tree.triangles.iter().zip(&self.whole).filter(|(_, &whole)| whole) {
                self.parts.found_whole(triangle);
            }
        }
        self.parts.uncovered().map_or(Ok(()), |node| Err(Invalid::Outside { node }))
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
