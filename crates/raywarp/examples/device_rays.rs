//! Rays and hits that stay on the device, on two streams: one batch is traced while the next is made. With
//! `cargo run --release -p raywarp --example device_rays`.

use std::error::Error;

use raywarp::accel::AccelKind;
use raywarp::device::DeviceChoice;
use raywarp::query::device::{Any, Pending};
use raywarp::{Device, Ray, RayCaster, Vec3};

fn main() -> Result<(), Box<dyn Error>> {
    for (height, blocked) in blocked([0.0, 0.5, 1.0, 1.5], 100_000)? {
        println!("at height {height}: {:.1} % of the horizon is hidden", 100.0 * blocked);
    }
    Ok(())
}

/// The share of `rays` level rays from before the scene that anything stops, for each height.
pub fn blocked<const N: usize>(heights: [f32; N], rays: u32) -> Result<Vec<(f32, f64)>, Box<dyn Error>> {
    let scene = raywarp::scene::load::builtin()?.scene;
    let device = Device::open(DeviceChoice::Auto)?;
    let caster = RayCaster::from_scene(&scene, AccelKind::default(), &device)?;

    let streams = [device.stream()?, device.stream()?];
    let mut pending = Vec::new();
    for (height, stream) in heights.into_iter().zip(streams.iter().cycle()) {
        let around = device.upload(&horizon(height, rays))?;
        // The caster takes both buffers over, so nobody touches them meanwhile.
        pending.push((height, caster.trace_on(stream, around, Any::new(&device, rays)?)?));
    }
    pending.into_iter().map(|(height, batch)| Ok((height, share(batch)?))).collect()
}

/// Waits for a batch.
fn share(batch: Pending<Any>) -> Result<f64, Box<dyn Error>> {
    let blocked = batch.wait()?.answer.blocked.to_vec()?;
    Ok(blocked.iter().map(|&hit| f64::from(hit)).sum::<f64>() / blocked.len() as f64)
}

fn horizon(height: f32, rays: u32) -> Vec<Ray> {
    let angle = |i: u32| std::f32::consts::TAU * i as f32 / rays as f32;
    let ray = |i| Ray::new(Vec3::new(0.0, height, 3.0), Vec3::new(angle(i).cos(), 0.0, angle(i).sin()));
    (0..rays).map(ray).collect()
}
