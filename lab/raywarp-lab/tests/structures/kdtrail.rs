//! Traversal by restarts visits what traversal by a stack does.

use crate::common::{ray, scene, Numbers, AIMS, FAMILIES};
use proptest::prelude::*;
use raywarp::accel::kdtree::KdTree;
use raywarp::accel::kdtree_median;
use raywarp_core::math::vec3;
use raywarp_core::ray::{Hit, Ray};
use raywarp_core::traversal::{all, closest, kdtree, occlusion, Keep, Structure, Tests, START};
use raywarp_core::triangle::Triangle;
use raywarp_lab::structures::{kdtree_sah, trail};

/// All hits of a ray.
#[derive(Default)]
struct List(Vec<[u32; 5]>);

impl Keep for List {
    fn keep(&mut self, _: u32, hit: &Hit) {
        self.0.push(bits(hit));
    }
}

fn bits(hit: &Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance]
}

/// What the queries answer, and what each of them counts.
fn query(structure: &impl Structure, ray: &Ray) -> (String, [Tests; 3]) {
    let (mut counts, mut list) = ([Tests::default(); 3], List::default());
    let [first, shadow, every] = &mut counts;
    let hit = bits(&closest(structure, ray, &START, first));
    let found = occlusion(structure, ray, shadow);
    all::<4>(structure, ray, 20, every, &mut list);
    (format!("{hit:?} {found:?} {:?}", list.0), counts)
}

/// Returns how many nodes are visited by a stack and by restarts.
fn check(tree: &KdTree, ray: &Ray) -> Result<[u32; 2], TestCaseError> {
    let [(by_stack, stack), (by_trail, trail)] = [query(&tree.view(), ray), query(&trail(tree), ray)];
    prop_assert_eq!(by_stack, by_trail, "{:?}", ray);
    for (stack, trail) in stack.iter().zip(&trail) {
        prop_assert_eq!(stack.triangles, trail.triangles, "{:?}", ray);
        prop_assert!(stack.nodes <= trail.nodes, "{:?}", ray);
    }
    Ok([stack, trail].map(|counts| counts.iter().map(|tests| tests.nodes).sum()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn restarts_visit_the_same_leaves(family in 0..FAMILIES, count in 1usize..300, seed: u64) {
        let mut numbers = Numbers(seed);
        let triangles = scene(family, count, &mut numbers);
        prop_assume!(!triangles.is_empty());
        for tree in [kdtree_sah::build(triangles.clone()).unwrap(), kdtree_median::build(triangles.clone()).unwrap()] {
            for i in 0..AIMS * 4 {
                check(&tree, &ray(i % AIMS, &triangles, &mut numbers))?;
            }
        }
    }
}

/// As deep as a tree may be: a comb whose every plane has a leaf on its far side. Forty-eight cells wait, four are kept.
#[test]
fn a_long_trail_leads_back_to_every_cell() {
    let levels = kdtree::MAX_DEPTH as u32;
    let wall = |i: u32| {
        let x = i as f32 + 0.5;
        Triangle::new(vec3(x, -1.0, -1.0), vec3(x, 2.0, -1.0), vec3(x, -1.0, 2.0), i, 0)
    };
    // The leaf above the plane x = i has wall i; the last inner node has a leaf on both sides.
    let mut nodes = vec![kdtree::Node::inner(0, levels as f32, 1)];
    for plane in (1..=levels).rev() {
        let (next, below) = (plane - 1, nodes.len() as u32 + 2);
        let rest = if next > 0 { kdtree::Node::inner(0, next as f32, below) } else { kdtree::Node::leaf(0, 1) };
        nodes.extend([rest, kdtree::Node::leaf(plane, 1)]);
    }
    let walls: Vec<_> = (0..=levels).map(wall).collect();
    let bounds = [vec3(0.0, -2.0, -2.0), vec3(levels as f32 + 1.0, 3.0, 3.0)];
    let tree = KdTree::from_parts(nodes, (0..=levels).collect(), walls, bounds).unwrap();
    for (from, to) in [(-1.0, 1.0), (60.0, -1.0), (20.2, 1.0), (20.2, -1.0)] {
        check(&tree, &Ray::new(vec3(from, 0.0, 0.0), vec3(to, 0.0, 0.0))).unwrap();
    }
    // Through all cells without a hit: down once by the stack. By the trail the cells that were dropped are looked for
    // from the root.
    let past = Ray::new(vec3(-1.0, 1.9, 1.9), vec3(1.0, 0.0, 0.0));
    let [stack, trail] = check(&tree, &past).unwrap();
    assert_eq!(stack, 3 * (2 * levels + 1));
    assert!(trail > stack && trail < 20 * stack, "{trail} after {stack}");
}
