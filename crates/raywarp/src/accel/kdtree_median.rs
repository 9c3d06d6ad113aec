//! Builds the k-d tree of the paper: axes in turn, planes at the median.
//!
//! A cell at depth d is cut on axis d mod 3 at the median of its triangles' centres; where that separates nothing, on
//! the next axis that does. Triangles whose bounds touch the plane, from either side or through it, go to both
//! children. It is the simplest k-d tree, kept for comparison with the paper: a better one would weigh areas
//! (Wald and Havran 2006).

use std::time::Instant;

use rayon::prelude::*;
use raywarp_kernels::traverse::kdtree::{Node, MAX_DEPTH, MAX_LINK};
use raywarp_kernels::triangle::Triangle;

use super::bounds::Bounds;
use super::kdtree::KdTree;
use super::BuildError;

/// References that a leaf may have without being split further.
const LEAF: usize = 8;

/// References of all leaves together are at most this many times the triangles. A cell that must not add as many as
/// its split would becomes a leaf instead.
const COPIES: usize = 16;

/// Cells with more triangles are built by two threads.
const PARALLEL: usize = 4096;

/// Most triangles: their copies must have an index each.
const MAX_TRIANGLES: u32 = MAX_LINK / COPIES as u32;

/// Builds the tree. The result depends on the triangles and their order alone, not on the number of threads.
///
/// # Errors
/// More triangles than [`MAX_LINK`] references allow.
pub fn build(triangles: Vec<Triangle>) -> Result<KdTree, BuildError> {
    let start = Instant::now();
    BuildError::check(triangles.len(), MAX_TRIANGLES)?;
    let bounds: Vec<Bounds> = triangles.par_iter().map(Bounds::of).collect();
    let everything = (0..triangles.len() as u32).collect();
    let builder = Builder { bounds: &bounds, deepest: deepest(triangles.len()) };
    let mut tree = Arrays::with_root();
    builder.grow(everything, COPIES * triangles.len(), 0, 0, &mut tree);
    let [low, high] = bounds.iter().copied().reduce(|a, b| a.join(&b)).unwrap_or(Bounds::POINT).corners();
    let build_seconds = start.elapsed().as_secs_f64();
    Ok(KdTree { nodes: tree.nodes, references: tree.references, triangles, low, high, build_seconds })
}

/// Levels of inner nodes: 8 + 1.3 log2 n (Havran 2000, page 65), within what traversal's stack holds.
fn deepest(triangles: usize) -> usize {
    let levels = 8.0 + 1.3 * (triangles.max(1) as f64).log2();
    (levels as usize).min(MAX_DEPTH)
}

/// A tree or a part of one, whose links count from its own start.
#[derive(Debug)]
struct Arrays {
    nodes: Vec<Node>,
    references: Vec<u32>,
}

impl Arrays {
    fn with_root() -> Self {
        Self { nodes: vec![Node::leaf(0, 0)], references: Vec::new() }
    }

    /// Moves another tree in here: its root to `slot`, the rest to the end.
    fn adopt(&mut self, slot: usize, other: Self) {
        let (nodes, references) = (self.nodes.len() as u32, self.references.len() as u32);
        let moved = |node: Node| match node.is_leaf() {
            true => Node::leaf(node.first() + references, node.count()),
            // The root stayed behind, so everything else is one place nearer.
            false => Node::inner(node.axis(), node.plane(), node.below() + nodes - 1),
        };
        let mut others = other.nodes.into_iter().map(moved);
        if let Some(root) = others.next() {
            self.nodes[slot] = root;
        }
        self.nodes.extend(others);
        self.references.extend(other.references);
    }
}

struct Builder<'a> {
    bounds: &'a [Bounds],
    deepest: usize,
}

impl Builder<'_> {
    /// Makes the node at `slot` that of the cell which `inside` touch, and adds what is below it. The leaves there
    /// hold at most `budget` references.
    fn grow(&self, inside: Vec<u32>, budget: usize, depth: usize, slot: usize, tree: &mut Arrays) {
        let count = inside.len();
        let cut = (count > LEAF && depth < self.deepest).then(|| self.cut(&inside, budget, depth)).flatten();
        let Some(Cut { axis, plane, below, above }) = cut else {
            tree.nodes[slot] = Node::leaf(tree.references.len() as u32, count as u32);
            tree.references.extend(inside);
            return;
        };
        drop(inside);
        let children = tree.nodes.len();
        tree.nodes.extend([Node::leaf(0, 0); 2]);
        tree.nodes[slot] = Node::inner(axis as u32, plane, children as u32);
        // By the share of each; both get at least what they already have, since the sum did not exceed the budget.
        let left = budget * below.len() / (below.len() + above.len());
        let right = budget - left;
        if count > PARALLEL {
            let mut apart = Arrays::with_root();
            rayon::join(
                || self.grow(below, left, depth + 1, children, tree),
                || self.grow(above, right, depth + 1, 0, &mut apart),
            );
            tree.adopt(children + 1, apart);
        } else {
            self.grow(below, left, depth + 1, children, tree);
            self.grow(above, right, depth + 1, children + 1, tree);
        }
    }

    /// The first axis in turn on which a cut helps: not both children are as large as the cell.
    fn cut(&self, inside: &[u32], budget: usize, depth: usize) -> Option<Cut> {
        (depth..depth + 3).map(|turn| self.cut_on(turn % 3, inside)).find(|cut| {
            let (below, above) = (cut.below.len(), cut.above.len());
            (below < inside.len() || above < inside.len()) && below + above <= budget
        })
    }

    fn cut_on(&self, axis: usize, inside: &[u32]) -> Cut {
        let plane = self.median(axis, inside);
        let touching = |side: fn(&Bounds, usize, f32) -> bool| -> Vec<u32> {
            inside.iter().copied().filter(|&i| side(&self.bounds[i as usize], axis, plane)).collect()
        };
        let below = touching(|bounds, axis, plane| bounds.low[axis] <= plane);
        let above = touching(|bounds, axis, plane| bounds.high[axis] >= plane);
        Cut { axis, plane, below, above }
    }

    /// The middle one of the centres.
    fn median(&self, axis: usize, inside: &[u32]) -> f32 {
        let mut centres: Vec<f32> = inside.iter().map(|&i| self.bounds[i as usize].centre()[axis]).collect();
        let middle = centres.len() / 2;
        *centres.select_nth_unstable_by(middle, f32::total_cmp).1
    }
}

/// A plane, and the triangles that touch the cells on both sides.
struct Cut {
    axis: usize,
    plane: f32,
    below: Vec<u32>,
    above: Vec<u32>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Invalid;
    use raywarp_kernels::math::vec3;

    fn at(x: f32, size: f32, primitive: u32) -> Triangle {
        let corner = |y, z| vec3(x, y * size, z * size);
        Triangle::new(corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), primitive, 0)
    }

    #[test]
    fn every_small_count_is_a_valid_tree() {
        for count in 0..100 {
            let tree = build((0..count).map(|i| at(i as f32, 1.0, i)).collect()).unwrap();
            assert_eq!(tree.validate(), Ok(()), "{count}");
        }
    }

    /// Flat cells are cut on the axis that helps, identical triangles on none.
    #[test]
    fn a_cut_that_separates_nothing_is_not_made() {
        let floor = build((0..1000).map(|i| at(i as f32, 1.0, i)).collect()).unwrap().stats();
        assert!(floor.largest_leaf <= LEAF, "{floor:?}");
        let same = build(vec![at(0.0, 1.0, 0); 1000]).unwrap().stats();
        assert_eq!((same.nodes, same.largest_leaf), (1, 1000));
    }

    /// Concentric triangles are all cut by nearly every plane.
    #[test]
    fn copies_keep_to_the_budget() {
        let triangles: Vec<_> = (1..3000).map(|i| at(i as f32 * 1e-3, i as f32, i)).collect();
        let tree = build(triangles.clone()).unwrap();
        assert_eq!(tree.validate(), Ok(()));
        assert!(tree.references.len() <= COPIES * triangles.len());
    }

    #[test]
    fn threads_do_not_change_the_tree() {
        let triangles: Vec<_> =
            (0..20_000).map(|i| at((i as f32 * 0.618).fract(), (i as f32 * 0.1).fract(), i)).collect();
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| build(triangles.clone()).unwrap())
        };
        let (one, four) = (with(1), with(4));
        assert!(one.nodes == four.nodes && one.references == four.references);
    }

    #[test]
    fn flaws_are_found() {
        let tree = build((0..100).map(|i| at(i as f32, 1.0, i)).collect()).unwrap();
        let broken = |change: fn(&mut KdTree)| {
            let mut tree = tree.clone();
            change(&mut tree);
            tree.validate().unwrap_err()
        };
        assert_eq!(broken(|tree| tree.nodes.clear()), Invalid::NoRoot);
        assert_eq!(broken(|tree| tree.nodes[0] = Node::inner(0, 50.0, 0)), Invalid::Reached { node: 0 });
        assert!(matches!(broken(|tree| tree.nodes[0] = Node::inner(0, 0.0, 9999)), Invalid::OutOfRange { .. }));
        assert!(matches!(broken(|tree| tree.references.truncate(5)), Invalid::OutOfRange { .. }));
        assert!(matches!(broken(|tree| tree.references[0] = 100), Invalid::OutOfRange { what: "triangle", .. }));
        assert!(matches!(broken(|tree| tree.references[0] = tree.references[1]), Invalid::NotReferred { .. }));
        assert!(matches!(broken(|tree| tree.nodes.push(tree.nodes[0])), Invalid::Unreached { .. }));
        assert_eq!(broken(|tree| tree.high.x = 98.0), Invalid::Outside { node: 0 });
    }
}
