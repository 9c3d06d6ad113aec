//! What holds for every layout of a hierarchy with many children a node.

use raywarp::accel::bounds::Bounds;
use raywarp::accel::bvh2::Bvh2;
use raywarp::accel::{bvh2_build, Invalid, Quality};
use raywarp::Triangle;
use raywarp_core::math::vec3;
use raywarp_core::traversal::bvh2::{Child, Node, MAX_DEPTH};

use super::bvh4::Bvh4;
use super::bvh8::Bvh8;
use super::bvh8w::Bvh8w;

/// Evaluates an expression with each kind of tree that a binary one can become.
macro_rules! for_each_layout {
    ($binary:expr, $tree:ident => $body:expr) => {{
        let binary = $binary;
        for_each_layout!(@ Bvh4::from_bvh2(binary), $tree => $body);
        for_each_layout!(@ Bvh8::from_bvh2(binary), $tree => $body);
        for_each_layout!(@ Bvh8w::from_bvh2(binary), $tree => $body);
        }};
    (@ $made:expr, $tree:ident => $body:expr) => {{
        #[allow(unused_mut)]
        let mut $tree = $made;
        $body
    }};
}

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

#[test]
fn every_small_count_is_a_valid_tree() {
    for count in 0..70 {
        let binary = bvh2_build::build(row(count), Quality::Fast).unwrap();
        for_each_layout!(&binary, tree => {
            assert_eq!(tree.validate(), Ok(()), "{count}");
            assert_eq!(tree.stats().references, count as usize);
        });
    }
}

#[test]
fn the_deepest_trees_fit_the_stacks() {
    // Boxes of octaves: the heuristic opens the largest child, and that is the next of the chain, or the other one.
    let sizes: [fn(f32) -> f32; 3] = [|_| 1.0, |i| (-i).exp2(), |i| i.exp2()];
    for size in sizes {
        let count = MAX_DEPTH as u32 + 1;
        let binary = chain((0..count).map(|i| at(i as f32, size(i as f32), i)).collect());
        for_each_layout!(&binary, tree => assert_eq!(tree.validate(), Ok(())));
    }
}

#[test]
fn a_triangle_may_be_in_several_leaves() {
    // One long triangle, in two boxes that meet in the middle.
    let long = Triangle::new(vec3(0.0, 0.0, 0.0), vec3(8.0, 0.0, 0.0), vec3(0.0, 1.0, 1.0), 0, 0);
    let [low, high] = Bounds::of(&long).corners();
    let children = [Child::leaf(0, 1), Child::leaf(1, 1)];
    let node =
        Node { low: [low, vec3(3.9, low.y, low.z)], high: [vec3(4.1, high.y, high.z), high], children, unused: [0; 2] };
    let cut = Bvh2::from_parts(vec![node], vec![long; 2]).unwrap();
    for_each_layout!(&cut, tree => {
        assert_eq!(tree.validate(), Ok(()));
        assert_eq!(tree.triangles().len(), 2);
    });
}

#[test]
fn flaws_of_every_layout_are_found() {
    let binary = bvh2_build::build(row(200), Quality::Fast).unwrap();
    for_each_layout!(&binary, tree => {
        let whole = tree.clone();
        tree.nodes.push(tree.nodes[0]);
        assert!(matches!(tree.validate(), Err(Invalid::Unreached { .. })));
        tree.nodes.clear();
        assert_eq!(tree.validate(), Err(Invalid::NoRoot));
        tree = whole.clone();
        tree.nodes.truncate(1);
        assert!(matches!(tree.validate(), Err(Invalid::OutOfRange { what: "node", .. })));
    });
    let whole = Bvh4::from_bvh2(&binary);
    let broken = |change: fn(&mut Bvh4)| {
        let mut tree = whole.clone();
        change(&mut tree);
        tree.validate().unwrap_err()
    };
    assert_eq!(broken(|tree| tree.nodes[0].children[0] = Child::node(0)), Invalid::Reached { node: 0 });
    assert_eq!(broken(|tree| tree.nodes[0].spacing.x = 0.0), Invalid::Grid { node: 0 });
    assert!(matches!(broken(|tree| tree.nodes[0].high[1] = 0x0101_0101), Invalid::Outside { .. }));
    assert!(matches!(broken(|tree| tree.triangles.push(at(0.0, 1.0, 0))), Invalid::Leaves { leaves: 0, .. }));
    assert!(matches!(broken(|tree| tree.triangles.truncate(9)), Invalid::OutOfRange { what: "triangle", .. }));
    let mut tree = Bvh8::from_bvh2(&binary);
    tree.nodes[0].slots[0] = 0xffff_ffff;
    assert!(matches!(tree.validate(), Err(Invalid::Slot { node: 0, .. })));
    let mut tree = Bvh8::from_bvh2(&binary);
    tree.nodes[0].exponents |= 0xff;
    assert_eq!(tree.validate(), Err(Invalid::Grid { node: 0 }));
}
