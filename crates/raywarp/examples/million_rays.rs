//! What a million rays hit, without a picture: `cargo run --release -p raywarp --example million_rays`.

use std::error::Error;
use std::time::Instant;

use raywarp::accel::AccelKind;
use raywarp::device::DeviceChoice;
use raywarp::{Device, Ray, RayCaster, Vec3};

fn main() -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let hits = hits(1000)?;
    println!("{hits} of a million rays hit something; with all that comes before, in {:.2?}", start.elapsed());
    Ok(())
}

/// How many of `side` by `side` rays from above hit the scene that is built in.
pub fn hits(side: u32) -> Result<usize, Box<dyn Error>> {
    let scene = raywarp::scene::load::builtin()?.scene;
    let device = Device::open(DeviceChoice::Auto)?;
    let caster = RayCaster::from_scene(&scene, AccelKind::default(), &device)?;
    let hits = caster.closest(&rays(side))?;
    // One item a ray; a miss is infinitely far.
    Ok(hits.t.iter().filter(|t| t.is_finite()).count())
}

/// Downwards, from a square of 4 by 4 above the origin.
fn rays(side: u32) -> Vec<Ray> {
    let place = |k: u32| 4.0 * (k as f32 + 0.5) / side as f32 - 2.0;
    let from = |i: u32| Vec3::new(place(i % side), 5.0, place(i / side));
    (0..side * side).map(|i| Ray::new(from(i), Vec3::new(0.0, -1.0, 0.0))).collect()
}
