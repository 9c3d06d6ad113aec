//! The tree against a search of all planes and all triangles at every node.

use proptest::prelude::*;
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::traversal::kdtree::Node;

use super::cell::Cell;
use super::event::Event;
use super::part;
use super::plane::tests::{least_cost, slow_cost};
use super::*;
use raywarp::accel::bounds::Bounds;
use raywarp::accel::kdtree_arrays::share;

/// A random point in a cube, or one of the few on a lattice.
fn point(is_lattice: bool) -> impl Strategy<Value = Vec3> {
    let coordinate = if is_lattice { (0i8..4).prop_map(f32::from).boxed() } else { (-1.0f32..1.0).boxed() };
    [coordinate.clone(), coordinate.clone(), coordinate].prop_map(|[x, y, z]| vec3(x, y, z))
}

/// Large triangles, small ones, or triangles on a lattice: many of those have no area, or lie in planes that others end in.
fn scene() -> impl Strategy<Value = Vec<Triangle>> {
    let corners = |(is_lattice, size): (bool, f32)| {
        let triangle = [point(is_lattice), point(is_lattice), point(is_lattice)].prop_map(move |[a, b, c]| {
            let near = |v: Vec3| if is_lattice { v } else { a + (v - a) * size };
            [a, near(b), near(c)]
        });
        prop::collection::vec(triangle, 0..40)
    };
    let kinds = (any::<bool>(), prop::sample::select(vec![1.0f32, 0.2, 0.01]));
    let numbered = |(i, [a, b, c]): (usize, [Vec3; 3])| Triangle::new(a, b, c, i as u32, 0);
    kinds.prop_flat_map(corners).prop_map(move |list| list.into_iter().enumerate().map(numbered).collect())
}

/// What a cell must hold, from its box and all triangles, without any that went before.
fn check_contents(cell: &Cell, triangles: &[Triangle]) -> Result<(), TestCaseError> {
    for axis in 0..3 {
        let pairs = cell.parts.iter().zip(0..).map(|(part, i)| (i, part.bounds.low[axis], part.bounds.high[axis]));
        let mut events: Vec<Event> = pairs.flat_map(|(i, low, high)| Event::pair(i, low, high)).collect();
        events.sort_unstable();
        prop_assert_eq!(&events, &cell.events[axis]);
    }
    for (i, triangle) in triangles.iter().enumerate() {
        let held = cell.parts.iter().find(|part| part.triangle == i as u32).map(|part| part.bounds);
        match (held, part::share(triangle, &cell.bounds)) {
            (Some(held), Some(expected)) => prop_assert!(are_close(&held, &expected), "{:?} {:?}", held, expected),
            (held, expected) => {
                // A triangle a margin away may or may not be held.
                let flat = |bounds: Bounds| (0..3).any(|i| bounds.high[i] - bounds.low[i] < 1e-6);
                prop_assert!(held.or(expected).is_none_or(flat), "{:?} {:?}", held, expected);
            }
        }
    }
    Ok(())
}

fn are_close(a: &Bounds, b: &Bounds) -> bool {
    let pairs = a.low.iter().zip(&b.low).chain(a.high.iter().zip(&b.high));
    pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-6)
}

/// Cuts cells as the builder does, and finds each in the tree.
fn check_node(tree: &KdTree, index: u32, cell: Cell, budget: usize, depth: usize) -> Result<(), TestCaseError> {
    check_contents(&cell, tree.triangles())?;
    check_best(&cell)?;
    let builder = Builder { triangles: tree.triangles(), deepest: deepest(tree.triangles().len()) };
    let node = tree.nodes()[index as usize];
    let Some(plane) = builder.plane(&cell, budget, depth) else {
        let held = &tree.references()[node.first() as usize..(node.first() + node.count()) as usize];
        prop_assert!(node.is_leaf() && held.iter().copied().eq(cell.parts.iter().map(|part| part.triangle)));
        return Ok(());
    };
    prop_assert_eq!(node, Node::inner(plane.axis as u32, plane.at, node.below()));
    let cells = cell.cut(&plane, tree.triangles());
    let budgets = share(budget, cells[0].parts.len(), cells[1].parts.len());
    for (index, (cell, budget)) in (node.below()..).zip(cells.into_iter().zip(budgets)) {
        check_node(tree, index, cell, budget, depth + 1)?;
    }
    Ok(())
}

/// The sweep finds what a search of all planes finds.
fn check_best(cell: &Cell) -> Result<(), TestCaseError> {
    let (best, least) = (plane::best(cell), least_cost(cell));
    prop_assert_eq!(best.is_some(), least.is_some());
    let Some((best, least)) = best.zip(least) else { return Ok(()) };
    prop_assert!((best.cost - least).abs() <= 1e-9 * least, "{:?} costs more than {}", best, least);
    let cost = slow_cost(cell, best.axis, best.at);
    prop_assert!(cost.is_some_and(|cost| (best.cost - cost).abs() <= 1e-9 * cost), "{:?} costs {:?}", best, cost);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_cut_is_the_best(triangles in scene()) {
        let tree = build(triangles).unwrap();
        prop_assert_eq!(tree.validate(), Ok(()));
        check_node(&tree, 0, Cell::around(tree.triangles()), COPIES * tree.triangles().len(), 0)?;
    }
}

fn at(x: f32, size: f32, primitive: u32) -> Triangle {
    let corner = |y, z| vec3(x, y * size, z * size);
    Triangle::new(corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), primitive, 0)
}

/// Triangles everywhere, each a little turned, as large as the distance between neighbours.
fn soup(count: u32) -> Vec<Triangle> {
    let place = |i: u32, by: f32| (i as f32 * by).fract();
    let triangle = |i: u32| {
        let (at, size) = (vec3(place(i, 0.618), place(i, 0.414), place(i, 0.732)), 1.5 / (count as f32).cbrt());
        let turned = |by| vec3(place(i, by), place(i, by * 1.7), place(i, by * 2.3)) * size;
        Triangle::new(at, at + turned(0.31), at + turned(0.57), i, 0)
    };
    (0..count).map(triangle).collect()
}

/// A wall is on one side of a plane beside it.
#[test]
fn walls_are_not_in_the_cells_beside_them() {
    let tree = build((0..1000).map(|i| at(i as f32, 100.0, i)).collect()).unwrap();
    assert_eq!(tree.validate(), Ok(()));
    let stats = tree.stats();
    assert_eq!(stats.references, 1000, "{stats:?}");
    assert!(stats.leaves > 100, "{stats:?}");
}

#[test]
fn identical_triangles_stay_together() {
    let tree = build(vec![at(0.0, 1.0, 0); 1000]).unwrap();
    assert_eq!(tree.validate(), Ok(()));
    assert_eq!(tree.stats().largest_leaf, 1000);
}

#[test]
fn copies_keep_to_the_budget() {
    let triangles: Vec<_> = (1..3000).map(|i| at(i as f32 * 1e-3, i as f32, i)).collect();
    let tree = build(triangles.clone()).unwrap();
    assert_eq!(tree.validate(), Ok(()));
    assert!(tree.references().len() <= COPIES * triangles.len());
}

#[test]
fn what_cannot_be_hit_is_in_no_leaf() {
    let mut triangles = soup(100);
    triangles[7].v1.x = f32::NAN;
    triangles[9].v0.z = f32::NEG_INFINITY;
    let tree = build(triangles).unwrap();
    assert_eq!(tree.validate(), Ok(()));
    assert!(!tree.references().contains(&7) && !tree.references().contains(&9));
    assert!(tree.bounds()[0].z > -10.0);
}

#[test]
fn threads_do_not_change_the_tree() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build(soup(20_000)).unwrap())
    };
    let (one, packet) = (with(1), with(4));
    assert!(one.nodes() == packet.nodes() && one.references() == packet.references());
    assert!(one.nodes().len() > 1000);
}

/// A tree that leaves out a triangle of a cell is found out, wherever that is.
#[test]
fn a_part_that_is_missing_is_missed() {
    let tree = build(soup(300)).unwrap();
    assert!(tree.stats().duplicates > 100);
    let missed = |reference: usize| {
        let mut references = tree.references().to_vec();
        references[reference] = (references[reference] + 150) % 300;
        KdTree::from_parts(tree.nodes().to_vec(), references, tree.triangles().to_vec(), tree.bounds()).is_err()
    };
    // All but parts that are only in the margin beside their cell.
    let found = (0..tree.references().len()).filter(|&reference| missed(reference)).count();
    assert!(found * 100 >= tree.references().len() * 99, "{found} of {}", tree.references().len());
}

/// Work is the number of events in all cells: in O(n log n) it grows by little more than the triangles.
#[test]
fn work_grows_with_triangles_and_levels() {
    let work = |count| {
        let triangles = soup(count);
        let builder = Builder { triangles: &triangles, deepest: deepest(triangles.len()) };
        let mut open = vec![(Cell::around(&triangles), 0)];
        let mut events = 0;
        while let Some((cell, depth)) = open.pop() {
            events += cell.events.iter().map(Vec::len).sum::<usize>();
            if let Some(plane) = builder.plane(&cell, usize::MAX, depth) {
                open.extend(cell.cut(&plane, &triangles).map(|cell| (cell, depth + 1)));
            }
        }
        events as f64 / (f64::from(count) * f64::from(count).log2())
    };
    let (few, many) = (work(1_000), work(32_000));
    assert!(many < 1.5 * few, "{few} {many}");
}
