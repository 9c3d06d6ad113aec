//! The laboratory's structures and ways of tracing against brute force, on the CPU and on the device that `RAYWARP_TEST_DEVICE`
//! names.

mod boxes;
#[path = "../../../../crates/raywarp/tests/common/mod.rs"]
mod common;
mod hits;
mod kdtrail;
mod models;
mod pictures;
mod sharing;

use raywarp::accel::Quality;
use raywarp::device::{Device, DeviceChoice};
use raywarp::Triangle;
use raywarp_lab::structures::{Build, StructureKind, Tree};

/// The CPU, and the device that `RAYWARP_TEST_DEVICE` names, with the laboratory's kernels.
fn devices() -> Vec<Device> {
    let named = std::env::var("RAYWARP_TEST_DEVICE").ok();
    let choices =
        [Some(DeviceChoice::Cpu), named.map(|name| name.parse().expect("RAYWARP_TEST_DEVICE names a device"))];
    let open = |choice| raywarp_lab::open(choice).expect("the device under test opens");
    choices.into_iter().flatten().map(open).collect()
}

/// The structures that the product does not have on every device.
const OWN: [StructureKind; 7] = [
    StructureKind::Staged,
    StructureKind::KdSah,
    StructureKind::KdTrail,
    StructureKind::Bvh4,
    StructureKind::Bvh8,
    StructureKind::Bvh8w,
    StructureKind::BVH8F,
];

/// Brute force, and then every structure of the laboratory over the same triangles, wide ones of a tree of high quality too.
fn every_tree(triangles: &[Triangle]) -> Vec<Tree> {
    let high = |kind| Build { kind, quality: Quality::High };
    let better = [StructureKind::Bvh4, StructureKind::Bvh8, StructureKind::Bvh8w].map(high);
    let kinds = [StructureKind::BRUTE].into_iter().chain(OWN).map(Build::from).chain(better);
    kinds.map(|what| Tree::build(what, triangles.to_vec()).expect("few triangles")).collect()
}
