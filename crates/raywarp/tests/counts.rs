//! What traversal counts, against counts by hand on trees made by hand.

use raywarp::accel::brute::Brute;
use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::kdtree::KdTree;
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::{Ray, MISS};
use raywarp_core::traversal::{bvh2, closest, kdtree, occlusion, Structure, Tests, START};
use raywarp_core::triangle::Triangle;

/// Four triangles across the x axis, at 0, 1, 2 and 3.
fn row() -> Vec<Triangle> {
    let corner = |x, y, z| vec3(x, y, z);
    let across = |i| {
        let x = i as f32;
        Triangle::new(corner(x, -1.0, -1.0), corner(x, 1.0, -1.0), corner(x, 0.0, 1.0), i, 0)
    };
    (0..4).map(across).collect()
}

const MARGIN: f32 = 0.125;

fn between(first: f32, last: f32) -> (Vec3, Vec3) {
    (vec3(first, -1.0, -1.0) + Vec3::splat(-MARGIN), vec3(last, 1.0, 1.0) + Vec3::splat(MARGIN))
}

/// The root over two nodes, each over two leaves of one triangle.
fn hierarchy() -> Bvh2 {
    let node = |left: (Vec3, Vec3), right: (Vec3, Vec3), children| bvh2::Node {
        low: [left.0, right.0],
        high: [left.1, right.1],
        children,
        unused: [0; 2],
    };
    let leaves = |i: u32| {
        let x = i as f32;
        node(between(x, x), between(x + 1.0, x + 1.0), [bvh2::Child::leaf(i, 1), bvh2::Child::leaf(i + 1, 1)])
    };
    let root = node(between(0.0, 1.0), between(2.0, 3.0), [bvh2::Child::node(1), bvh2::Child::node(2)]);
    Bvh2::from_parts(vec![root, leaves(0), leaves(2)], row()).unwrap()
}

/// Cut at 1.5, and below that at 0.5: three leaves of one, one and two triangles.
fn cells() -> KdTree {
    let nodes = vec![
        kdtree::Node::inner(0, 1.5, 1),
        kdtree::Node::inner(0, 0.5, 3),
        kdtree::Node::leaf(2, 2),
        kdtree::Node::leaf(0, 1),
        kdtree::Node::leaf(1, 1),
    ];
    KdTree::from_parts(nodes, vec![0, 1, 2, 3], row(), between(0.0, 3.0).into()).unwrap()
}

fn along(from: f32, to: f32) -> Ray {
    Ray::new(vec3(from, 0.0, 0.0), vec3(to - from, 0.0, 0.0))
}

/// Nodes visited, triangles tested and the triangle found by the closest hit, then by the shadow ray.
fn count(structure: &impl Structure, ray: Ray) -> ([u32; 3], [u32; 2]) {
    let (mut near, mut shadow) = (Tests::default(), Tests::default());
    let hit = closest(structure, &ray, &START, &mut near);
    occlusion(structure, &ray, &mut shadow);
    assert_eq!((near.rays, shadow.rays), (1, 1));
    ([near.nodes, near.triangles, hit.primitive], [shadow.nodes, shadow.triangles])
}

#[test]
fn brute_force_tests_everything_until_a_shadow_is_found() {
    let list = Brute::new(row()).unwrap();
    assert_eq!(count(&list.view(), along(-1.0, 0.0)), ([0, 4, 0], [0, 1]));
    assert_eq!(count(&list.view(), along(4.0, 3.0)), ([0, 4, 3], [0, 1]));
    assert_eq!(count(&list.view(), along(4.0, 5.0)), ([0, 4, MISS], [0, 4]));
}

#[test]
fn the_hierarchy_counts_inner_nodes() {
    let tree = hierarchy();
    // The root, the near node and its near leaf. What waits is popped all the same: the near node's other leaf, then
    // the far node, whose boxes both lie behind the hit.
    assert_eq!(count(&tree.view(), along(-1.0, 0.0)), ([3, 2, 0], [2, 1]));
    assert_eq!(count(&tree.view(), along(4.0, 3.0)), ([3, 2, 3], [2, 1]));
    // The far half only.
    assert_eq!(count(&tree.view(), along(1.5, 1.6)), ([2, 2, 2], [2, 1]));
    // No box of the root.
    assert_eq!(count(&tree.view(), along(4.0, 5.0)), ([1, 0, MISS], [1, 0]));
}

#[test]
fn the_k_d_tree_counts_inner_nodes_and_leaves() {
    let tree = cells();
    // Down to the nearest leaf; the other cells begin behind the hit.
    assert_eq!(count(&tree.view(), along(-1.0, 0.0)), ([3, 1, 0], [3, 1]));
    // From the other end the first leaf is one step down and holds two triangles.
    assert_eq!(count(&tree.view(), along(4.0, 3.0)), ([2, 2, 3], [2, 1]));
    // From the middle upwards: the root, then the leaf above the plane.
    assert_eq!(count(&tree.view(), along(1.6, 1.7)), ([2, 2, 2], [2, 1]));
    // Past the bounds.
    assert_eq!(count(&tree.view(), along(4.0, 5.0)), ([0, 0, MISS], [0, 0]));
}
