//! A thousand instances of a mesh that move: `cargo run --release -p raywarp --example moving_instances` traces sixty frames,
//! tells how long a frame took and what of it was moving, and writes the last, `instances.png`, into a folder if one is named
//! after `--`, and of another number of instances if that follows. Each mesh has its tree; a move is a transform, and the tree over the instances is made anew.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use raywarp::accel::AccelKind;
use raywarp::device::DeviceChoice;
use raywarp::device_scene::Levels;
use raywarp::image::{png, Development};
use raywarp::render::RenderOptions;
use raywarp::scene::{Instance, Material, Mesh, Scene, Transform};
use raywarp::{write, Device, DeviceScene, Tracer};

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let folder = words.next().unwrap_or(".".to_owned());
    let count = words.next().map_or(Ok(1000), |word| word.parse())?;
    let [moving, all] = animate(count, 60, [960, 540], &Path::new(&folder).join("instances.png"))?;
    let [moving, all] = [moving, all].map(|time| time.as_secs_f64() * 1e3);
    println!("{count} instances: {all:.2} ms a frame, {moving:.2} ms of them to move the instances");
    Ok(())
}

/// Moves so many instances from frame to frame. How long moving took, and a frame as a whole, in the mean.
pub fn animate(count: usize, frames: u32, size: [u32; 2], last: &Path) -> Result<[Duration; 2], Box<dyn Error>> {
    let device = Device::open(DeviceChoice::Auto)?;
    let scene = DeviceScene::with_levels(&scene(count), Levels::Two, AccelKind::default(), &device)?;
    let mut tracer = Tracer::of_scene(Arc::new(scene))?;
    let options = RenderOptions { size, spp: 1, ..RenderOptions::default() };
    let camera = tracer.default_camera().clone();
    let (start, mut moving) = (Instant::now(), Duration::ZERO);
    for frame in 1..=frames {
        let begun = Instant::now();
        let transforms: Vec<_> = (0..count).map(|index| place(index, count, frame as f32 * 0.05)).collect();
        let moves: Vec<_> = transforms.iter().enumerate().collect();
        let moved = tracer.scene_mut()?.set_transforms(&moves)?;
        assert!(moved, "what is turned and shifted can be inverted");
        moving += begun.elapsed();
        let rendering = tracer.render(&camera, &options, &mut |_| ())?;
        if frame == frames {
            let pixels = png::tone_map(&rendering.picture, &Development::default());
            write::file(last, &png::encode(&pixels)?)?;
        }
    }
    Ok([moving / frames, start.elapsed() / frames])
}

/// Octahedra of three materials.
fn scene(count: usize) -> Scene {
    let tip = |axis: usize, sign: f32| [0, 1, 2].map(|i| if i == axis { sign } else { 0.0 });
    let octahedron = Mesh {
        positions: vec![tip(0, 1.0), tip(0, -1.0), tip(1, 1.0), tip(1, -1.0), tip(2, 1.0), tip(2, -1.0)],
        triangles: vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
        materials: vec![0; 8],
        ..Mesh::default()
    };
    let colors = [[0.8, 0.3, 0.2], [0.2, 0.6, 0.8], [0.9, 0.8, 0.3]];
    let materials = colors.map(|diffuse| Material { diffuse, ..Material::default() });
    let instance = |index: usize| Instance {
        name: format!("octahedron {index}"),
        mesh: 0,
        transform: place(index, count, 0.0),
        material: Some(index as u32 % 3),
    };
    Scene {
        meshes: vec![octahedron],
        instances: (0..count).map(instance).collect(),
        materials: materials.to_vec(),
        ..Scene::default()
    }
}

/// On a spiral, each turning about an axis of its own.
fn place(index: usize, count: usize, time: f32) -> Transform {
    let share = index as f32 / count as f32;
    let (sin, cos) = (time + share * 40.0).sin_cos();
    let (turn, tilt) = ((3.0 * time + index as f32).sin_cos(), (share * 7.0).sin_cos());
    let columns = [
        [turn.1, 0.0, -turn.0],
        [tilt.0 * turn.0, tilt.1, tilt.0 * turn.1],
        [tilt.1 * turn.0, -tilt.0, tilt.1 * turn.1],
    ];
    Transform { columns, translation: [30.0 * share * cos, 10.0 * (time + 9.0 * share).sin(), 30.0 * share * sin] }
}
