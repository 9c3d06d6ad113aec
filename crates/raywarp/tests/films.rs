//! A picture that grows, and a scene that changes, on every device: the same bits as a picture at once of a scene read
//! that way.

use std::f32::consts::TAU;

use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::device::{Device, Staging};
use raywarp::device_scene::{world_triangles, Structure};
use raywarp::image::{png, Development, ToneMap};
use raywarp::render::{Film, Quantity, RenderOptions, Tracer};
use raywarp::scene::{load, Light, LightKind, Scene, Transform};

use crate::common::devices;

const SIZE: [u32; 2] = [93, 71];

fn options() -> RenderOptions {
    RenderOptions { size: SIZE, spp: 5, max_depth: 3, ..RenderOptions::default() }
}

fn scene() -> Scene {
    load::builtin().unwrap().scene
}

fn bvh2(quality: Quality) -> Build {
    Build { kind: AccelKind::Bvh2, quality, cached: false }
}

/// The screen's bytes, as red, green, blue.
fn screen(device: &Device, film: &Film) -> Vec<[u8; 3]> {
    let mut staging = Staging::default();
    staging.fetch(device, film.screen()).unwrap();
    staging.iter().map(|pixel| pixel.to_le_bytes()).map(|[r, g, b, _]| [r, g, b]).collect()
}

fn exposed(device: &Device, tracer: &Tracer, seconds: f64) -> Film {
    let mut film = Film::new(device, SIZE).unwrap();
    let mut steps = 0;
    while !tracer.accumulate(&mut film, tracer.default_camera(), &options(), seconds).unwrap().complete {
        steps += 1;
        assert!(steps < 10_000);
    }
    film
}

fn rendered(tracer: &Tracer) -> raywarp::image::Picture {
    tracer.render(tracer.default_camera(), &options(), &mut |_| ()).unwrap().picture
}

#[test]
fn a_film_becomes_the_png_of_the_same_samples_in_steps_of_any_length() {
    for device in devices() {
        let tracer = Tracer::new(&scene(), bvh2(Quality::Fast), &device).unwrap();
        let picture = rendered(&tracer);
        for development in [
            Development::default(),
            Development { exposure: -0.7, tone_map: ToneMap::Filmic },
            Development { exposure: 3.0, tone_map: ToneMap::Clamp },
        ] {
            let expected = png::tone_map(&picture, &development).pixels;
            for seconds in [0.0, 1e-3, 10.0] {
                let mut film = exposed(&device, &tracer, seconds);
                assert_eq!(film.samples(), 5);
                film.tone_map_film(&development, None).unwrap();
                assert!(screen(&device, &film) == expected, "{seconds} s a step on {}", device.description());
            }
        }
    }
}

#[test]
fn before_its_first_sample_a_pixel_shows_the_film_below() {
    for device in devices() {
        let tracer = Tracer::new(&scene(), bvh2(Quality::Fast), &device).unwrap();
        let mut below = Film::new(&device, [9, 7]).unwrap();
        let options = RenderOptions { spp: 1, ..options() };
        while !tracer.accumulate(&mut below, tracer.default_camera(), &options, 1.0).unwrap().complete {}
        below.tone_map_film(&Development::default(), None).unwrap();
        let mut film = Film::new(&device, SIZE).unwrap();
        film.tone_map_film(&Development::default(), Some(&below)).unwrap();
        let (small, large) = (screen(&device, &below), screen(&device, &film));
        for (index, pixel) in large.iter().enumerate() {
            let (x, y) = (index as u32 % SIZE[0], index as u32 / SIZE[0]);
            let nearest = |i: u32, from: u32, to: u32| ((f64::from(i) + 0.5) * f64::from(to) / f64::from(from)) as u32;
            let source = nearest(y, SIZE[1], 7) * 9 + nearest(x, SIZE[0], 9);
            assert_eq!(*pixel, small[source as usize], "{x}, {y}");
        }
        // One step exposes rows from the top; the others stay as they were.
        let mut part = Film::new(&device, SIZE).unwrap();
        part.learn(1.0);
        tracer.accumulate(&mut part, tracer.default_camera(), &options, 1e-9).unwrap();
        part.tone_map_film(&Development::default(), Some(&below)).unwrap();
        let rows = 16 * SIZE[0] as usize;
        assert!(screen(&device, &part)[rows..] == large[rows..]);
        assert!(screen(&device, &part)[..rows] != large[..rows]);
    }
}

#[test]
fn an_instance_that_moves_looks_as_if_it_had_been_there() {
    for device in devices() {
        for (kind, quality) in
            [(AccelKind::Bvh2, Quality::Fast), (AccelKind::Bvh, Quality::Fast), (AccelKind::Bvh, Quality::High)]
        {
            let original = scene();
            let what = Build { kind, quality, cached: false };
            let mut tracer = Tracer::new(&original, what, &device).unwrap();
            let mut moved = original.clone();
            for step in 0..4 {
                for index in (0..moved.instances.len()).rev().take(2) {
                    let (sine, cosine) = (TAU * (step + index) as f32 / 7.0).sin_cos();
                    moved.instances[index].transform = Transform {
                        columns: [[cosine, 0.0, -sine], [0.0, 0.8, 0.0], [sine, 0.0, cosine]],
                        translation: [0.1 * step as f32, 0.05, -0.2 * sine],
                    };
                    assert!(tracer.scene_mut().unwrap().move_instances(&original, &moved.instances, &[index]).unwrap());
                }
                let fresh = Tracer::new(&moved, what, &device).unwrap();
                assert!(rendered(&tracer) == rendered(&fresh), "{kind}, step {step} on {}", device.description());
                let growth = tracer.scene().growth().unwrap();
                assert!(growth.is_some_and(|growth| growth > 0.1 && growth < 10.0), "{growth:?}");
            }
            // A new tree of what moved, swapped in.
            let triangles = world_triangles(&original, &moved.instances, &moved.materials).unwrap();
            let before = rendered(&tracer);
            for kind in [AccelKind::Bvh2, AccelKind::Kd] {
                tracer.scene_mut().unwrap().replace(Structure::build(&device, kind, triangles.clone()).unwrap());
                assert!(rendered(&tracer) == before);
                let follows = tracer.scene_mut().unwrap().move_instances(&original, &moved.instances, &[0]).unwrap();
                assert_eq!(follows, kind.is_hierarchy(), "a k-d tree's cells cannot follow");
            }
        }
    }
}

#[test]
fn a_mirrored_instance_looks_as_if_it_had_been_there() {
    let mut original = scene();
    let device = devices().remove(0);
    let mut tracer = Tracer::new(&original, bvh2(Quality::Fast), &device).unwrap();
    let mut instances = original.instances.clone();
    instances[0].transform.columns[0] = instances[0].transform.columns[0].map(|x| -x);
    assert!(tracer.scene_mut().unwrap().move_instances(&original, &instances, &[0]).unwrap());
    original.instances.clone_from(&instances);
    let fresh = Tracer::new(&original, bvh2(Quality::Fast), &device).unwrap();
    let [moved, fresh] =
        [&tracer, &fresh].map(|t| t.render(tracer.default_camera(), &options(), &mut |_| ()).unwrap().picture);
    assert!(moved == fresh);
    assert!(tracer.scene_mut().unwrap().move_instances(&original, &instances, &[instances.len()]).is_err());
}

#[test]
fn changed_lights_and_materials_look_as_if_they_had_been_read() {
    for device in devices() {
        let mut scene = scene();
        let mut tracer = Tracer::new(&scene, bvh2(Quality::Fast), &device).unwrap();
        scene.lights.push(Light {
            kind: LightKind::Point { position: [0.0, 0.5, 0.5] },
            color: [0.2, 0.4, 0.1],
            ..Light::default()
        });
        assert!(tracer.scene_mut().unwrap().set_lights(&scene));
        scene.ambient = None;
        assert!(
            !tracer.scene_mut().unwrap().set_lights(&scene),
            "materials reflect the built-in light by another colour"
        );
        for (index, material) in scene.materials.iter_mut().enumerate() {
            material.diffuse = [0.1 * index as f32, 0.5, 0.3];
            // The structure knows which triangles let light through.
            material.transmission = if index % 2 == 0 { [0.3; 3] } else { [0.0; 3] };
        }
        assert!(tracer.scene_mut().unwrap().set_materials(&scene.materials, &scene.images).unwrap());
        let fresh = Tracer::new(&scene, bvh2(Quality::Fast), &device).unwrap();
        assert!(rendered(&tracer) == rendered(&fresh), "{}", device.description());
        assert!(tracer.scene_mut().unwrap().set_materials(&scene.materials[1..], &scene.images).is_err());
    }
}

#[test]
fn painted_quantities_are_those_of_the_layers_and_counts() {
    use raywarp::image::{false_color, Layer, Layers};
    for device in devices() {
        let tracer = Tracer::new(&scene(), bvh2(Quality::Fast), &device).unwrap();
        let camera = tracer.default_camera();
        let options = RenderOptions { count_tests: true, spp: 1, ..options() };
        let first_hits = tracer.layers(camera, &options).unwrap();
        let tests = tracer.render(camera, &options, &mut |_| ()).unwrap().tests;
        let layers = Layers { width: SIZE[0], height: SIZE[1], first_hits, tests };
        let mut film = Film::new(&device, SIZE).unwrap();
        for (quantity, layer) in [
            (Quantity::Normal, Layer::Normal),
            (Quantity::Depth, Layer::Depth),
            (Quantity::Albedo, Layer::Albedo),
            (Quantity::Primitive, Layer::Primitive),
            (Quantity::Material, Layer::Material),
            (Quantity::Tests, Layer::Tests),
        ] {
            tracer.draw_aov(&mut film, camera, &options, quantity, None).unwrap();
            let pixels = false_color::draw(&layers, layer).unwrap().0.pixels;
            let count = (SIZE[0] * SIZE[1]) as usize;
            assert!(screen(&device, &film)[..] == pixels[..count], "{layer} on {}", device.description());
        }
        let painted = tracer.draw_aov(&mut film, camera, &options, Quantity::Ticks, None).unwrap();
        assert!(painted.range[1] > 0.0, "every thread takes time");
    }
}
