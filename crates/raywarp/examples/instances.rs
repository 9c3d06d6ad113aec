//! A thousand placements of a mesh of a million triangles: `cargo run --release --example instances -p raywarp`, with
//! other numbers as `-- INSTANCES TRIANGLES`. Prints what it takes and how fast it is traced; on a GPU where there is one.

use std::time::Instant;

use raywarp::accel::two_level::{build, Placement};
use raywarp::accel::Quality;
use raywarp::device::{Device, DeviceChoice};
use raywarp::device_scene::Structure;
use raywarp::query::RayCaster;
use raywarp::scene::Transform;
use raywarp::{Ray, Triangle, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u32>());
    let mut number = |default| numbers.next().unwrap_or(Ok(default));
    let (instances, triangles) = (number(1000)?, number(1_000_000)?);

    let mesh = rock((f64::from(triangles) / 4.0).sqrt() as u32 + 1);
    let count = mesh.len() as u32;
    let side = f64::from(instances).cbrt().ceil() as u32;
    let placements: Vec<_> = (0..instances).map(|i| place(i, side)).collect();
    let tree = build(vec![mesh], &placements, Quality::default())?;
    let stats = tree.stats();
    let mega = |bytes: usize| bytes as f64 / 1e6;
    println!("{} instances of {count} triangles: {} triangles seen", stats.instances, stats.seen);
    println!("built in {:.2} s, {:.1} MB", stats.build_seconds, mega(stats.bytes));
    println!("(triangles of the same scene without instances, alone: {:.0} MB)", mega(48) * stats.seen as f64);

    let device = Device::open(DeviceChoice::Auto)?;
    let caster = RayCaster::of_structure(Structure::of_instances(&tree, &device)?, &device);
    println!("on {}", device.description());
    let rays = rays(side, if device.is_cuda() { 4000 } else { 1000 });
    for _ in 0..3 {
        let start = Instant::now();
        let hits = caster.hits(&rays)?;
        let seconds = start.elapsed().as_secs_f64();
        let found = hits.iter().filter(|hit| !hit.is_miss()).count();
        let rate = rays.len() as f64 / seconds / 1e6;
        println!("closest: {} rays, {found} hits, {seconds:.3} s, {rate:.2} million rays/s", rays.len());
    }
    Ok(())
}

/// A dented sphere of `rings` rings, each of twice as many columns, two triangles a patch.
fn rock(rings: u32) -> Vec<Triangle> {
    let columns = 2 * rings;
    let corner = |row: u32, column: u32| {
        let theta = std::f32::consts::PI * row as f32 / rings as f32;
        let phi = std::f32::consts::TAU * (column % columns) as f32 / columns as f32;
        let dent =
            1.0 + 0.1 * (7.0 * theta).sin() * (5.0 * phi).sin() + 0.01 * (90.0 * theta).sin() * (80.0 * phi).sin();
        Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()) * dent
    };
    let patches = (0..rings).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles = patches.flat_map(|(row, column)| {
        let [a, b] = [corner(row, column), corner(row, column + 1)];
        let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
        [[a, b, c], [b, d, c]]
    });
    triangles.zip(0..).map(|([a, b, c], primitive)| Triangle::new(a, b, c, primitive, 0)).collect()
}

/// In a cube of `side` a side, each turned and stretched in its own way.
fn place(index: u32, side: u32) -> Placement {
    let at = [index % side, index / side % side, index / side / side];
    let (sin, cos) = (index as f32).sin_cos();
    let stretch = 0.6 + 0.3 * (index as f32 * 0.7).cos();
    let columns = [[cos, 0.0, -sin], [0.3 * sin, stretch, 0.0], [sin, 0.0, cos]];
    let transform = Transform { columns, translation: at.map(|x| 3.0 * x as f32) };
    Placement { mesh: 0, transform, instance: index, flags: None }
}

/// A square of `side` by `side` rays from outside at the cube.
fn rays(cube: u32, side: u32) -> Vec<Ray> {
    let size = 3.0 * cube as f32;
    let eye = Vec3::new(-1.1 * size, 1.4 * size, -0.9 * size);
    let ray = |i: u32| {
        let [x, y] = [i % side, i / side].map(|k| (k as f32 + 0.5) / side as f32);
        Ray::new(eye, Vec3::new(size * x, size * y, size * (1.0 - x)) - eye)
    };
    // In tiles of 8 by 4, as neighbours meet the same nodes.
    let tiled = |k: u32| (k / 32 % (side / 8) * 8 + k % 8) + (k / 32 / (side / 8) * 4 + k % 32 / 8) * side;
    (0..side * side).map(|k| ray(tiled(k))).collect()
}
