//! Builds a [`Bvh2`] soon: by the surface area heuristic, from the top, with bins (Wald 2007).
//!
//! Each range of triangles is split where the bins of their centres say that the expected cost of a ray is least, over
//! all three axes, until a leaf is cheaper. Where centres coincide or the tree becomes too deep, the range is halved
//! instead, so that every input ends within the levels that traversal's stack holds.

use std::time::Instant;

use rayon::prelude::*;
use raywarp_core::math::Vec3;
use raywarp_core::ray::MISS;
use raywarp_core::traversal::bvh2::{Child, Node, MAX_DEPTH, MAX_INDEX, MAX_LEAF};
use raywarp_core::triangle::Triangle;

use super::bins::{around, halve, Bins, Item, Split};
use super::bounds::Bounds;
use super::bvh2::Bvh2;
use super::{BuildError, TRIANGLE_COST};

/// Most triangles of a leaf. More only pays where the heuristic's costs are wrong.
const LEAF: usize = 8;

/// Ranges longer than this are built by two threads; shorter ones are not worth the hand-over.
const PARALLEL: usize = 4096;

const _: () = assert!(LEAF <= MAX_LEAF as usize);

/// Builds the tree. The result depends on the triangles and their order alone, not on the number of threads.
///
/// # Errors
/// More than [`MAX_INDEX`] triangles.
pub fn build(triangles: Vec<Triangle>) -> Result<Bvh2, BuildError> {
    build_ordered(&triangles).map(|(tree, _)| tree)
}

/// Also gives which triangle each of the tree's is, as an index into those given; of an empty scene nothing.
pub(super) fn build_ordered(triangles: &[Triangle]) -> Result<(Bvh2, Vec<u32>), BuildError> {
    let start = Instant::now();
    BuildError::check(triangles.len(), MAX_INDEX)?;
    let mut items: Vec<Item> = triangles.par_iter().enumerate().map(|(i, t)| Item::new(i as u32, t)).collect();
    let mut nodes = Vec::with_capacity(triangles.len() / 2);
    match grow(&mut items, 0, MAX_DEPTH, &mut nodes) {
        Some(root) if root.is_leaf() => nodes.push(alone(root, around(&items))),
        Some(_) => {}
        None => return Ok((empty(start), Vec::new())),
    }
    let order: Vec<u32> = items.par_iter().map(|item| item.index).collect();
    Ok((assemble(nodes, &order, triangles, start), order))
}

/// The tree of nodes whose leaves are runs of `order`.
pub(super) fn assemble(nodes: Vec<Node>, order: &[u32], triangles: &[Triangle], start: Instant) -> Bvh2 {
    let triangles = order.par_iter().map(|&index| triangles[index as usize]).collect();
    Bvh2 { nodes, triangles, build_seconds: start.elapsed().as_secs_f64() }
}

/// Adds the tree of a range that starts at triangle `first`, with at most `levels` inner nodes on the way to a leaf.
fn grow(items: &mut [Item], first: u32, levels: usize, nodes: &mut Vec<Node>) -> Option<Child> {
    let count = items.len();
    let Some(split) = divide(items, levels) else {
        return (count > 0).then(|| Child::leaf(first, count as u32));
    };
    let slot = nodes.len();
    let (left, right) = items.split_at_mut(split.middle);
    let middle = first + left.len() as u32;
    nodes.push(node(&split.bounds));
    let children = if count > PARALLEL {
        let mut apart = Vec::with_capacity(right.len() / 2);
        let (left, right) =
            rayon::join(|| grow(left, first, levels - 1, nodes), || grow(right, middle, levels - 1, &mut apart));
        let offset = nodes.len() as u32;
        nodes
            .extend(apart.into_iter().map(|node| Node { children: node.children.map(|c| shifted(c, offset)), ..node }));
        [left, right.map(|child| shifted(child, offset))]
    } else {
        [grow(left, first, levels - 1, nodes), grow(right, middle, levels - 1, nodes)]
    };
    // Both halves of a split hold triangles.
    nodes[slot].children = children.map(|child| child.unwrap_or(NOTHING));
    Some(Child::node(slot as u32))
}

fn shifted(child: Child, offset: u32) -> Child {
    if child.is_leaf() {
        child
    } else {
        Child::node(child.index() + offset)
    }
}

/// With boxes, but no children yet.
pub(super) fn node(bounds: &[Bounds; 2]) -> Node {
    let [[low_left, high_left], [low_right, high_right]] = bounds.each_ref().map(Bounds::corners);
    Node { low: [low_left, low_right], high: [high_left, high_right], children: [NOTHING; 2], unused: [0; 2] }
}

/// Reorders a range so that its two parts follow each other; nothing where a leaf is better.
fn divide(items: &mut [Item], levels: usize) -> Option<Split> {
    let count = items.len();
    if count <= 1 {
        return None;
    }
    // The heuristic may split off one triangle at a time: only as long as halving still reaches leaves in time.
    let best = (halvings(count - 1) < levels).then(|| Bins::fill(items).best()).flatten();
    if count <= LEAF {
        let cost = TRIANGLE_COST * count as f64;
        return best.filter(|best| best.cost() < cost).map(|best| best.apply(items));
    }
    Some(match best {
        Some(best) => best.apply(items),
        None => halve(items),
    })
}

/// How often a range must be halved to become leaves.
fn halvings(count: usize) -> usize {
    count.div_ceil(LEAF).next_power_of_two().trailing_zeros() as usize
}

/// Where a child that does not exist links to.
pub(super) const NOTHING: Child = Child::leaf(0, 1);

/// The root of a scene that is one leaf.
pub(super) fn alone(leaf: Child, bounds: Bounds) -> Node {
    Node { children: [leaf, NOTHING], ..node(&[bounds, Bounds::EMPTY]) }
}

/// A root without children.
fn empty(start: Instant) -> Bvh2 {
    let point = Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, MISS, 0);
    let nodes = vec![alone(NOTHING, Bounds::EMPTY)];
    Bvh2 { nodes, triangles: vec![point], build_seconds: start.elapsed().as_secs_f64() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Invalid;
    use raywarp_core::math::vec3;

    fn at(x: f32, size: f32, primitive: u32) -> Triangle {
        let corner = |y, z| vec3(x, y * size, z * size);
        Triangle::new(corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), primitive, 0)
    }

    fn row(count: u32, position: impl Fn(u32) -> f32) -> Vec<Triangle> {
        (0..count).map(|i| at(position(i), 1.0, i)).collect()
    }

    #[test]
    fn every_small_count_is_a_valid_tree() {
        for count in 0..100 {
            let tree = build(row(count, |i| i as f32)).unwrap();
            assert_eq!(tree.validate(), Ok(()), "{count}");
            assert_eq!(tree.stats().references, count as usize);
        }
    }

    #[test]
    fn identical_triangles_are_halved() {
        let tree = build(vec![at(0.0, 1.0, 0); 1_000_000]).unwrap();
        assert_eq!(tree.validate(), Ok(()));
        assert!(tree.stats().depth <= 17, "{:?}", tree.stats());
    }

    /// Each cut takes off one triangle: without a limit the tree would have as many levels as triangles.
    #[test]
    fn exponential_spacing_keeps_to_the_limit() {
        let tree = build((0..4000).map(|i| at((i as f32 / 16.0 - 120.0).exp2(), 1e-36, i)).collect()).unwrap();
        assert_eq!(tree.validate(), Ok(()));
        assert!(tree.stats().depth > 20, "{:?}", tree.stats());
    }

    #[test]
    fn threads_do_not_change_the_tree() {
        let triangles = row(50_000, |i| (i as f32 * 0.618).fract());
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| build(triangles.clone()).unwrap())
        };
        let (one, four) = (with(1), with(4));
        assert!(one.nodes == four.nodes && one.triangles == four.triangles);
    }

    #[test]
    fn flaws_are_found() {
        let tree = build(row(100, |i| i as f32)).unwrap();
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
        let nodes = (0..99).map(|i| Node { children: link(i), ..node(&[bounds; 2]) }).collect();
        let flaw = Bvh2::from_parts(nodes, triangles).unwrap_err();
        assert_eq!(flaw, Invalid::TooDeep { node: MAX_DEPTH as u32, limit: MAX_DEPTH });
    }
}
