//! Fast trees: whole, and the same to the bit on every device and number of threads.

use crate::common::{devices, scene, Numbers, FAMILIES};
use proptest::prelude::*;
use raywarp::accel::hploc::{Built, NodeSizes, TreeBuilder};
use raywarp::accel::{drop_degenerate, Accel, AccelKind, Build, BuildError, Quality};
use raywarp::device::{Device, DeviceChoice};
use raywarp::device_scene::DeviceScene;
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::traversal::bvh2::MAX_DEPTH;
use raywarp_core::triangle::Triangle;

const FAST: Build = Build { kind: AccelKind::Bvh, quality: Quality::Fast, cached: false };

fn cpu() -> Device {
    Device::open(DeviceChoice::Cpu).unwrap()
}

fn build(triangles: &[Triangle], device: &Device) -> Built {
    let mut builder = TreeBuilder::new(device, triangles.len()).unwrap();
    builder.build(&device.upload(triangles).unwrap(), NodeSizes::Both).unwrap()
}

/// Nodes, small nodes and triangles as numbers: equal means equal to the bit.
fn bits(built: &Built) -> [Vec<u32>; 3] {
    let tree = &built.tree;
    let corner = |v: Vec3| v.to_array().map(f32::to_bits);
    let nodes = tree.nodes().to_vec().unwrap().into_iter().flat_map(|node| {
        let corners = [node.low[0], node.low[1], node.high[0], node.high[1]];
        corners.into_iter().flat_map(corner).chain(node.children.map(|child| child.bits()))
    });
    let small = tree.small_nodes().0.to_vec().unwrap();
    let small = small.into_iter().flat_map(|node| node.children).flat_map(|child| child.planes);
    let triangles = tree.triangles().to_vec().unwrap().into_iter().flat_map(|triangle| {
        let corners = [triangle.v0, triangle.v1, triangle.v2];
        corners.into_iter().flat_map(corner).chain([triangle.primitive, triangle.flags, triangle.instance])
    });
    [nodes.collect(), small.collect(), triangles.collect()]
}

/// Triangles of all sizes, some that cannot be hit among them.
fn mixed(count: u32, seed: u64) -> Vec<Triangle> {
    let mut numbers = Numbers(seed);
    let triangle = |i: u32| {
        let (place, size) = (numbers.point() * 10.0, numbers.pick(&[0.01, 0.1, 1.0]));
        let [a, b] = [numbers.point() * size, numbers.point() * size];
        match i % 50 {
            7 => Triangle::new(place, place, place + b, i, 0),
            9 => Triangle::new(place, vec3(f32::NAN, 0.0, 0.0), place + b, i, 0),
            _ => Triangle::new(place, place + a, place + b, i, i % 3),
        }
    };
    (0..count).map(triangle).collect()
}

/// What is told of a tree is what its nodes say.
fn check(built: &Built) {
    let host = built.tree.to_host().unwrap();
    assert_eq!(host.validate(), Ok(()));
    let (told, found) = (built.tree.stats(), host.stats());
    assert_eq!((told.nodes, told.leaves, told.references), (found.nodes, found.leaves, found.references));
    assert_eq!((told.depth, told.largest_leaf, told.bytes), (found.depth, found.largest_leaf, found.bytes));
    assert_eq!(found.duplicates, 0);
    // Areas in single precision: of larger scenes they are infinite, of smaller ones zero.
    let extent = (0..3).map(|axis| built.bounds[1][axis] - built.bounds[0][axis]).fold(0.0, f32::max);
    if !(1e-15..1e18).contains(&extent) {
        return;
    }
    assert!((told.sah_cost - found.sah_cost).abs() <= 1e-4 * found.sah_cost, "{told:?} {found:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn trees_are_whole_and_the_same_everywhere(family in 0..FAMILIES, count in 1usize..3000, seed: u64) {
        let triangles = scene(family, count, &mut Numbers(seed));
        let built = build(&triangles, &cpu());
        check(&built);
        for device in devices() {
            prop_assert!(bits(&build(&triangles, &device)) == bits(&built), "{}", device.description());
        }
    }
}

#[test]
fn every_small_count_is_the_same_everywhere() {
    for device in devices() {
        for count in 0..100 {
            let triangles = mixed(count, u64::from(count));
            let built = build(&triangles, &device);
            check(&built);
            assert!(bits(&built) == bits(&build(&triangles, &cpu())), "{count}");
        }
    }
}

#[test]
fn threads_do_not_change_the_tree() {
    let triangles = mixed(60_000, 1);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bits(&build(&triangles, &cpu())))
    };
    let one = with(1);
    assert!(one == with(2) && one == with(3));
    for device in devices() {
        assert!(one == bits(&build(&triangles, &device)), "{}", device.description());
    }
}

#[test]
fn triangles_that_cannot_be_hit_are_left_out_and_counted() {
    for device in devices() {
        let triangles = mixed(20_000, 2);
        let built = build(&triangles, &device);
        let (kept, dropped) = drop_degenerate(triangles);
        assert_eq!((built.triangles, built.dropped), (kept.len(), dropped));
        let corners = || kept.iter().flat_map(|t| [t.v0, t.v1, t.v2]);
        let low = corners().fold(Vec3::splat(f32::MAX), |low, v| low.min(v));
        let high = corners().fold(Vec3::splat(-f32::MAX), |high, v| high.max(v));
        assert_eq!(built.bounds, [low.to_array(), high.to_array()]);
    }
}

#[test]
fn nothing_to_hit_is_a_tree_that_nothing_is_hit_in() {
    let flat = Triangle::new(Vec3::ZERO, Vec3::ONE, Vec3::ONE, 0, 0);
    for device in devices() {
        for triangles in [vec![], vec![flat; 5000]] {
            let built = build(&triangles, &device);
            assert_eq!((built.triangles, built.dropped.without_area), (0, triangles.len()));
            assert_eq!(built.tree.to_host().unwrap().validate(), Ok(()));
        }
    }
}

/// Each triangle lies within the next: its nearest neighbour is the one before, which has a nearer one.
#[test]
fn what_is_too_deep_is_built_by_the_host() {
    let at = |i: u32| {
        let size = (i as f32 / 8.0 - 60.0).exp2();
        Triangle::new(Vec3::ZERO, vec3(size, 0.0, 0.0), vec3(0.0, size, size), i, 0)
    };
    let triangles: Vec<Triangle> = (0..900).map(at).collect();
    for device in devices() {
        let built = build(&triangles, &device);
        assert!(built.too_deep.is_some_and(|depth| depth > MAX_DEPTH), "{:?}", built.too_deep);
        assert_eq!(built.tree.to_host().unwrap().validate(), Ok(()));
        let scene = DeviceScene::of_triangles(triangles.clone(), FAST, &device).unwrap();
        assert!(scene.report().notes[0].contains("more than the 64"), "{:?}", scene.report().notes);
    }
}

#[test]
fn one_builder_builds_many_trees() {
    for device in devices() {
        let mut builder = TreeBuilder::new(&device, 9000).unwrap();
        for count in [9000, 10, 5000, 1] {
            let triangles = mixed(count, 3);
            let built = builder.build(&device.upload(&triangles).unwrap(), NodeSizes::Both).unwrap();
            assert!(bits(&built) == bits(&build(&triangles, &cpu())), "{count}");
        }
        let more = device.upload(&mixed(9001, 3)).unwrap();
        let refused = builder.build(&more, NodeSizes::Full).map(|built| built.triangles);
        assert_eq!(refused, Err(BuildError::Capacity { has: 9001, capacity: 9000 }));
    }
}

#[test]
fn a_scene_on_a_device_has_the_tree_of_the_host() {
    let triangles = mixed(5000, 4);
    let host = Accel::build(FAST, triangles.clone()).unwrap().stats();
    for device in devices() {
        let scene = DeviceScene::of_triangles(triangles.clone(), FAST, &device).unwrap();
        let report = scene.report();
        assert_eq!((report.triangles, report.dropped.count()), (4800, 200));
        assert_eq!((report.tree.nodes, report.tree.depth, report.tree.bytes), (host.nodes, host.depth, host.bytes));
        assert!(report.build_seconds > 0.0 && report.tree.build_seconds == report.build_seconds);
    }
}
