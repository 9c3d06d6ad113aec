//! How the time to build a tree grows.

use raywarp::accel::Quality;
use raywarp::{Triangle, Vec3};
use raywarp_lab::structures::{Build, StructureKind, Tree};

use super::structures::name;
use super::Setting;
use crate::study::findings::Growth;
use raywarp_cli::failure::Result;
use raywarp_cli::messages;

/// Builders.
const BUILDS: [(StructureKind, Quality); 5] = [
    (StructureKind::KD, Quality::Medium),
    (StructureKind::KdSah, Quality::Medium),
    (StructureKind::BVH2, Quality::Fast),
    (StructureKind::BVH2, Quality::Medium),
    (StructureKind::BVH2, Quality::High),
];

/// Seconds after which a build is not repeated.
const ENOUGH: f64 = 0.3;

/// Times every builder on triangles strewn evenly in a cube, as large as the space for each: by thousands and their
/// multiples by the root of ten.
pub fn growth(setting: &Setting) -> Result<Vec<Growth>> {
    let mut rows = Vec::new();
    let steps = if setting.quick { 4 } else { 7 };
    for step in 0..steps {
        let count = (1e3 * 10f64.powf(f64::from(step) / 2.0)).round() as u32;
        messages::line(&format!("building trees over {count} triangles ..."));
        let triangles = strewn(count);
        for (kind, quality) in BUILDS {
            let build = Build { kind, quality };
            // The least of several: other work on the machine only adds.
            let (mut seconds, mut spent) = (f64::INFINITY, 0.0);
            while spent < ENOUGH {
                let once = Tree::build(build, triangles.clone())?.stats().build_seconds;
                (seconds, spent) = (seconds.min(once), spent + once.max(1e-6));
            }
            rows.push(Growth { builder: name(build).to_owned(), triangles: count as usize, seconds });
        }
    }
    Ok(rows)
}

fn strewn(count: u32) -> Vec<Triangle> {
    let edge = 1.0 / f64::from(count).cbrt() as f32;
    let number =
        |key: u32| (key.wrapping_mul(0x9e37_79b9).rotate_left(13).wrapping_mul(0x85eb_ca6b) >> 8) as f32 / 16_777_216.0;
    let point = |key: u32| Vec3::new(number(key), number(key + 1), number(key + 2));
    let triangle = |index: u32| {
        let (key, offset) = (12 * index, Vec3::splat(-0.5));
        let corner = |i: u32| (point(key + 3 + 3 * i) + offset) * edge + point(key);
        Triangle::new(corner(0), corner(1), corner(2), index, 0)
    };
    (0..count).map(triangle).collect()
}
