//! Whole builds by plain loops over the threads, in an order that the test chooses.

use super::bounds::Bounds;
use super::emit::EmitNodes;
use super::gather::GatherTriangles;
use super::hploc::Hploc;
use super::morton::{MortonCodes, LAST};
use super::node::Node;
use super::radix_sort::{CountDigits, ScanDigits, ScatterDigits, BITS, DIGITS};
use super::survey::{Findings, Survey};
use super::TILE;
use crate::arch::BLOCK;
use crate::kernels::{Kernel, Thread};
use crate::math::{vec3, Vec3};
use crate::refit::{FindParents, Refit};
use crate::sample::{hash, unit};
use crate::traversal::bvh2::{self, Child};
use crate::traversal::bvh2_quantized::Grid;
use crate::triangle::Triangle;
use crate::view::{View, ViewMut};

fn view<T: Copy>(items: &[T]) -> View<T> {
    // SAFETY: the tests keep the items while kernels run.
    unsafe { View::new(items.as_ptr(), items.len() as u32) }
}

fn view_mut<T: Copy>(items: &mut [T]) -> ViewMut<T> {
    // SAFETY: as above.
    unsafe { ViewMut::new(items.as_mut_ptr(), items.len() as u32) }
}

/// Runs every thread of a launch, those of the same `turn` in the order of their hashes.
fn launch<K: Kernel>(kernel: &K, threads: u32, turn: u32) {
    let mut order: Vec<u32> = (0..threads).collect();
    if turn > 0 {
        order.sort_by_key(|&thread| hash(thread ^ turn));
    }
    for x in order {
        // SAFETY: each thread once, and the views are of vectors that are still there.
        unsafe { kernel.thread(Thread { x, y: 0 }) };
    }
}

fn sorted(pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let (mut from, mut to) = (pairs.to_vec(), pairs.to_vec());
    let runs = from.len().div_ceil(TILE as usize) as u32;
    let (mut counts, mut totals) = (vec![0; (runs * DIGITS) as usize], vec![0; DIGITS as usize]);
    for shift in (0..32).step_by(BITS as usize) {
        let pairs = view(&from);
        launch(&CountDigits { pairs, shift, runs, counts: view_mut(&mut counts) }, runs * BLOCK, 1);
        let (counts_mut, totals_mut) = (view_mut(&mut counts), view_mut(&mut totals));
        launch(&ScanDigits { runs, counts: counts_mut, totals: totals_mut }, DIGITS * BLOCK, 2);
        let (counts, totals) = (view(&counts), view(&totals));
        launch(&ScatterDigits { pairs, shift, runs, counts, totals, sorted: view_mut(&mut to) }, runs * BLOCK, 3);
        std::mem::swap(&mut from, &mut to);
    }
    from
}

struct Tree {
    found: Findings,
    merged: Vec<Node>,
    full: Vec<bvh2::Node>,
    triangles: Vec<Triangle>,
}

fn build(given: &[Triangle], turn: u32) -> Tree {
    let count = given.len();
    let (mut found, mut keys) = ([Findings::default()], vec![[0; 2]; count]);
    let (triangles, threads) = (view(given), count as u32);
    let findings = view_mut(&mut found);
    launch(&Survey { triangles, findings }, threads.div_ceil(TILE) * BLOCK, turn);
    let codes = MortonCodes { triangles, findings: view(&found), keys: view_mut(&mut keys) };
    launch(&codes, threads, turn);
    let (pairs, mut ends, mut lists) = (sorted(&keys), vec![0; count], vec![0; count]);
    let mut merged = vec![Node::default(); count];
    let (findings, in_order) = (view(&found), view(&pairs));
    let (ends, lists, nodes) = (view_mut(&mut ends), view_mut(&mut lists), view_mut(&mut merged));
    launch(&Hploc { triangles, findings, sorted: in_order, ends, lists, nodes }, threads, turn);
    let (root, nothing) = (
        merged[0],
        bvh2::Node { low: [Vec3::ZERO; 2], high: [Vec3::ZERO; 2], children: [Child::leaf(0, 1); 2], unused: [0; 2] },
    );
    let mut full = vec![nothing; root.nodes.max(1) as usize];
    let mut order = vec![0; root.count as usize];
    let emit = EmitNodes {
        tree: view(&merged),
        triangles,
        findings,
        sorted: in_order,
        grid: Grid { base: Vec3::ZERO, scale: Vec3::ONE },
        full: view_mut(&mut full),
        small: ViewMut::EMPTY,
        order: view_mut(&mut order),
    };
    launch(&emit, threads, turn);
    let mut ordered = vec![given[0]; order.len()];
    launch(&GatherTriangles { triangles, order: view(&order), ordered: view_mut(&mut ordered) }, root.count, turn);
    Tree { found: found[0], merged, full, triangles: ordered }
}

/// Checks boxes and links below a node; counts the nodes, and how often each triangle is met.
fn walk(tree: &Tree, index: u32, met: &mut [u32]) -> u32 {
    let node = &tree.full[index as usize];
    let mut nodes = 1;
    for side in (0..2).filter(|&side| node.has_child(side)) {
        let (child, low, high) = (node.children[side], node.low[side], node.high[side]);
        let inside = |a: Vec3, b: Vec3| assert!(low.min(a) == low && high.max(b) == high, "node {index}");
        if child.is_leaf() {
            for i in child.index()..child.index() + child.count() {
                met[i as usize] += 1;
                let (a, b) = tree.triangles[i as usize].bounds();
                inside(a, b);
            }
        } else {
            assert!(child.index() > index);
            let below = &tree.full[child.index() as usize];
            inside(below.low[0].min(below.low[1]), below.high[0].max(below.high[1]));
            nodes += walk(tree, child.index(), met);
        }
    }
    nodes
}

fn check(tree: &Tree) {
    let mut met = vec![0; tree.triangles.len()];
    assert_eq!(walk(tree, 0, &mut met), tree.full.len() as u32);
    assert!(met.iter().all(|&times| times == 1));
    let mut primitives: Vec<u32> = tree.triangles.iter().map(|triangle| triangle.primitive).collect();
    primitives.sort_unstable();
    assert!(primitives.windows(2).all(|pair| pair[0] < pair[1]));
}

fn scattered(count: u32, seed: u32) -> Vec<Triangle> {
    let number = |i: u32| unit(hash(i ^ seed)) * 2.0 - 1.0;
    let vector = |i: u32| vec3(number(3 * i), number(3 * i + 1), number(3 * i + 2));
    let triangle = |i: u32| {
        let centre = vector(3 * i);
        Triangle::new(centre, centre + vector(3 * i + 1) * 0.05, centre + vector(3 * i + 2) * 0.05, i, 0)
    };
    (0..count).map(triangle).collect()
}

#[test]
fn pairs_are_sorted_and_equal_ones_keep_their_order() {
    for (count, values) in [(1, 1), (5000, 1), (5000, 70), (20_000, u32::MAX)] {
        let pairs: Vec<[u32; 2]> = (0..count).map(|i| [hash(i) % values, i]).collect();
        let mut expected = pairs.clone();
        expected.sort();
        assert!(sorted(&pairs) == expected, "{count}, {values}");
    }
}

#[test]
fn trees_are_whole() {
    for count in (1..70).chain([100, 1000, 5000]) {
        let tree = build(&scattered(count, 1), 0);
        assert_eq!(tree.triangles.len(), count as usize);
        check(&tree);
    }
}

/// Who comes to a gap second depends on the order of the threads.
#[test]
fn the_order_of_threads_does_not_change_the_tree() {
    let triangles = scattered(3000, 2);
    let tree = build(&triangles, 0);
    for turn in 1..4 {
        let other = build(&triangles, turn);
        assert!(tree.merged == other.merged && tree.full == other.full && tree.triangles == other.triangles);
    }
}

#[test]
fn triangles_that_cannot_be_hit_are_left_out() {
    let mut triangles = scattered(1000, 3);
    for i in (0..1000).step_by(7) {
        triangles[i].v1 = triangles[i].v0;
    }
    for i in (0..1000).step_by(10) {
        triangles[i].v2.y = f32::NAN;
    }
    let tree = build(&triangles, 1);
    let without_area = (0..1000).filter(|i| i % 7 == 0 && i % 10 != 0).count();
    assert_eq!([tree.found.not_finite, tree.found.without_area], [100, without_area as u32]);
    assert_eq!(tree.triangles.len(), 1000 - 100 - without_area);
    check(&tree);
    let codes: Vec<u32> = tree.triangles.iter().map(|triangle| triangle.primitive).collect();
    assert!(codes.iter().all(|i| i % 7 != 0 && i % 10 != 0) && LAST == u32::MAX);
}

#[test]
fn identical_triangles_make_a_balanced_tree() {
    let one = scattered(1, 4)[0];
    let tree = build(&(0..10_000).map(|primitive| Triangle { primitive, ..one }).collect::<Vec<_>>(), 1);
    check(&tree);
    assert!(tree.merged[0].below().height() <= 14, "{}", tree.merged[0].below().height());
}

/// Boxes of the nodes after triangles were moved, in an order of the threads.
fn refitted(tree: &Tree, turn: u32) -> (Vec<bvh2::Node>, Vec<f32>) {
    let (mut nodes, count) = (tree.full.clone(), tree.full.len());
    let (mut parents, mut arrivals, mut areas) = (vec![0; count], vec![0; count], vec![0.0; count]);
    launch(&FindParents { nodes: view(&nodes), parents: view_mut(&mut parents) }, count as u32, turn);
    let refit = Refit {
        nodes: view_mut(&mut nodes),
        small: ViewMut::EMPTY,
        grid: Grid { base: Vec3::ZERO, scale: Vec3::ONE },
        triangles: view(&tree.triangles),
        parents: view(&parents),
        arrivals: view_mut(&mut arrivals),
        areas: view_mut(&mut areas),
    };
    launch(&refit, count as u32, turn);
    assert!(arrivals.iter().all(|&number| number == 0));
    (nodes, areas)
}

#[test]
fn boxes_follow_triangles_in_any_order_of_threads() {
    for count in [1, 2, 3, 9, 4000] {
        let mut tree = build(&scattered(count, 5), 0);
        assert!(refitted(&tree, 1).0 == tree.full, "nothing has moved");
        for triangle in &mut tree.triangles {
            let moved = |v: Vec3| vec3(v.x * 3.0, v.y + v.x, v.z - 2.0);
            *triangle = Triangle { v0: moved(triangle.v0), v1: moved(triangle.v1), ..*triangle };
        }
        let (nodes, areas) = refitted(&tree, 0);
        assert!((1..4).all(|turn| refitted(&tree, turn) == (nodes.clone(), areas.clone())));
        let boxes =
            nodes.iter().flat_map(|node| (0..2).filter(|&side| node.has_child(side)).map(move |side| (node, side)));
        let sum: f32 = boxes.map(|(n, side)| Bounds { low: n.low[side], high: n.high[side] }.half_area()).sum();
        assert!((areas[0] - sum).abs() <= 1e-4 * sum, "{} {sum}", areas[0]);
        tree.full = nodes;
        check(&tree);
    }
}

#[test]
fn nothing_that_can_be_hit_is_found_out() {
    let flat = Triangle::new(Vec3::ZERO, Vec3::ONE, Vec3::ONE, 0, 0);
    let mut found = [Findings::default()];
    launch(&Survey { triangles: view(&[flat; 3]), findings: view_mut(&mut found) }, BLOCK, 0);
    assert_eq!([found[0].hittable(3), found[0].without_area], [0, 3]);
    assert_eq!(found[0].corners.bounds().high, Vec3::ZERO);
}
