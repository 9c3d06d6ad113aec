//! Scenes and rays from random numbers, with a bias towards what goes wrong.

#![allow(dead_code)] // Each test uses its share.

use std::path::PathBuf;

use raywarp::accel::{Accel, AccelKind, Build, Quality};
use raywarp::device::{Device, DeviceChoice};
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::Ray;
use raywarp_core::triangle::Triangle;

/// Random numbers: PCG (O'Neill 2014).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((((self.0 >> 18) ^ self.0) >> 27) as u32).rotate_right((self.0 >> 59) as u32)
    }

    pub fn below(&mut self, count: usize) -> usize {
        self.next() as usize % count
    }

    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / 16_777_216.0
    }

    /// From -1 to 1.
    pub fn signed(&mut self) -> f32 {
        self.unit() * 2.0 - 1.0
    }

    pub fn point(&mut self) -> Vec3 {
        vec3(self.signed(), self.signed(), self.signed())
    }

    /// One of few points.
    fn lattice(&mut self) -> Vec3 {
        vec3(self.below(5) as f32 - 2.0, self.below(5) as f32 - 2.0, self.below(5) as f32 - 2.0)
    }
}

/// Kinds of [`corners`].
pub const FAMILIES: usize = 9;

/// One triangle of a family: large, small, on a lattice, identical, a floor, a sliver, nested in octaves, parallel to
/// an axis, in a stack of planes.
fn corners(family: usize, index: usize, first: [Vec3; 3], n: &mut Numbers) -> [Vec3; 3] {
    match family {
        0 => [n.point(), n.point(), n.point()],
        1 => {
            let p = n.point() * 4.0;
            [p, p + n.point() * 0.3, p + n.point() * 0.3]
        }
        2 => [n.lattice(), n.lattice(), n.lattice()],
        3 => first,
        4 => {
            let p = vec3(n.below(4) as f32, n.below(2) as f32, n.below(4) as f32);
            [p, p + vec3(1.0, 0.0, 0.0), p + vec3(0.0, 0.0, 1.0)]
        }
        5 => {
            let (p, along) = (n.point(), n.point());
            [p, p + along, p + along * 0.5 + n.point() * 1e-6]
        }
        6 => {
            let size = (index as f32 / 8.0).exp2() * 1e-6;
            [n.point() * size, n.point() * size, n.point() * size]
        }
        7 => {
            let p = n.point();
            [p, vec3(n.signed(), p.y, p.z), vec3(p.x, p.y, n.signed())]
        }
        _ => {
            let y = n.below(3) as f32;
            [(); 3].map(|()| vec3(n.signed(), y, n.signed()))
        }
    }
}

/// Triangles of a family at some scale and place, duplicates of primitives and see-through ones among them.
pub fn scene(family: usize, count: usize, n: &mut Numbers) -> Vec<Triangle> {
    let scale = n.pick(&[1.0, 1e-6, 1e6, 1e-3, 1e3]);
    let offset = if n.below(3) == 0 { n.point() * (1000.0 * scale) } else { Vec3::ZERO };
    let first = [n.point(), n.point(), n.point()];
    let make = |i| {
        let [a, b, c] = corners(family, i, first, n).map(|v| v * scale + offset);
        Triangle::new(a, b, c, i as u32, (n.below(5) == 0) as u32)
    };
    raywarp::accel::drop_degenerate((0..count).map(make).collect()).0
}

/// A point of a triangle, often on an edge or in a corner.
fn point_on(triangle: &Triangle, n: &mut Numbers) -> Vec3 {
    let (u, v) = match n.below(4) {
        0 => (0.0, n.unit()),
        1 => (0.0, 0.0),
        2 => (n.unit(), 1.0),
        _ => (n.unit(), n.unit()),
    };
    let v = v * (1.0 - u);
    triangle.v0 * (1.0 - u - v) + triangle.v1 * u + triangle.v2 * v
}

/// Kinds of [`ray`].
pub const AIMS: usize = 11;

/// A ray at something of a scene, or past it.
pub fn ray(aim: usize, scene: &[Triangle], n: &mut Numbers) -> Ray {
    let triangle = n.pick(scene);
    let target = point_on(&triangle, n);
    let corner = n.pick(&[triangle.v0, triangle.v1, triangle.v2]);
    let origin = target + n.point() * (triangle.extent() * n.pick(&[1.0, 3.0, 30.0, 0.01]));
    let mut axis = [0.0, -0.0, 0.0];
    axis[n.below(3)] = n.pick(&[1.0, -1.0]);
    let axis = Vec3::from(axis);
    match aim {
        0 => Ray::new(origin, target - origin),
        1 => Ray::new(origin, n.point()),
        2 => Ray::new(target - axis * (triangle.extent() * 2.0), axis),
        // In the faces of boxes.
        3 => Ray::new(corner - axis * (triangle.extent() * 3.0), axis),
        // From a surface, or from one to another.
        4 => Ray::new(target, n.point()),
        5 => Ray::new(target, point_on(&n.pick(scene), n) - target),
        6 => Ray::new(origin, corner - origin),
        7 => {
            let (t_min, t_max) = (n.unit() * triangle.extent(), n.unit() * 2.0 * triangle.extent());
            Ray { t_min, t_max, ..Ray::new(origin, (target - origin) * (1.0 / triangle.extent())) }
        }
        // Parallel to a plane of two axes.
        8 => {
            let across = n.point() * (vec3(1.0, 1.0, 1.0) + axis * -axis.max_abs() * (axis.x + axis.y + axis.z));
            Ray::new(corner - across * (triangle.extent() * n.unit()), across)
        }
        9 => Ray::new(origin, (target - origin) * n.pick(&[1e-20, 1e20])),
        _ => nonsense(origin, n),
    }
}

fn nonsense(origin: Vec3, n: &mut Numbers) -> Ray {
    let (good, odd) = (n.point(), n.pick(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]));
    match n.below(5) {
        0 => Ray::new(origin, Vec3::ZERO),
        1 => Ray::new(origin, vec3(odd, good.y, good.z)),
        2 => Ray::new(vec3(origin.x, odd, origin.z), good),
        3 => Ray { t_min: odd, ..Ray::new(origin, good) },
        _ => Ray { t_max: odd, ..Ray::new(origin, good) },
    }
}

/// A file of the scenes that come with raywarp. `RAYWARP_SCENES` names their folder where tests run without the sources.
pub fn shipped(path: &str) -> PathBuf {
    if let Some(folder) = std::env::var_os("RAYWARP_SCENES") {
        return PathBuf::from(folder).join(path);
    }
    let crates = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    match path.starts_with("built-in") {
        true => crates.join("raywarp-scene").join(path),
        false => crates.join("../scenes").join(path),
    }
}

/// Every structure of the same triangles, brute force first, and the hierarchies of boxes in other qualities.
pub fn every_structure(triangles: &[Triangle]) -> Vec<Accel> {
    let better = [AccelKind::Bvh2, AccelKind::Bvh8f];
    let others = better.map(|kind| Build { kind, quality: Quality::High, cached: false });
    let fast = Build { kind: AccelKind::Bvh2, quality: Quality::Fast, cached: false };
    let kinds = AccelKind::ALL.map(Build::from).into_iter().chain(others).chain([fast]);
    kinds.map(|what| Accel::build(what, triangles.to_vec()).expect("few triangles")).collect()
}

/// The CPU, and the device that `RAYWARP_TEST_DEVICE` names.
pub fn devices() -> Vec<Device> {
    let named = std::env::var("RAYWARP_TEST_DEVICE").ok();
    let choices =
        [Some(DeviceChoice::Cpu), named.map(|name| name.parse().expect("RAYWARP_TEST_DEVICE names a device"))];
    choices.into_iter().flatten().map(|choice| Device::open(choice).expect("the device under test opens")).collect()
}

/// The structures that a device has kernels for.
pub fn kinds_on(device: &Device) -> Vec<AccelKind> {
    AccelKind::ALL.into_iter().filter(|&kind| !device.is_cuda() || kind != AccelKind::Bvh8f).collect()
}
