//! Prints a unit sphere as Wavefront OBJ: `cargo run --example sphere -p raywarp > sphere.obj`, or with a number of
//! segments around the equator, `-- 96`. This made `scenes/glass/sphere.obj`.

use std::f64::consts::PI;

fn main() {
    let segments: u32 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(64).clamp(4, 1000);
    let rings = segments / 2;
    println!("# A unit sphere of {segments} segments and {rings} rings, smooth.\no sphere\ns 1\nv 0 1 0");
    for ring in 1..rings {
        let (radius, height) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for segment in 0..segments {
            let (sin, cos) = (2.0 * PI * f64::from(segment) / f64::from(segments)).sin_cos();
            println!("v {:.6} {:.6} {:.6}", radius * sin, height, radius * cos);
        }
    }
    println!("v 0 -1 0");
    // Vertices count from 1, after the pole.
    let vertex = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
    let last = 2 + (rings - 1) * segments;
    for segment in 0..segments {
        println!("f 1 {} {}", vertex(1, segment), vertex(1, segment + 1));
        for ring in 1..rings - 1 {
            let (upper, lower) = (|s| vertex(ring, s), |s| vertex(ring + 1, s));
            println!("f {} {} {} {}", upper(segment), lower(segment), lower(segment + 1), upper(segment + 1));
        }
        println!("f {last} {} {}", vertex(rings - 1, segment + 1), vertex(rings - 1, segment));
    }
}
