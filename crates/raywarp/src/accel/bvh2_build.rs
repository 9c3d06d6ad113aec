//! Builds a [`Bvh2`] of the quality asked for: which steps it takes.

use std::time::Instant;

use raywarp_core::traversal::bvh2::MAX_INDEX;
use raywarp_core::triangle::Triangle;

use super::bvh2::Bvh2;
use super::{bvh2_binned, leaves, reinsertion, topdown};
use super::{BuildError, Quality};

/// How a binary tree becomes better before it becomes a [`Bvh2`].
struct Recipe {
    /// References that spatial splits may add, a triangle.
    copies: f64,
    /// Of all nodes, the share that looks for better places, for each round of reinsertion.
    shares: &'static [f64],
    /// A round that gains less, of the sum of all areas, is the last.
    least: f64,
}

/// Most of the gain is with the large boxes, at a tenth of the price.
const MEDIUM: Recipe = Recipe { copies: 0.0, shares: &[0.1; 6], least: 0.0 };

const HIGH: Recipe = Recipe { copies: 0.5, shares: &[1.0; 12], least: 0.002 };

/// Builds the tree. The result depends on the triangles, their order and the quality alone, not on the number of
/// threads.
///
/// - [`Quality::Fast`] is [`bvh2_binned`].
/// - [`Quality::Medium`] goes on to one triangle a leaf, lets the largest nodes look for better places, and then decides
///   which subtrees become leaves.
/// - [`Quality::High`] also splits space where boxes would overlap, so that some triangles are in several leaves, and
///   lets all nodes look for better places until little is gained.
///
/// # Errors
/// More than [`MAX_INDEX`] triangles, or references where space is split.
pub fn build(triangles: Vec<Triangle>, quality: Quality) -> Result<Bvh2, BuildError> {
    build_ordered(&triangles, quality).map(|(tree, _)| tree)
}

/// Also gives which triangle each of the tree's is, as an index into those given; of an empty scene nothing.
pub(super) fn build_ordered(triangles: &[Triangle], quality: Quality) -> Result<(Bvh2, Vec<u32>), BuildError> {
    let recipe = match quality {
        Quality::Medium => MEDIUM,
        Quality::High => HIGH,
        Quality::Fast => return bvh2_binned::build_ordered(triangles),
    };
    let start = Instant::now();
    if triangles.is_empty() {
        return bvh2_binned::build_ordered(triangles);
    }
    let most = triangles.len() + (triangles.len() as f64 * recipe.copies) as usize;
    BuildError::check(most, MAX_INDEX)?;
    let mut tree = topdown::build(triangles, recipe.copies);
    reinsertion::optimise(&mut tree, recipe.shares, recipe.least);
    let (nodes, order) = leaves::collapse(&tree, triangles.len());
    drop(tree);
    Ok((bvh2_binned::assemble(nodes, &order, triangles, start), order))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Invalid;
    use raywarp_core::math::vec3;
    use raywarp_core::traversal::bvh2::MAX_DEPTH;

    fn at(x: f32, size: f32, primitive: u32) -> Triangle {
        let corner = |y, z| vec3(x, y * size, z * size);
        Triangle::new(corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), primitive, 0)
    }

    /// Long triangles on the diagonal among small ones: boxes overlap wherever they are not cut.
    fn diagonals(count: u32) -> Vec<Triangle> {
        let triangle = |i: u32| {
            let (a, b) = ((i as f32 * 0.618).fract() * 10.0, (i as f32 * 0.414).fract() * 10.0);
            let length = [10.0, 0.1][(i % 10).min(1) as usize];
            Triangle::new(vec3(a, b, 0.0), vec3(a + length, b + length, length), vec3(a, b + 0.1, 0.1), i, 0)
        };
        (0..count).map(triangle).collect()
    }

    #[test]
    fn every_small_count_is_a_valid_tree() {
        for quality in Quality::ALL {
            for count in 0..60 {
                let tree = build((0..count).map(|i| at(i as f32, 1.0, i)).collect(), quality).unwrap();
                assert_eq!(tree.validate(), Ok(()), "{count}");
                let stats = tree.stats();
                assert_eq!(stats.references - stats.duplicates, count as usize);
            }
        }
    }

    #[test]
    fn quality_is_worth_its_time() {
        let [fast, medium, high] =
            Quality::ALL.map(|quality| build(diagonals(20_000), quality).unwrap().stats().sah_cost);
        assert!(high < 0.5 * medium && medium < 1.02 * fast, "{fast} {medium} {high}");
    }

    #[test]
    fn copies_keep_to_the_budget() {
        let triangles = diagonals(20_000);
        let stats = build(triangles.clone(), Quality::High).unwrap().stats();
        assert!(stats.duplicates > 0 && stats.duplicates <= triangles.len() / 2, "{stats:?}");
        assert_eq!(build(triangles, Quality::Medium).unwrap().stats().duplicates, 0);
    }

    #[test]
    fn identical_triangles_are_halved() {
        for quality in Quality::ALL {
            let tree = build(vec![at(0.0, 1.0, 0); 10_000], quality).unwrap();
            assert_eq!(tree.validate(), Ok(()));
            assert!(tree.stats().depth <= 14, "{:?}", tree.stats());
        }
    }

    /// Each cut takes off one triangle: without a limit the tree would have as many levels as triangles.
    #[test]
    fn exponential_spacing_keeps_to_the_limit() {
        for quality in Quality::ALL {
            let triangles = (0..4000).map(|i| at((i as f32 / 16.0 - 120.0).exp2(), 1e-36, i)).collect();
            let tree = build(triangles, quality).unwrap();
            assert_eq!(tree.validate(), Ok(()));
            assert!((20..=MAX_DEPTH).contains(&tree.stats().depth), "{:?}", tree.stats());
        }
    }

    #[test]
    fn threads_do_not_change_the_tree() {
        let triangles = diagonals(50_000);
        for quality in Quality::ALL {
            let with = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| build(triangles.clone(), quality).unwrap())
            };
            let (one, four) = (with(1), with(4));
            assert!(one.nodes == four.nodes && one.triangles == four.triangles);
        }
    }

    /// Boxes taken in, leaves without one of their triangles. Some parts are in other leaves by chance: not those.
    #[test]
    fn damage_to_split_trees_is_found() {
        let tree = build(diagonals(2_000), Quality::High).unwrap();
        assert!(tree.stats().duplicates > 0);
        let places = || (0..tree.nodes.len()).step_by(7).flat_map(|index| [(index, 0), (index, 1)]);
        let found = places().filter(|&(index, side)| {
            let mut smaller = tree.clone();
            let node = &mut smaller.nodes[index];
            node.high[side].x -= 0.01 * (node.high[side].x - node.low[side].x);
            matches!(smaller.validate(), Err(Invalid::Outside { .. }))
        });
        assert!(found.count() * 10 > places().count() * 9);
        for index in (0..tree.triangles.len()).step_by(7) {
            let mut other = tree.clone();
            other.triangles[index] = at(100.0, 1.0, 0);
            assert!(matches!(other.validate(), Err(Invalid::Outside { .. })), "{index}");
        }
    }
}
