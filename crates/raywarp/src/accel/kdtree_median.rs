//! Builds the k-d tree of the paper: axes in turn, planes at the median.
//!
//! A cell at depth d is cut on axis d mod 3 at the median of its triangles' centres; where that separates nothing, on
//! the next axis that does. Triangles whose bounds touch the plane, from either side or through it, go to both
//! children. It is the simplest k-d tree, kept for comparison with the paper: one by the surface area heuristic (in `lab`) is a
//! better one.

use std::time::Instant;

use rayon::prelude::*;
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::kdtree::KdTree;
use super::kdtree_arrays::{deepest, grow, Arrays, Cut, Cutter, COPIES, MAX_TRIANGLES};
use super::BuildError;

/// References that a leaf may have without being split further.
const LEAF: usize = 8;

/// Builds the tree. The result depends on the triangles and their order alone, not on the number of threads.
///
/// # Errors
/// More triangles than links to their copies can tell apart.
pub fn build(triangles: Vec<Triangle>) -> Result<KdTree, BuildError> {
    let start = Instant::now();
    BuildError::check(triangles.len(), MAX_TRIANGLES)?;
    let bounds: Vec<Bounds> = triangles.par_iter().map(Bounds::of).collect();
    let everything = (0..triangles.len() as u32).collect();
    let builder = Builder { bounds: &bounds, deepest: deepest(triangles.len()) };
    let mut tree = Arrays::with_root();
    grow(&builder, everything, COPIES * triangles.len(), 0, 0, &mut tree);
    let corners = bounds.iter().copied().reduce(|a, b| a.join(&b)).unwrap_or(Bounds::POINT).corners();
    Ok(KdTree::grown(tree, triangles, corners, start))
}

struct Builder<'a> {
    bounds: &'a [Bounds],
    deepest: usize,
}

impl Cutter for Builder<'_> {
    type Cell = Vec<u32>;

    const PARALLEL: usize = 4096;

    fn triangles(inside: &Vec<u32>) -> impl ExactSizeIterator<Item = u32> {
        inside.iter().copied()
    }

    fn cut(&self, inside: Vec<u32>, budget: usize, depth: usize) -> Result<Cut<Vec<u32>>, Vec<u32>> {
        let cut =
            (inside.len() > LEAF && depth < self.deepest).then(|| self.first_cut(&inside, budget, depth)).flatten();
        cut.ok_or(inside)
    }
}

impl Builder<'_> {
    /// The first axis in turn on which a cut helps: not both children are as large as the cell.
    fn first_cut(&self, inside: &[u32], budget: usize, depth: usize) -> Option<Cut<Vec<u32>>> {
        (depth..depth + 3).map(|turn| self.cut_on(turn % 3, inside)).find(|cut| {
            let (below, above) = (cut.below.len(), cut.above.len());
            (below < inside.len() || above < inside.len()) && below + above <= budget
        })
    }

    fn cut_on(&self, axis: usize, inside: &[u32]) -> Cut<Vec<u32>> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Invalid;
    use raywarp_core::math::vec3;
    use raywarp_core::traversal::kdtree::Node;

    fn at(x: f32, size: f32, primitive: u32) -> Triangle {
        let corner = |y, z| vec3(x, y * size, z * size);
        Triangle::new(corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), primitive, 0)
    }

    /// Twenty triangles in a plane, in columns 0 to 4 and rows 0 to 3, as wide as the gaps between them.
    fn grid() -> Vec<Triangle> {
        let triangle = |i: u32| {
            let (x, y) = ((i % 5) as f32 * 2.0, (i / 5) as f32 * 2.0);
            Triangle::new(vec3(x, y, 0.0), vec3(x + 1.0, y, 0.0), vec3(x, y + 1.0, 0.0), i, 0)
        };
        (0..20).map(triangle).collect()
    }

    /// The paper's rules, by hand.
    #[test]
    fn nodes_of_a_grid_are_those_made_by_hand() {
        let tree = build(grid()).unwrap();
        let nodes = [
            // The eleventh of twenty centres along x is in column 2, which is on both sides then.
            Node::inner(0, 4.5, 1),
            // Columns 0 to 2: the seventh of twelve centres along y is in row 2.
            Node::inner(1, 4.5, 3),
            // Columns 2 to 4 likewise.
            Node::inner(1, 4.5, 7),
            // Rows 0 to 2 of columns 0 to 2: along z they are all the same, so x has its turn. The fifth of nine centres is
            // in column 1.
            Node::inner(0, 2.5, 5),
            Node::leaf(12, 6),
            Node::leaf(0, 6),
            Node::leaf(6, 6),
            // Rows 0 to 2 of columns 2 to 4.
            Node::inner(0, 6.5, 9),
            Node::leaf(30, 6),
            Node::leaf(18, 6),
            Node::leaf(24, 6),
        ];
        assert_eq!(tree.nodes, nodes);
        let leaves = [
            [0, 1, 5, 6, 10, 11],
            [1, 2, 6, 7, 11, 12],
            [10, 11, 12, 15, 16, 17],
            [2, 3, 7, 8, 12, 13],
            [3, 4, 8, 9, 13, 14],
            [12, 13, 14, 17, 18, 19],
        ];
        assert_eq!(tree.references, leaves.concat());
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
