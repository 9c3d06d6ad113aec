//! Path tracing against numbers that are known: even light, closed boxes, form factors; and against itself.

use raywarp::accel::AccelKind;
use raywarp::device::Staging;
use raywarp::image::{png, Development};
use raywarp::render::{Film, Integrator, RenderOptions, Tracer};
use raywarp::scene::{
    AlphaMode, Background, Camera, Instance, Light, LightKind, Material, Mesh, MetallicRoughness, Projection, Scene,
    Transform,
};
use raywarp_core::wavefront::shade::strategy;

use crate::common::{devices, kinds_on};

/// A square of half width `half` at height `y`, whose outside is seen from above, or from below.
fn square(y: f32, half: f32, material: u32, up: bool) -> Mesh {
    let corners = if up { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
    Mesh {
        positions: vec![[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]],
        triangles: corners.to_vec(),
        materials: vec![material; 2],
        ..Mesh::default()
    }
}

/// A sphere of radius 1 about the origin.
fn sphere(material: u32) -> Mesh {
    let (columns, rows) = (48, 24);
    let point = |row: u32, column: u32| {
        let (polar, angle) =
            (row as f32 / rows as f32 * std::f32::consts::PI, column as f32 / columns as f32 * std::f32::consts::TAU);
        [polar.sin() * angle.cos(), polar.cos(), -polar.sin() * angle.sin()]
    };
    let positions: Vec<[f32; 3]> =
        (0..=rows).flat_map(|row| (0..columns).map(move |column| point(row, column))).collect();
    let corner = |row: u32, column: u32| row * columns + column % columns;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(r, c)| {
            let [a, b, c, d] = [corner(r, c), corner(r + 1, c), corner(r + 1, c + 1), corner(r, c + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let materials = vec![material; triangles.len()];
    Mesh { normals: positions.clone(), positions, triangles, materials, ..Mesh::default() }
}

/// A cube of half width 1 about the origin.
fn cube(material: u32) -> Mesh {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| bit as f32 * 2.0 - 1.0);
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let materials = vec![material; triangles.len()];
    Mesh { positions: (0..8).map(corner).collect(), triangles, materials, ..Mesh::default() }
}

fn matt(reflectance: f32) -> Material {
    Material { diffuse: [reflectance; 3], ..Material::default() }
}

fn of(own: MetallicRoughness) -> Material {
    Material { metallic_roughness: Some(own), ..matt(0.0) }
}

fn glowing(radiance: f32, reflectance: f32) -> Material {
    Material { emission: [radiance; 3], ..matt(reflectance) }
}

fn scene(meshes: Vec<Mesh>, materials: Vec<Material>, sky: f32) -> Scene {
    let place = |mesh| Instance { name: String::new(), mesh, transform: Transform::IDENTITY, material: None };
    Scene {
        instances: (0..meshes.len()).map(place).collect(),
        meshes,
        materials,
        // The renderer would light a scene without lights by itself.
        lights: vec![Light { color: [0.0; 3], ..Light::default() }],
        background: Some(Background::constant([sky; 3])),
        ..Scene::default()
    }
}

fn camera(eye: [f32; 3], fov_y: f32) -> Camera {
    let up = if eye[0] == 0.0 && eye[2] == 0.0 { [0.0, 0.0, -1.0] } else { [0.0, 1.0, 0.0] };
    Camera { name: String::new(), eye, target: [0.0; 3], up, projection: Projection::Perspective { fov_y } }
}

fn options(side: u32, spp: u32, max_depth: u32) -> RenderOptions {
    RenderOptions { size: [side; 2], spp, max_depth, integrator: Integrator::Path, ..RenderOptions::default() }
}

fn tracer(scene: &Scene) -> Tracer {
    Tracer::new(scene, AccelKind::Bvh, devices().last().unwrap()).unwrap()
}

fn pixels(tracer: &Tracer, camera: &Camera, options: &RenderOptions) -> Vec<[f32; 4]> {
    let rendering = tracer.render(camera, options, &mut |_| ()).unwrap();
    assert_eq!(rendering.non_finite, 0);
    rendering.picture.pixels
}

/// Mean of green over all pixels.
fn mean(pixels: &[[f32; 4]]) -> f64 {
    pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / pixels.len() as f64
}

fn seen(scene: &Scene, camera: &Camera, options: &RenderOptions) -> f64 {
    mean(&pixels(&tracer(scene), camera, options))
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.max(0.01), "{found}, not {expected}");
}

fn same_bits(a: &[[f32; 4]], b: &[[f32; 4]]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.map(f32::to_bits) == b.map(f32::to_bits))
}

#[test]
fn a_ball_in_even_light_shows_its_reflectance() {
    for reflectance in [0.0, 0.3, 1.0] {
        let ball = scene(vec![sphere(0)], vec![matt(reflectance)], 1.0);
        assert_near(seen(&ball, &camera([0.0, 0.0, 5.0], 0.2), &options(16, 64, 3)), f64::from(reflectance), 0.005);
    }
}

/// White, smooth or rough at no cost: metal that loses nothing, and glass that only moves light, cannot be seen.
#[test]
fn what_loses_no_light_is_not_seen_in_even_light() {
    let mirror = MetallicRoughness { metallic: 1.0, roughness: 0.0, ..MetallicRoughness::default() };
    let wall = MetallicRoughness { transmission: 1.0, roughness: 0.0, ..MetallicRoughness::default() };
    let glass = MetallicRoughness { thin: false, ..wall.clone() };
    for own in [mirror, wall, glass] {
        let ball = scene(vec![sphere(0)], vec![of(own.clone())], 1.0);
        let found = seen(&ball, &camera([0.0, 0.0, 5.0], 0.2), &options(16, 64, 16));
        assert!((0.99..1.002).contains(&found), "{own:?}: {found}");
    }
}

#[test]
fn in_a_closed_box_light_adds_up_bounce_by_bounce() {
    for depth in [0, 1, 4] {
        let inside = scene(vec![cube(0)], vec![glowing(1.0, 0.5)], 0.0);
        let expected: f64 = (0..=depth + 1).map(|bounce| 0.5f64.powi(bounce as i32)).sum();
        assert_near(seen(&inside, &camera([0.1, 0.2, 0.9], 1.2), &options(32, 64, depth)), expected, 0.003);
    }
}

#[test]
fn infinitely_small_lights_are_as_bright_as_in_whitteds_shading() {
    let position = [3.0, 4.0, 0.0];
    let point = Light {
        kind: LightKind::Point { position },
        color: [2.0; 3],
        attenuation: [0.0, 0.0, 1.0],
        ..Light::default()
    };
    let sun =
        Light { kind: LightKind::Directional { direction: [-3.0, -4.0, 0.0] }, color: [2.0; 3], ..Light::default() };
    for (light, expected) in [(point, 0.6 * 0.8 * 2.0 / 25.0), (sun, 0.6 * 0.8 * 2.0)] {
        let plane = Scene { lights: vec![light], ..scene(vec![square(0.0, 50.0, 0, true)], vec![matt(0.6)], 0.0) };
        assert_near(seen(&plane, &camera([0.0, 10.0, 0.0], 0.02), &options(1, 16, 0)), expected, 0.002);
    }
}

/// The form factor from a patch to a square of half width 1 straight above it, at height 2.
#[test]
fn a_glowing_square_lights_by_its_form_factor() {
    let lit =
        scene(vec![square(0.0, 5.0, 0, true), square(2.0, 1.0, 1, false)], vec![matt(0.5), glowing(3.0, 0.0)], 0.0);
    let side = 0.5f64;
    let root = (1.0 + side * side).sqrt();
    let form_factor = 4.0 / std::f64::consts::PI * side / root * (side / root).atan();
    let eye = camera([0.0, 1.5, 0.0], 0.01);
    for strategies in [strategy::LIGHTS, strategy::CHANCE, strategy::BOTH] {
        let mut tracer = tracer(&lit);
        tracer.set_strategies(strategies);
        let found = mean(&pixels(&tracer, &eye, &options(8, 256, 0)));
        assert_near(found, 0.5 * 3.0 * form_factor, 0.01);
    }
}

/// A room of matt and shiny things under a sky and a lamp, for what must hold whatever is there.
fn room() -> Scene {
    let shiny = MetallicRoughness {
        base_color: [0.9, 0.6, 0.3],
        metallic: 1.0,
        roughness: 0.4,
        ..MetallicRoughness::default()
    };
    let mut ball = sphere(1);
    ball.positions.iter_mut().for_each(|p| *p = p.map(|x| 0.5 * x));
    let meshes = vec![square(-0.5, 3.0, 0, true), ball, square(1.5, 0.4, 2, false)];
    let materials = vec![matt(0.7), of(shiny), glowing(6.0, 0.2)];
    let sky = Background { zenith: [0.2, 0.4, 0.8], horizon: [0.6; 3], ground: [0.1; 3] };
    Scene { background: Some(sky), ..scene(meshes, materials, 0.0) }
}

fn across() -> Camera {
    camera([2.0, 1.2, 2.5], 0.7)
}

#[test]
fn all_ways_to_find_light_agree_in_the_mean() {
    let [lights, chance, both] = [strategy::LIGHTS, strategy::CHANCE, strategy::BOTH].map(|strategies| {
        let mut tracer = tracer(&room());
        tracer.set_strategies(strategies);
        mean(&pixels(&tracer, &across(), &options(48, 64, 3)))
    });
    assert_near(lights, both, 0.01);
    assert_near(chance, both, 0.01);
}

#[test]
fn a_part_of_a_picture_is_the_same_as_the_whole_and_so_is_a_film_that_grows() {
    let (tracer, camera, options) = (tracer(&room()), across(), options(40, 3, 3));
    let whole = pixels(&tracer, &camera, &options);
    let part = pixels(&tracer, &camera, &RenderOptions { crop: Some([7, 11, 29, 36]), ..options });
    for (index, pixel) in part.iter().enumerate() {
        assert_eq!(pixel, &whole[(11 + index / 22) * 40 + 7 + index % 22], "{index}");
    }
    let mut film = Film::new(tracer.device(), [40, 40]).unwrap();
    while !tracer.accumulate(&mut film, &camera, &options, 1e-3).unwrap().complete {}
    let development = Development::default();
    film.tone_map_film(&development, None).unwrap();
    let mut screen = Staging::default();
    screen.fetch(tracer.device(), film.screen()).unwrap();
    let picture = tracer.render(&camera, &options, &mut |_| ()).unwrap().picture;
    let expected = png::tone_map(&picture, &development).pixels;
    assert!(screen.iter().zip(&expected).all(|(shown, expected)| shown.to_le_bytes()[..3] == expected[..]));
}

#[test]
fn every_structure_and_device_gives_the_same_bits() {
    let mut leafy = room();
    leafy.materials[1].alpha = AlphaMode::Blend;
    leafy.materials[1].opacity = 0.5;
    leafy.materials[0].single_sided = true;
    for scene in [room(), leafy] {
        let mut expected: Option<Vec<[f32; 4]>> = None;
        for device in devices() {
            for kind in kinds_on(&device) {
                let tracer = Tracer::new(&scene, kind, &device).unwrap();
                let found = pixels(&tracer, &across(), &options(32, 2, 4));
                assert!(same_bits(expected.get_or_insert_with(|| found.clone()), &found), "{kind}");
            }
        }
    }
}

#[test]
fn what_covers_half_is_met_half_of_the_time_and_takes_half_of_the_light() {
    let veil = Material { alpha: AlphaMode::Blend, opacity: 0.5, ..matt(0.0) };
    let sky = scene(vec![square(0.0, 9.0, 0, true)], vec![veil.clone()], 1.0);
    let above = camera([0.0, 3.0, 0.0], 0.3);
    assert_near(seen(&sky, &above, &options(32, 16, 0)), 0.5, 0.02);
    let sun = Light { kind: LightKind::Directional { direction: [0.3, -1.0, 0.0] }, ..Light::default() };
    let shaded = scene(vec![square(0.0, 9.0, 0, true), square(5.0, 9.0, 1, true)], vec![matt(0.5), veil], 0.0);
    let shaded = Scene { lights: vec![sun], ..shaded };
    let cosine = 1.0 / (1.0f64 + 0.09).sqrt();
    assert_near(seen(&shaded, &above, &options(4, 4, 0)), 0.5 * 0.5 * cosine, 0.002);
}

#[test]
fn single_sided_surfaces_are_not_seen_from_behind() {
    let hidden = scene(vec![square(0.0, 9.0, 0, false)], vec![Material { single_sided: true, ..matt(0.0) }], 1.0);
    assert_eq!(seen(&hidden, &camera([0.0, 3.0, 0.0], 0.3), &options(4, 1, 2)), 1.0);
}

#[test]
fn degenerate_materials_and_lights_leave_no_trace_of_nan() {
    let odd = [0.0, 1.0].map(|roughness| {
        [1.0, 1.5].map(|ior| {
            let own =
                MetallicRoughness { roughness, ior, transmission: 1.0, thin: false, ..MetallicRoughness::default() };
            of(own)
        })
    });
    for material in odd.into_iter().flatten() {
        let mut lamp = square(2.0, 1.0, 1, false);
        // A triangle without area, in the lamp.
        lamp.triangles.push([0, 0, 1]);
        lamp.materials.push(1);
        let scene = scene(vec![sphere(0), lamp], vec![material, glowing(5.0, 0.0)], 0.5);
        assert!(seen(&scene, &across(), &options(24, 8, 8)).is_finite());
    }
}

#[test]
fn tests_are_not_counted_along_paths() {
    let tracer = tracer(&room());
    let options = RenderOptions { count_tests: true, ..options(4, 1, 1) };
    let refused = tracer.render(&across(), &options, &mut |_| ()).unwrap_err().to_string();
    assert_eq!(refused, "tests are counted with the integrator whitted alone");
}
