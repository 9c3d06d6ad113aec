//! A k-d tree in a flat array, owned by the host.

use std::time::Instant;

use raywarp_core::math::Vec3;
use raywarp_core::traversal;
use raywarp_core::traversal::kdtree::{Node, MAX_DEPTH};
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::cover::Space;
use super::kdtree_arrays::Arrays;
use super::triangles::is_finite;
use super::view::{lend, Borrowed};
use super::{Invalid, TreeStats};

/// The tree. Parents come before their children. An empty scene is one empty leaf, in a box that is a point.
#[derive(Clone, Debug)]
pub struct KdTree {
    pub(crate) nodes: Vec<Node>,
    pub(crate) references: Vec<u32>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
    pub(crate) build_seconds: f64,
}

impl KdTree {
    /// A tree made elsewhere, if it is valid.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn from_parts(
        nodes: Vec<Node>,
        references: Vec<u32>,
        triangles: Vec<Triangle>,
        bounds: [Vec3; 2],
    ) -> Result<Self, Invalid> {
        let [low, high] = bounds;
        let tree = Self { nodes, references, triangles, low, high, build_seconds: 0.0 };
        tree.validate().map(|()| tree)
    }

    /// What a builder made, as it is.
    #[doc(hidden)]
    pub fn grown(tree: Arrays, triangles: Vec<Triangle>, [low, high]: [Vec3; 2], start: Instant) -> Self {
        let build_seconds = start.elapsed().as_secs_f64();
        Self { nodes: tree.nodes, references: tree.references, triangles, low, high, build_seconds }
    }

    /// Inner nodes and leaves; 0 is the root.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Indices of triangles, a run a leaf.
    pub fn references(&self) -> &[u32] {
        &self.references
    }

    /// In the order given.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// Low and high corner of everything.
    pub fn bounds(&self) -> [Vec3; 2] {
        [self.low, self.high]
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traversal::KdTree> {
        Borrowed::new(traversal::KdTree {
            nodes: lend(&self.nodes),
            references: lend(&self.references),
            triangles: lend(&self.triangles),
            low: self.low,
            high: self.high,
        })
    }

    fn root_cell(&self) -> Bounds {
        Bounds { low: self.low.to_array(), high: self.high.to_array() }
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        let mut stats = TreeStats {
            nodes: self.nodes.len(),
            bytes: size_of_val(&self.nodes[..]) + size_of_val(&self.references[..]) + size_of_val(&self.triangles[..]),
            build_seconds: self.build_seconds,
            ..TreeStats::default()
        };
        let mut open = vec![(0, 0, self.root_cell())];
        while let Some((index, above, cell)) = open.pop() {
            let Some(node) = self.nodes.get(index as usize) else { continue };
            let area = cell.area_within(&self.root_cell());
            if node.is_leaf() {
                stats.leaf(node.count() as usize, area);
            } else {
                stats.inner(above, area);
                let [below, beyond] = cut(&cell, *node);
                open.push((node.below() + 1, above + 1, beyond));
                open.push((node.below(), above + 1, below));
            }
        }
        stats.duplicates = stats.references.saturating_sub(self.triangles.len());
        stats
    }

    /// See [`Accel::validate`](super::Accel::validate). A triangle must be in every leaf where a ray may be found to hit it:
    /// all whose cell it comes close to. It need not be where only its box is.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        if self.nodes.is_empty() {
            return Err(Invalid::NoRoot);
        }
        let bounds: Vec<_> = self.triangles.iter().map(Bounds::of).collect();
        // The others are never hit, wherever they are.
        let hittable = |&i: &u32| is_finite(&self.triangles[i as usize]);
        let everything: Vec<u32> = (0..bounds.len() as u32).filter(hittable).collect();
        if !everything.iter().all(|&i| self.root_cell().contains(&bounds[i as usize])) {
            return Err(Invalid::Outside { node: 0 });
        }
        let mut walk = Walk { tree: self, bounds, reached: vec![false; self.nodes.len()] };
        walk.node(Place { node: 0, above: 0, cell: self.root_cell() }, &everything)?;
        walk.everything_reached()
    }
}

/// The cells below and above an inner node's plane.
pub(super) fn cut(cell: &Bounds, node: Node) -> [Bounds; 2] {
    let (mut below, mut above) = (*cell, *cell);
    below.high[node.axis() as usize] = node.plane();
    above.low[node.axis() as usize] = node.plane();
    [below, above]
}

/// What has been seen of a tree on the way down.
struct Walk<'a> {
    tree: &'a KdTree,
    bounds: Vec<Bounds>,
    reached: Vec<bool>,
}

/// A node with `above` others on the way to it.
#[derive(Clone, Copy)]
struct Place {
    node: u32,
    above: usize,
    cell: Bounds,
}

impl Walk<'_> {
    /// Checks a node and what is below it, where the triangles `inside` are close to its cell.
    fn node(&mut self, place: Place, inside: &[u32]) -> Result<(), Invalid> {
        let Place { node: index, above, cell } = place;
        if std::mem::replace(&mut self.reached[index as usize], true) {
            return Err(Invalid::Reached { node: index });
        }
        let node = self.tree.nodes[index as usize];
        if node.is_leaf() {
            return self.leaf(index, node, inside);
        }
        if above >= MAX_DEPTH {
            return Err(Invalid::TooDeep { node: index, limit: MAX_DEPTH });
        }
        let (count, last) = (self.tree.nodes.len(), node.below() + 1);
        if last as usize >= count {
            return Err(Invalid::OutOfRange { node: index, what: "node", index: last.into(), count });
        }
        if node.plane().is_nan() {
            return Err(Invalid::NoPlane { node: index });
        }
        let cells = cut(&cell, node);
        for (side, cell) in cells.into_iter().enumerate() {
            let there: Vec<u32> = inside.iter().copied().filter(|&i| self.comes_near(i, node, side, &cells)).collect();
            self.node(Place { node: node.below() + side as u32, above: above + 1, cell }, &there)?;
        }
        Ok(())
    }

    /// Whether a triangle that is close to a node's cell may be hit in the part on one side of the node's plane.
    fn comes_near(&self, triangle: u32, node: Node, side: usize, cells: &[Bounds; 2]) -> bool {
        let (bounds, axis) = (&self.bounds[triangle as usize], node.axis() as usize);
        let sides = [bounds.low[axis] <= node.plane(), bounds.high[axis] >= node.plane()];
        let triangle = &self.tree.triangles[triangle as usize];
        // The box alone tells where there is but one side. So does a plane beside the cell, which leaves one of no size.
        match sides {
            [true, true] => Space::around(&cells[side], triangle.extent()).meets(triangle),
            sides => sides[side],
        }
    }

    fn leaf(&self, index: u32, node: Node, inside: &[u32]) -> Result<(), Invalid> {
        let (end, count) = (u64::from(node.first()) + u64::from(node.count()), self.tree.references.len());
        if end > count as u64 {
            return Err(Invalid::OutOfRange { node: index, what: "reference", index: end, count });
        }
        let mut held = self.tree.references[node.first() as usize..end as usize].to_vec();
        held.sort_unstable();
        let count = self.tree.triangles.len();
        if let Some(&last) = held.last().filter(|&&last| last as usize >= count) {
            return Err(Invalid::OutOfRange { node: index, what: "triangle", index: last.into(), count });
        }
        match inside.iter().find(|triangle| held.binary_search(triangle).is_err()) {
            Some(&triangle) => Err(Invalid::NotReferred { node: index, triangle }),
            None => Ok(()),
        }
    }

    fn everything_reached(&self) -> Result<(), Invalid> {
        let count = self.reached.len();
        let reached = self.reached.iter().filter(|&&reached| reached).count();
        if reached != count {
            return Err(Invalid::Unreached { reached, count });
        }
        Ok(())
    }
}
