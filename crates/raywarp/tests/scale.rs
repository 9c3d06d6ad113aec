//! Shading where surfaces are much larger than what happens on them: nothing near a surface is lost to its size.

use raywarp::accel::AccelKind;
use raywarp::backend::{Device, DeviceChoice};
use raywarp::render::{RenderOptions, Tracer};
use raywarp::scene::{
    Background, Camera, Instance, Light, LightKind, Material, Mesh, Projection, RenderDefaults, Scene, Transform,
};

/// A square with y as its normal.
fn square(y: f32, half: f32, material: u32) -> Mesh {
    Mesh {
        positions: vec![[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        materials: vec![material; 2],
        ..Mesh::default()
    }
}

fn scene(meshes: Vec<Mesh>, materials: Vec<Material>) -> Scene {
    let place = |mesh| Instance { name: String::new(), mesh, transform: Transform::IDENTITY, material: None };
    Scene {
        instances: (0..meshes.len()).map(place).collect(),
        meshes,
        materials,
        lights: vec![Light { kind: LightKind::Directional { direction: [0.0, -1.0, 0.0] }, ..Light::default() }],
        background: Some(Background::constant([0.0; 3])),
        ambient: Some([0.0; 3]),
        render: RenderDefaults::default(),
        ..Scene::default()
    }
}

fn device() -> Device {
    let name = std::env::var("RAYWARP_TEST_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    Device::open(name.parse::<DeviceChoice>().unwrap()).unwrap()
}

fn matt(diffuse: f32) -> Material {
    Material { ambient: [0.0; 3], diffuse: [diffuse; 3], ..Material::default() }
}

/// Red of each pixel that looks from `eye` at `target`.
fn seen(scene: &Scene, eye: [f32; 3], target: [f32; 3], fov_y: f32) -> Vec<f32> {
    let camera =
        Camera { name: "eye".into(), eye, target, up: [0.0, 0.0, -1.0], projection: Projection::Perspective { fov_y } };
    let tracer = Tracer::new(scene, AccelKind::Bvh, &device()).unwrap();
    let options = RenderOptions { size: [32, 18], ..RenderOptions::default() };
    let picture = tracer.render(&camera, &options, &mut |_| ()).unwrap().picture;
    picture.pixels.iter().map(|[r, ..]| *r).collect()
}

#[test]
fn a_plate_close_above_a_floor_of_any_size_casts_its_shadow() {
    for exponent in -6..=6 {
        let size = 10f32.powi(exponent);
        for ratio in [1.0, 1e-2, 1e-4, 1e-6] {
            let (plate, gap) = (size * ratio, size * ratio * 0.1);
            let mut scene = scene(vec![square(0.0, size, 0), square(gap, plate, 0)], vec![matt(1.0)]);
            // Seen from under the plate, from a quarter of its height to its middle.
            let shadow = seen(&scene, [0.0, gap * 0.25, 0.0], [gap, 0.0, 0.0], 0.2);
            assert!(shadow.iter().all(|&r| r == 0.0), "floor {size}, plate {plate}: {shadow:?}");
            scene.instances.pop();
            let lit = seen(&scene, [0.0, gap * 0.25, 0.0], [gap, 0.0, 0.0], 0.2);
            assert!(lit.iter().all(|&r| r > 0.99), "floor {size}: {lit:?}");
        }
    }
}

#[test]
fn a_mirror_of_any_size_shows_what_is_close_above_it() {
    let glow = Material { emission: [1.0; 3], unlit: false, ..matt(0.0) };
    let mirror = Material { reflection: [1.0; 3], ..matt(0.0) };
    for exponent in -6..=6 {
        let size = 10f32.powi(exponent);
        for ratio in [1.0, 1e-3, 1e-6] {
            let (plate, gap) = (size * ratio, size * ratio * 0.01);
            let scene = scene(vec![square(0.0, size, 0), square(gap, plate, 1)], vec![mirror.clone(), glow.clone()]);
            let mirrored = seen(&scene, [0.0, gap * 0.5, 0.0], [gap, 0.0, 0.0], 0.2);
            assert!(mirrored.iter().all(|&r| r > 0.99), "mirror {size}, plate {plate}: {mirrored:?}");
        }
    }
}

#[test]
fn a_decal_just_above_a_large_floor_covers_it_without_speckles() {
    for exponent in 2..=6 {
        let scene = scene(
            vec![square(0.0, 10f32.powi(exponent), 0), square(0.01, 1.0, 1), square(-0.01, 1.0, 1)],
            vec![matt(0.25), matt(1.0)],
        );
        let (above, beside) = ([0.5, 1.5, 4.0], [0.0, 0.01, 0.0]);
        let decal = seen(&scene, above, beside, 0.04);
        assert!(decal.iter().all(|&r| (r - 1.0).abs() < 1e-3), "10^{exponent}: {decal:?}");
        // The one below the floor is hidden.
        let mut hidden = scene.clone();
        hidden.instances.remove(1);
        let floor = seen(&hidden, above, beside, 0.04);
        assert!(floor.iter().all(|&r| (r - 0.25).abs() < 1e-3), "10^{exponent}: {floor:?}");
    }
}

#[test]
fn walls_of_any_tilt_do_not_shade_themselves() {
    for tilt in [1e-4f32, 0.01, 0.3, 0.8, 1.3] {
        let (sin, cos) = tilt.sin_cos();
        for size in [1e-3, 1.0, 100.0, 1e4] {
            let mut mesh = square(0.0, size, 0);
            mesh.positions.iter_mut().for_each(|[x, y, _]| (*x, *y) = (*x * cos, *x * sin));
            let scene = scene(vec![mesh], vec![matt(1.0)]);
            let height = size * 0.1;
            let lit = seen(&scene, [0.0, height, 0.0], [0.0; 3], 0.1);
            assert!(lit.iter().all(|&r| (r - cos).abs() < 1e-3), "tilt {tilt}, size {size}: {lit:?}");
        }
    }
}

#[test]
fn glass_at_the_limit_of_depth_shows_the_surroundings_and_not_black() {
    let glass = Material { transmission: [1.0; 3], ior: 1.5, fresnel: true, ..matt(0.0) };
    let mut scene = scene(vec![square(0.0, 1.0, 0), square(-0.1, 1.0, 0)], vec![glass]);
    scene.background = Some(Background::constant([0.5; 3]));
    for depth in 0..3 {
        let camera = Camera {
            name: String::new(),
            eye: [0.0, 1.0, 0.0],
            target: [0.0; 3],
            up: [0.0, 0.0, -1.0],
            projection: Projection::Perspective { fov_y: 0.1 },
        };
        let tracer = Tracer::new(&scene, AccelKind::Bvh, &device()).unwrap();
        let options = RenderOptions { size: [4, 4], max_depth: depth, ..RenderOptions::default() };
        let picture = tracer.render(&camera, &options, &mut |_| ()).unwrap().picture;
        for [r, ..] in picture.pixels {
            assert!((r - 0.5).abs() < 1e-5, "depth {depth}: {r}");
        }
    }
}
