//! Two cameras before one scene, which is on the device once: `cargo run --release -p raywarp --example two_cameras`
//! writes `left.png` and `right.png`, a pair for two eyes, into a folder if one is named after `--`.

use std::error::Error;
use std::path::Path;

use raywarp::accel::AccelKind;
use raywarp::device::DeviceChoice;
use raywarp::image::{png, Development};
use raywarp::render::RenderOptions;
use raywarp::scene::Camera;
use raywarp::{write, Device, Tracer};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or(".".to_owned());
    render([960, 540], Path::new(&folder))
}

/// Distance between the eyes, in scene units.
const EYES: f32 = 0.25;

/// Renders the scene that is built in from both.
pub fn render(size: [u32; 2], folder: &Path) -> Result<(), Box<dyn Error>> {
    let scene = raywarp::scene::load::builtin()?.scene;
    let device = Device::open(DeviceChoice::Auto)?;
    let tracer = Tracer::new(&scene, AccelKind::default(), &device)?;
    let options = RenderOptions { size, ..RenderOptions::default() };
    for (name, shift) in [("left.png", -EYES / 2.0), ("right.png", EYES / 2.0)] {
        let camera = sideways(tracer.default_camera(), shift);
        let rendering = tracer.render(&camera, &options, &mut |_| ())?;
        let pixels = png::tone_map(&rendering.picture, &Development::default());
        write::file(&folder.join(name), &png::encode(&pixels)?)?;
    }
    Ok(())
}

/// The camera looks along -z: so x is what is right of it. Both eyes see the same target in the middle.
fn sideways(camera: &Camera, shift: f32) -> Camera {
    let [x, y, z] = camera.eye;
    Camera { eye: [x + shift, y, z], ..camera.clone() }
}
