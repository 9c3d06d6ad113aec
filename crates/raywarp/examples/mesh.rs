//! A mesh from arrays to a PNG: `cargo run --release -p raywarp --example mesh`, or with the file's name after `--`.

use std::error::Error;
use std::path::Path;

use raywarp::accel::AccelKind;
use raywarp::device::DeviceChoice;
use raywarp::image::{png, Development};
use raywarp::render::RenderOptions;
use raywarp::scene::{Instance, Material, Mesh, Transform};
use raywarp::{write, Device, Scene, Tracer};

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).unwrap_or("mesh.png".to_owned());
    render(&pyramid(), [640, 480], Path::new(&file))
}

/// A pyramid: five vertices, six triangles, one material.
pub fn pyramid() -> Scene {
    let mesh = Mesh {
        positions: vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0], [0.0, 1.5, 0.0]],
        // Counter-clockwise seen from outside.
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 3, 2], [0, 2, 1]],
        materials: vec![0; 6],
        ..Mesh::default()
    };
    let instance = Instance { name: "pyramid".to_owned(), mesh: 0, transform: Transform::IDENTITY, material: None };
    let material = Material { diffuse: [0.8, 0.5, 0.2], ambient: [0.8, 0.5, 0.2], ..Material::default() };
    Scene { meshes: vec![mesh], instances: vec![instance], materials: vec![material], ..Scene::default() }
}

/// Renders what the scene's own camera sees, or one that frames the scene. Without lights there is one at the camera.
pub fn render(scene: &Scene, size: [u32; 2], file: &Path) -> Result<(), Box<dyn Error>> {
    let device = Device::open(DeviceChoice::Auto)?;
    let tracer = Tracer::new(scene, AccelKind::default(), &device)?;
    let options = RenderOptions { size, spp: 16, ..RenderOptions::default() };
    let rendering = tracer.render(tracer.default_camera(), &options, &mut |_| ())?;
    let pixels = png::tone_map(&rendering.picture, &Development::default());
    Ok(write::file(file, &png::encode(&pixels)?)?)
}
