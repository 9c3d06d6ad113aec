//! Builds a [`Bvh2`] of the quality asked for: which steps it takes.

use std::time::Instant;

use rayon::prelude::*;
use raywarp_core::math::Vec3;
use raywarp_core::ray::MISS;
use raywarp_core::traversal::bvh2::MAX_INDEX;
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::bvh2::Bvh2;
use super::leaves::{alone, NOTHING};
use super::{hploc, leaves, reinsertion, topdown};
use super::{BuildError, Quality};

/// How a binary tree becomes better before it becomes a [`Bvh2`].
pub(super) struct Recipe {
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

/// How trees of a quality are built here; [`Quality::Fast`] has kernels for it.
pub(super) fn recipe(quality: Quality) -> Option<&'static Recipe> {
    match quality {
        Quality::Fast => None,
        Quality::Medium => Some(&MEDIUM),
        Quality::High => Some(&HIGH),
    }
}

/// Builds the tree. The result depends on the triangles, their order and the quality alone, not on the number of
/// threads.
///
/// - [`Quality::Fast`] is [`hploc`], with the bits that a GPU gives. It leaves triangles out that cannot be hit.
/// - [`Quality::Medium`] splits from the top, by the surface area heuristic over bins, down to one triangle a leaf, lets
///   the largest nodes look for better places, and then decides which subtrees become leaves.
/// - [`Quality::High`] also splits space where boxes would overlap, so that some triangles are in several leaves, and
///   lets all nodes look for better places until little is gained.
///
/// # Errors
/// More than [`MAX_INDEX`] triangles, or references where space is split.
pub fn build(triangles: Vec<Triangle>, quality: Quality) -> Result<Bvh2, BuildError> {
    match recipe(quality) {
        None => hploc::build_on_host(triangles),
        Some(recipe) => build_ordered(&triangles, recipe).map(|(tree, _)| tree),
    }
}

/// Also gives which triangle each of the tree's is, as an index into those given; of an empty scene nothing.
pub(super) fn build_ordered(triangles: &[Triangle], recipe: &Recipe) -> Result<(Bvh2, Vec<u32>), BuildError> {
    let start = Instant::now();
    if triangles.is_empty() {
        return Ok((empty(), Vec::new()));
    }
    let most = triangles.len() + (triangles.len() as f64 * recipe.copies) as usize;
    BuildError::check(most, MAX_INDEX)?;
    let mut tree = topdown::build(triangles, recipe.copies);
    reinsertion::optimise(&mut tree, recipe.shares, recipe.least);
    let (nodes, order) = leaves::collapse(&tree, triangles.len());
    drop(tree);
    let ordered = order.par_iter().map(|&index| triangles[index as usize]).collect();
    Ok((Bvh2 { nodes, triangles: ordered, build_seconds: start.elapsed().as_secs_f64() }, order))
}

/// A root without children.
pub(super) fn empty() -> Bvh2 {
    let point = Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, MISS, 0);
    Bvh2 { nodes: vec![alone(NOTHING, Bounds::EMPTY)], triangles: vec![point], build_seconds: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Invalid;
    use raywarp_core::math::vec3;
    use raywarp_core::traversal::bvh2::{Child, Node, MAX_DEPTH};

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

    fn row(count: u32, position: impl Fn(u32) -> f32) -> Vec<Triangle> {
        (0..count).map(|i| at(position(i), 1.0, i)).collect()
    }

    #[test]
    fn flaws_are_found() {
        let tree = build(row(100, |i| i as f32), Quality::Fast).unwrap();
        let broken = |change: fn(&mut Bvh2)| {
            let mut tree = tree.clone();
            change(&mut tree);
            tree.validate().unwrap_err()
        };
        assert_eq!(broken(|tree| tree.nodes.clear()), Invalid::NoRoot);
        assert_eq!(broken(|tree| tree.nodes[0].children[0] = Child::node(0)), Invalid::Reached { node: 0 });
        assert!(matches!(broken(|tree| tree.nodes[0].children[1] = Child::node(999)), Invalid::OutOfRange { .. }));
        assert!(matches!(broken(|tree| tree.nodes[0].children[1] = Child::leaf(98, 3)), Invalid::OutOfRange { .. }));
        assert!(matches!(broken(|tree| tree.nodes[0].children[1] = Child::leaf(0, 1)), Invalid::Unreached { .. }));
        assert_eq!(broken(|tree| tree.nodes[0].low[1].x = f32::NAN), Invalid::NoBox { node: 0 });
        assert_eq!(broken(|tree| tree.nodes[0].high[1].x -= 1.0), Invalid::Outside { node: 0 });
        assert!(matches!(broken(|tree| tree.nodes.push(tree.nodes[0])), Invalid::Unreached { .. }));
        assert!(matches!(broken(|tree| tree.triangles.push(at(0.0, 1.0, 0))), Invalid::Leaves { leaves: 0, .. }));
    }

    #[test]
    fn a_chain_that_overflows_the_stack_is_found() {
        let triangles = row(100, |_| 0.0);
        let bounds = Bounds::of(&triangles[0]);
        let link = |i: u32| [Child::leaf(i, 1), if i < 98 { Child::node(i + 1) } else { Child::leaf(99, 1) }];
        let nodes = (0..99).map(|i| Node { children: link(i), ..leaves::node(&[bounds; 2]) }).collect();
        let flaw = Bvh2::from_parts(nodes, triangles).unwrap_err();
        assert_eq!(flaw, Invalid::TooDeep { node: MAX_DEPTH as u32, limit: MAX_DEPTH });
    }
}
