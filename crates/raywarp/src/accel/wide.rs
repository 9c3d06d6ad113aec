//! What all trees with many children a node share: proof and statistics.

use std::collections::HashMap;

use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::bvh2::is_point;
use super::collapse::Link;
use super::{Invalid, TreeStats};

/// A box in double precision, where planes on a grid are what they stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Region {
    pub const EVERYWHERE: Self = Self { low: [f64::NEG_INFINITY; 3], high: [f64::INFINITY; 3] };
    pub const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    pub fn of(bounds: &Bounds) -> Self {
        Self { low: bounds.low.map(f64::from), high: bounds.high.map(f64::from) }
    }

    /// In single precision: the next larger box, but within what is finite.
    pub fn bounds(&self) -> Bounds {
        let low = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
        Bounds { low: self.low.map(|x| low(x).max(-f32::MAX)), high: self.high.map(|x| (-low(-x)).min(f32::MAX)) }
    }

    pub fn contains(&self, bounds: &Bounds) -> bool {
        let other = Self::of(bounds);
        (0..3).all(|i| self.low[i] <= other.low[i] && other.high[i] <= self.high[i])
    }

    fn meet(&self, other: &Self) -> Self {
        Self {
            low: [0, 1, 2].map(|i| self.low[i].max(other.low[i])),
            high: [0, 1, 2].map(|i| self.high[i].min(other.high[i])),
        }
    }

    fn join(&self, other: &Self) -> Self {
        Self {
            low: [0, 1, 2].map(|i| self.low[i].min(other.low[i])),
            high: [0, 1, 2].map(|i| self.high[i].max(other.high[i])),
        }
    }

    fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|i| (self.high[i] - self.low[i]).max(0.0));
        x * y + y * z + z * x
    }

    /// Surface in units of that of `whole`; 1 where neither has any.
    fn area_within(&self, whole: &Self) -> f64 {
        let whole = whole.half_area();
        if whole > 0.0 {
            self.half_area() / whole
        } else {
            1.0
        }
    }
}

/// A child as a layout tells it.
#[derive(Clone, Copy, Debug)]
pub struct Told {
    pub region: Region,
    pub link: Link,
}

/// A tree with at most eight children a node.
pub trait Layout {
    /// Levels that traversal's stack holds.
    const LEVELS: usize;

    fn nodes(&self) -> usize;

    /// The children of a node in range, or why they make no sense. Their links are not checked yet.
    fn children(&self, node: u32) -> Result<[Option<Told>; 8], Invalid>;

    /// Places for triangles.
    fn places(&self) -> usize;

    /// The triangle at a place in range; none where the place only fills up a block.
    fn triangle(&self, place: usize) -> Option<Triangle>;

    /// Memory that traversal reads.
    fn bytes(&self) -> usize;
}

/// See [`Accel::stats`](super::Accel::stats).
pub fn stats(tree: &impl Layout, build_seconds: f64) -> TreeStats {
    let mut stats = TreeStats { nodes: tree.nodes(), bytes: tree.bytes(), build_seconds, ..TreeStats::default() };
    let children = |node: u32| tree.children(node).into_iter().flatten().flatten();
    let root = children(0).fold(Region::EMPTY, |all, child| all.join(&child.region));
    let mut open = vec![(0, 0, 1.0)];
    while let Some((node, above, area)) = open.pop() {
        stats.inner(above, area);
        for child in children(node) {
            let area = child.region.area_within(&root);
            match child.link {
                Link::Node(node) => open.push((node, above + 1, area)),
                Link::Leaf(_, count) => stats.leaf(count as usize, area),
            }
        }
    }
    stats
}

/// See [`Accel::validate`](super::Accel::validate). Of a triangle that is in several leaves this proves only that their
/// boxes together reach as far as it does.
pub fn validate<L: Layout>(tree: &L) -> Result<(), Invalid> {
    if tree.nodes() == 0 {
        return Err(Invalid::NoRoot);
    }
    let mut walk = Walk {
        tree,
        reached: vec![false; tree.nodes()],
        leaves: vec![0; tree.places()],
        whole: vec![true; tree.places()],
        parts: HashMap::new(),
    };
    walk.node(0, 0, &Region::EVERYWHERE)?;
    walk.everything_reached()
}

/// A triangle that sticks out of its leaves.
struct Parts {
    triangle: Triangle,
    /// The boxes of the leaves together.
    all: Region,
    /// One that has such a leaf.
    node: u32,
}

impl Parts {
    /// Whether the leaves together reach as far as the triangle. The margin is that of its parts: where space was split,
    /// each has its own, and together they may leave less than the whole would. The binary tree's validation, which wide
    /// trees are made after, is exact there.
    fn reach_all(&self) -> bool {
        self.all.contains(&Bounds::of_corners(&self.triangle))
    }
}

/// What has been seen of a tree on the way down.
struct Walk<'a, L> {
    tree: &'a L,
    reached: Vec<bool>,
    leaves: Vec<u32>,
    /// Whether the leaf has all of the triangle.
    whole: Vec<bool>,
    /// Triangles that stick out of a leaf, by their bits.
    parts: HashMap<[u32; 11], Parts>,
}

impl<L: Layout> Walk<'_, L> {
    /// Checks a node with `above` others on the way to it, which a ray reaches within `way`.
    fn node(&mut self, index: u32, above: usize, way: &Region) -> Result<(), Invalid> {
        if above >= L::LEVELS {
            return Err(Invalid::TooDeep { node: index, limit: L::LEVELS });
        }
        if std::mem::replace(&mut self.reached[index as usize], true) {
            return Err(Invalid::Reached { node: index });
        }
        for child in self.tree.children(index)?.into_iter().flatten() {
            let way = way.meet(&child.region);
            in_range(self.tree, index, child.link)?;
            match child.link {
                Link::Node(below) => self.node(below, above + 1, &way)?,
                Link::Leaf(first, count) => {
                    (first..first + count).for_each(|place| self.triangle(place as usize, index, &way))
                }
            }
        }
        Ok(())
    }

    fn triangle(&mut self, place: usize, node: u32, way: &Region) {
        self.leaves[place] += 1;
        let Some(triangle) = self.tree.triangle(place) else { return };
        if !way.contains(&Bounds::of(&triangle)) {
            self.whole[place] = false;
            let none = || Parts { triangle, all: Region::EMPTY, node };
            let parts = self.parts.entry(bits(&triangle)).or_insert_with(none);
            parts.all = parts.all.join(way);
        }
    }

    /// A triangle that some leaf has all of may stick out of others: it was split where that gained nothing.
    fn forget_whole(&mut self) {
        for place in (0..self.leaves.len()).filter(|&place| self.whole[place] && self.leaves[place] > 0) {
            if self.parts.is_empty() {
                return;
            }
            self.tree.triangle(place).and_then(|triangle| self.parts.remove(&bits(&triangle)));
        }
    }

    fn everything_reached(mut self) -> Result<(), Invalid> {
        let count = self.reached.len();
        let reached = self.reached.iter().filter(|&&reached| reached).count();
        if reached != count {
            return Err(Invalid::Unreached { reached, count });
        }
        self.forget_whole();
        if let Some(parts) = self.parts.values().find(|parts| !parts.reach_all()) {
            return Err(Invalid::Outside { node: parts.node });
        }
        let expected = |place: usize| u32::from(self.tree.triangle(place).is_some());
        let of_empty_scene = |place: usize| self.tree.triangle(place).is_some_and(|triangle| is_point(&triangle));
        let leaves = || self.leaves.iter().copied().enumerate();
        match leaves().find(|&(place, n)| n != expected(place) && !(n == 0 && of_empty_scene(place))) {
            Some((place, leaves)) => Err(Invalid::Leaves { triangle: place as u32, leaves, expected: "1" }),
            None => Ok(()),
        }
    }
}

/// Whether a link of a node leads to something.
pub fn in_range(tree: &impl Layout, node: u32, link: Link) -> Result<(), Invalid> {
    let (what, index, count) = match link {
        Link::Node(index) => ("node", u64::from(index), tree.nodes()),
        Link::Leaf(first, count) => ("triangle", u64::from(first) + u64::from(count) - 1, tree.places()),
    };
    if index >= count as u64 {
        return Err(Invalid::OutOfRange { node, what, index, count });
    }
    Ok(())
}

fn bits(triangle: &Triangle) -> [u32; 11] {
    let corners = [triangle.v0, triangle.v1, triangle.v2].map(|v| v.to_array().map(f32::to_bits));
    let mut bits = [triangle.primitive; 11];
    bits[1] = triangle.instance;
    bits[2..].copy_from_slice(corners.as_flattened());
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh2::Bvh2;
    use crate::accel::bvh8f::Bvh8f;
    use crate::accel::{bvh2_build, Quality};
    use raywarp_core::math::vec3;
    use raywarp_core::traversal::bvh2::{Child, Node, MAX_DEPTH};

    fn at(x: f32, size: f32, primitive: u32) -> Triangle {
        let corner = |y, z| vec3(x, y * size, z * size);
        Triangle::new(corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), primitive, 0)
    }

    fn row(count: u32) -> Vec<Triangle> {
        (0..count).map(|i| at(i as f32, 1.0, i)).collect()
    }

    /// A tree that takes off a triangle a level.
    fn chain(triangles: Vec<Triangle>) -> Bvh2 {
        let last = triangles.len() as u32 - 2;
        let around = |from: u32, to: u32| {
            let boxes = triangles[from as usize..=to as usize].iter().map(Bounds::of);
            boxes.fold(Bounds::EMPTY, |all, bounds| all.join(&bounds)).corners()
        };
        let node = |i: u32| {
            let rest = if i < last { Child::node(i + 1) } else { Child::leaf(i + 1, 1) };
            let ([low, high], [low_rest, high_rest]) = (around(i, i), around(i + 1, last + 1));
            let children = [Child::leaf(i, 1), rest];
            Node { low: [low, low_rest], high: [high, high_rest], children, unused: [0; 2] }
        };
        let nodes = (0..=last).map(node).collect();
        Bvh2::from_parts(nodes, triangles).unwrap()
    }

    fn made(binary: &Bvh2) -> Bvh8f {
        Bvh8f::from_bvh2(binary).unwrap()
    }

    #[test]
    fn every_small_count_is_a_valid_tree() {
        for count in 0..70 {
            let tree = made(&bvh2_build::build(row(count), Quality::Fast).unwrap());
            assert_eq!(tree.validate(), Ok(()), "{count}");
            assert_eq!(tree.stats().references, count as usize);
        }
    }

    #[test]
    fn the_deepest_trees_fit_the_stacks() {
        // Boxes of octaves: the heuristic opens the largest child, and that is the next of the chain, or the other one.
        let sizes: [fn(f32) -> f32; 3] = [|_| 1.0, |i| (-i).exp2(), |i| i.exp2()];
        for size in sizes {
            let count = MAX_DEPTH as u32 + 1;
            let binary = chain((0..count).map(|i| at(i as f32, size(i as f32), i)).collect());
            assert_eq!(made(&binary).validate(), Ok(()));
        }
    }

    #[test]
    fn a_triangle_may_be_in_several_leaves() {
        // One long triangle, cut in the middle into two boxes.
        let long = Triangle::new(vec3(0.0, 0.0, 0.0), vec3(8.0, 0.0, 0.0), vec3(0.0, 1.0, 1.0), 0, 0);
        let [low, high] = Bounds::of(&long).corners();
        let children = [Child::leaf(0, 1), Child::leaf(1, 1)];
        let cut = |at: [f32; 2]| Bvh2 {
            nodes: vec![Node {
                low: [low, vec3(at[1], low.y, low.z)],
                high: [vec3(at[0], high.y, high.z), high],
                children,
                unused: [0; 2],
            }],
            triangles: vec![long; 2],
            build_seconds: 0.0,
        };
        let tree = made(&cut([4.0, 4.0]));
        assert_eq!(tree.validate(), Ok(()));
        assert_eq!(tree.triangles().len(), 2);
        // A part of it is in neither box.
        let outside = cut([1.0, 2.0]);
        let outside = Bvh2 { nodes: vec![Node { high: [outside.nodes[0].high[0]; 2], ..outside.nodes[0] }], ..outside };
        assert_eq!(made(&outside).validate(), Err(Invalid::Outside { node: 0 }));
    }

    #[test]
    fn flaws_are_found() {
        let whole = made(&bvh2_build::build(row(200), Quality::Fast).unwrap());
        let broken = |change: fn(&mut Bvh8f)| {
            let mut tree = whole.clone();
            change(&mut tree);
            tree.validate().unwrap_err()
        };
        assert!(matches!(broken(|tree| tree.nodes.push(tree.nodes[0])), Invalid::Unreached { .. }));
        assert_eq!(broken(|tree| tree.nodes.clear()), Invalid::NoRoot);
        let cut_short = broken(|tree| tree.nodes.truncate(1));
        assert!(matches!(cut_short, Invalid::OutOfRange { what: "node", .. }), "{cut_short:?}");
        assert_eq!(broken(|tree| tree.nodes[0].children[0] = Child::node(0)), Invalid::Reached { node: 0 });
        let blocks = broken(|tree| tree.blocks.truncate(2));
        assert!(matches!(blocks, Invalid::OutOfRange { what: "triangle", .. }), "{blocks:?}");
    }
}
