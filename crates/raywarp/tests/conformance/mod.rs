//! A device against the CPU: the same hits, the same pictures, to the bit.
//!
//! `RAYWARP_TEST_DEVICE` names the device under test (`cuda`, `cuda:1`, ...); without it the CPU's structures are held
//! against brute force, so that the checks mean something everywhere.

mod hits;
mod instances;
mod pictures;
mod queries;
mod watertight;

use crate::common::shipped;
use raywarp::accel::AccelKind;
use raywarp::device::{Device, DeviceChoice};
use raywarp::scene::load::{builtin, load, LoadOptions};
use raywarp::scene::Scene;
use raywarp::Triangle;

/// The device under test.
fn device() -> Device {
    let name = std::env::var("RAYWARP_TEST_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    let choice: DeviceChoice = name.parse().expect("RAYWARP_TEST_DEVICE names a device");
    Device::open(choice).expect("the device under test opens")
}

/// The structures that the device under test has kernels for.
fn kinds() -> Vec<AccelKind> {
    AccelKind::ALL.into_iter().filter(|&kind| !device().is_cuda() || kind != AccelKind::Bvh8f).collect()
}

/// How much to try: on a GPU that much, a tenth on a CPU, which takes longer and proves less.
fn scaled(count: usize) -> usize {
    if device().is_cuda() {
        count
    } else {
        count / 10
    }
}

/// The device that is believed.
fn reference() -> Device {
    Device::open(DeviceChoice::Cpu).expect("there always is a CPU")
}

/// A scene of the repository by its path in `scenes/`, or the built-in one.
fn scene(path: &str) -> Scene {
    if path == "built-in" {
        return builtin().expect("the built-in scene loads").scene;
    }
    load(&shipped(path), &LoadOptions::default()).expect("the scene loads").scene
}

/// Triangles of every instance, without a transform: enough to be hit.
fn triangles(scene: &Scene) -> Vec<Triangle> {
    let meshes = scene.instances.iter().map(|instance| &scene.meshes[instance.mesh]);
    let corners = meshes.flat_map(|mesh| mesh.triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize])));
    corners.zip(0..).map(|([a, b, c], id)| Triangle::new(a.into(), b.into(), c.into(), id, 0)).collect()
}

/// Random numbers that are the same on every run.
struct Random(u32);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(1);
        raywarp_core::sample::hash(self.0)
    }

    /// From -1 to 1.
    fn signed(&mut self) -> f32 {
        raywarp_core::sample::unit(self.bits()) * 2.0 - 1.0
    }

    fn vector(&mut self) -> raywarp::Vec3 {
        raywarp::Vec3::new(self.signed(), self.signed(), self.signed())
    }
}
