//! Path tracing against Mitsuba 3: each pixel and channel within what chance explains (a Z-test with Sidak's correction, by the rule
//! of Mitsuba's own tests). `references/make.py` makes the means and variances, of the same scenes.

use std::f32::consts::{PI, TAU};
use std::io::Cursor;
use std::sync::Arc;

use exr::prelude::{read, ReadChannels, ReadLayers};
use raywarp::accel::AccelKind;
use raywarp::render::{Integrator, RenderOptions, Tracer};
use raywarp::scene::{
    Background, Camera, Environment, Instance, Light, LightKind, Material, Mesh, MetallicRoughness, Projection,
    Radiance, Scene, Transform,
};

use crate::common::devices;

const SIDE: u32 = 32;

/// As many as the references have, or so.
const SAMPLES: u32 = 1024;

/// Samples of the references.
const REFERENCE_SAMPLES: f64 = 8192.0;

const FLOOR: [f32; 3] = [0.7, 0.5, 0.3];
const BOX: [f32; 3] = [0.3, 0.6, 0.8];

fn matt(diffuse: [f32; 3]) -> Material {
    Material { diffuse, ..Material::default() }
}

fn gltf(base_color: [f32; 3], metallic: f32, roughness: f32) -> Material {
    let own = MetallicRoughness { base_color, metallic, roughness, ..MetallicRoughness::default() };
    Material { metallic_roughness: Some(own), ..Material::default() }
}

fn glass(roughness: f32) -> Material {
    let own = MetallicRoughness { transmission: 1.0, thin: false, roughness, ..MetallicRoughness::default() };
    Material { metallic_roughness: Some(own), ..Material::default() }
}

fn lamp(radiance: f32) -> Material {
    Material { emission: [radiance; 3], ..matt([0.0; 3]) }
}

/// A square of half width 1 in the plane y = 0, whose outside is below.
fn square() -> Mesh {
    Mesh {
        positions: vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        materials: vec![0; 2],
        ..Mesh::default()
    }
}

/// A cube of half width 1, whose outside is without.
fn cube() -> Mesh {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| bit as f32 * 2.0 - 1.0);
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let materials = vec![0; triangles.len()];
    Mesh { positions: (0..8).map(corner).collect(), triangles, materials, ..Mesh::default() }
}

fn instance(mesh: usize, material: u32, transform: Transform) -> Instance {
    Instance { name: String::new(), mesh, transform, material: Some(material) }
}

fn scaled(scale: [f32; 3], translation: [f32; 3]) -> Transform {
    let [x, y, z] = scale;
    Transform { columns: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], translation }
}

/// A box on a floor, a lamp above them if there is one.
fn scene(floor: Material, cube_of: Material, above: Option<Material>) -> Scene {
    let (sine, cosine) = (PI / 6.0).sin_cos();
    let turned = Transform {
        columns: [[0.5 * cosine, 0.0, -0.5 * sine], [0.0, 0.5, 0.0], [0.5 * sine, 0.0, 0.5 * cosine]],
        translation: [-0.4, 0.55, 0.2],
    };
    let mut instances = vec![instance(0, 0, scaled([2.0, 1.0, 2.0], [0.0; 3])), instance(1, 1, turned)];
    if above.is_some() {
        instances.push(instance(0, 2, scaled([0.6, 1.0, 0.6], [0.0, 2.5, 0.0])));
    }
    Scene {
        meshes: vec![square(), cube()],
        instances,
        materials: [floor, cube_of].into_iter().chain(above).collect(),
        // The renderer would light a scene without lights by itself.
        lights: vec![Light { color: [0.0; 3], ..Light::default() }],
        background: Some(Background::constant([0.0; 3])),
        ..Scene::default()
    }
}

fn small_lights(scene: Scene) -> Scene {
    // Of 4 watts a steradian and 2 watts a square unit.
    let kind = LightKind::Point { position: [1.0, 2.0, 1.5] };
    let point = Light { kind, color: [4.0 / PI; 3], attenuation: [0.0, 0.0, 1.0], ..Light::default() };
    let kind = LightKind::Directional { direction: [-0.3, -1.0, -0.2] };
    let sun = Light { kind, color: [2.0 / PI; 3], ..Light::default() };
    Scene { lights: vec![point, sun], ..scene }
}

fn under_sky(scene: Scene) -> Scene {
    let (width, height) = (512, 256);
    let texel = |i: u32| {
        let (polar, angle) =
            (((i / width) as f32 + 0.5) / height as f32 * PI, (((i % width) as f32 + 0.5) / width as f32 - 0.5) * TAU);
        let (x, y, z) = (polar.sin() * angle.cos(), polar.cos(), polar.sin() * angle.sin());
        let spot = (8.0 * (0.48 * x + 0.6 * y + 0.64 * z - 1.0)).exp();
        [0.3 + 0.2 * y + 6.0 * spot, 0.4 + 0.2 * y + 5.0 * spot, 0.6 + 0.2 * y + 3.0 * spot]
    };
    let texels = (0..width * height).map(texel).collect();
    let picture = Arc::new(Radiance { name: "sky".into(), width, height, texels });
    Scene { environment: Some(Environment { picture, rotation: 0.0, strength: 1.0 }), ..scene }
}

/// Mean and variance of a sample, channel by channel of each pixel.
fn reference(bytes: &[u8]) -> Vec<[[f64; 2]; 3]> {
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let layer = reader.from_buffered(Cursor::new(bytes)).unwrap().layer_data;
    let channel = |name: &str| -> Vec<f64> {
        let found = layer.channel_data.list.iter().find(|channel| channel.name.eq(name)).unwrap();
        found.sample_data.values_as_f32().map(f64::from).collect()
    };
    let [means, variances] = [["R", "G", "B"], ["vR", "vG", "vB"]].map(|names| names.map(channel));
    (0..means[0].len()).map(|i| [0, 1, 2].map(|c| [means[c][i], variances[c][i]])).collect()
}

/// Probability that a normal deviate is farther from 0 than this (Abramowitz and Stegun 7.1.26).
fn two_sided(z: f64) -> f64 {
    let x = z.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let series = [1.061_405_429, -1.453_152_027, 1.421_413_741, -0.284_496_736, 0.254_829_592];
    series.iter().fold(0.0, |sum, c| (sum + c) * t) * (-x * x).exp()
}

#[track_caller]
fn compare(name: &str, scene: &Scene, bytes: &[u8]) {
    let camera = Camera {
        name: String::new(),
        eye: [3.0, 2.2, 3.5],
        target: [0.0, 0.5, 0.0],
        up: [0.0, 1.0, 0.0],
        projection: Projection::Perspective { fov_y: 40f32.to_radians() },
    };
    let tracer = Tracer::new(scene, AccelKind::Bvh, devices().last().unwrap()).unwrap();
    let options = RenderOptions {
        size: [SIDE; 2],
        spp: SAMPLES,
        max_depth: 3,
        integrator: Integrator::Path,
        ..RenderOptions::default()
    };
    let found = tracer.render(&camera, &options, &mut |_| ()).unwrap().picture.pixels;
    let expected = reference(bytes);
    assert_eq!(found.len(), expected.len());
    let tests = 3.0 * found.len() as f64;
    let significance = 1.0 - 0.99f64.powf(1.0 / tests);
    let (mut failed, mut sums) = (0, [0.0; 2]);
    for (pixel, channels) in found.iter().zip(&expected) {
        for (value, [mean, variance]) in pixel.iter().zip(channels) {
            let spread = variance.max(1e-4) * (1.0 / f64::from(SAMPLES) + 1.0 / REFERENCE_SAMPLES);
            failed += u32::from(two_sided((f64::from(*value) - mean) / spread.sqrt()) < significance);
            sums = [sums[0] + f64::from(*value), sums[1] + mean];
        }
    }
    let ratio = sums[0] / sums[1];
    println!("{name}: {failed} of {tests} differ, {ratio:.4} as bright");
    assert!(f64::from(failed) <= 0.0025 * tests, "{name}: {failed} of {tests} differ, {ratio:.4} as bright");
    assert!((ratio - 1.0).abs() < 0.01, "{name}: {ratio:.4} as bright");
}

macro_rules! references {
    ($($name:ident: $scene:expr;)*) => {$(
        #[test]
        fn $name() {
            compare(stringify!($name), &$scene, include_bytes!(concat!("references/", stringify!($name), ".exr")));
        }
    )*};
}

references! {
    all_matt: scene(matt(FLOOR), matt(BOX), Some(lamp(8.0)));
    metal: scene(matt(FLOOR), gltf(BOX, 1.0, 0.4), Some(lamp(8.0)));
    dielectric: scene(gltf(FLOOR, 0.0, 0.3), gltf(BOX, 0.0, 0.6), Some(lamp(8.0)));
    mixed: scene(gltf(FLOOR, 0.5, 0.5), gltf(BOX, 0.25, 0.8), Some(lamp(8.0)));
    rough_glass: scene(matt(FLOOR), glass(0.5), Some(lamp(8.0)));
    clear_glass: scene(matt(FLOOR), glass(0.0), Some(lamp(8.0)));
    point_and_sun: small_lights(scene(gltf(FLOOR, 0.0, 0.5), gltf(BOX, 1.0, 0.6), None));
    sky: under_sky(scene(matt(FLOOR), gltf(BOX, 1.0, 0.3), None));
    sky_and_lamp: under_sky(scene(gltf(FLOOR, 0.0, 0.4), matt(BOX), Some(lamp(4.0))));
}
