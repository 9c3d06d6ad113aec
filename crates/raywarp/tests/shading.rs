//! Shading against formulas: what a pixel must be where the geometry is simple enough to say.

use raywarp::accel::AccelKind;
use raywarp::device::{Device, DeviceChoice};
use raywarp::render::{RenderOptions, Tracer};
use raywarp::scene::{
    AlphaMode, Background, Camera, Filter, Image, Instance, Light, LightKind, Material, Mesh, NormalMap, Projection,
    Scene, Texture, Transform, UvSet, Wrap,
};

/// A camera above the origin that looks straight down on y = 0, with x to the right.
fn camera_above(height: f32, target: [f32; 3]) -> Camera {
    Camera {
        name: "above".into(),
        eye: [0.0, height, 0.0],
        target,
        up: [0.0, 0.0, -1.0],
        projection: Projection::Perspective { fov_y: 0.02 },
    }
}

/// A square of half width `half` at height `y`, seen from above on its outside.
fn square(y: f32, half: f32, material: u32) -> Mesh {
    Mesh {
        name: format!("square at {y}"),
        positions: vec![[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        materials: vec![material; 2],
        ..Mesh::default()
    }
}

fn matt(diffuse: f32) -> Material {
    Material { ambient: [0.0; 3], diffuse: [diffuse; 3], ..Material::default() }
}

fn black() -> Material {
    matt(0.0)
}

fn scene(meshes: Vec<Mesh>, materials: Vec<Material>, lights: Vec<Light>) -> Scene {
    let place = |mesh| Instance { name: String::new(), mesh, transform: Transform::IDENTITY, material: None };
    Scene {
        instances: (0..meshes.len()).map(place).collect(),
        meshes,
        materials,
        // The renderer would light a scene without lights by itself.
        lights: if lights.is_empty() { vec![Light { color: [0.0; 3], ..Light::default() }] } else { lights },
        background: Some(Background::constant([0.0; 3])),
        ambient: Some([0.0; 3]),
        ..Scene::default()
    }
}

fn point(position: [f32; 3], color: f32) -> Light {
    Light { kind: LightKind::Point { position }, color: [color; 3], ..Light::default() }
}

/// Radiance of the middle of the picture.
fn seen(scene: &Scene, camera: &Camera, depth: u32) -> [f32; 3] {
    let name = std::env::var("RAYWARP_TEST_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    let device = Device::open(name.parse::<DeviceChoice>().unwrap()).unwrap();
    let tracer = Tracer::new(scene, AccelKind::Bvh, &device).unwrap();
    let options = RenderOptions { size: [1, 1], spp: 1, max_depth: depth, ..RenderOptions::default() };
    let [r, g, b, _] = tracer.render(camera, &options, &mut |_| ()).unwrap().picture.pixels[0];
    [r, g, b]
}

#[track_caller]
fn assert_close(found: [f32; 3], expected: f32) {
    assert!(found.iter().all(|c| (c - expected).abs() <= 2e-5 * expected.abs().max(0.1)), "{found:?}, not {expected}");
}

#[test]
fn a_matt_plane_answers_by_the_cosine_and_the_falloff() {
    for attenuation in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.5, 0.25]] {
        let position = [3.0f32, 4.0, 0.0];
        let light = Light { attenuation, ..point(position, 2.0) };
        let plane = scene(vec![square(0.0, 50.0, 0)], vec![matt(0.6)], vec![light]);
        let expected = 0.6 * 0.8 * 2.0 / (attenuation[0] + attenuation[1] * 5.0 + attenuation[2] * 25.0);
        assert_close(seen(&plane, &camera_above(10.0, [0.0; 3]), 0), expected);
    }
}

#[test]
fn the_highlight_is_a_power_of_the_cosine_to_the_mirror_direction() {
    for exponent in [1.0, 10.0, 200.0] {
        let shiny = Material { specular: [0.5; 3], shininess: exponent, ..black() };
        // Seen from straight above, the mirror direction is up: its cosine with the light is 10 / sqrt(101).
        let plane = scene(vec![square(0.0, 50.0, 0)], vec![shiny], vec![point([1.0, 10.0, 0.0], 1.0)]);
        let cosine = 10.0f64 / 101.0f64.sqrt();
        assert_close(seen(&plane, &camera_above(10.0, [0.0; 3]), 0), 0.5 * cosine.powf(exponent as f64) as f32);
    }
}

#[test]
fn ambient_and_emission_add_up_and_unlit_ignores_lights() {
    let glowing = Material { ambient: [0.5; 3], emission: [0.25; 3], ..black() };
    let mut plane = scene(vec![square(0.0, 50.0, 0)], vec![glowing], vec![]);
    plane.ambient = Some([0.4; 3]);
    assert_close(seen(&plane, &camera_above(10.0, [0.0; 3]), 0), 0.45);
    plane.materials = vec![Material { unlit: true, ..matt(0.3) }];
    plane.lights = vec![point([0.0, 5.0, 0.0], 100.0)];
    assert_close(seen(&plane, &camera_above(10.0, [0.0; 3]), 0), 0.3);
}

/// Programs write any ambient colour, white or black, for a light that they do not know: the built-in one.
#[test]
fn built_in_ambient_light_is_reflected_as_diffuse_light_is() {
    let picture = |ambient: [f32; 3]| {
        let mut plane = scene(vec![square(0.0, 50.0, 0)], vec![Material { ambient, ..matt(0.5) }], vec![]);
        plane.ambient = None;
        seen(&plane, &camera_above(10.0, [0.0; 3]), 0)
    };
    assert_eq!(picture([1.0; 3]), picture([0.5; 3]));
    assert_eq!(picture([0.0; 3]), picture([0.5; 3]));
    assert_close(picture([1.0; 3]), 0.5 * 0.05);
}

#[test]
fn a_spot_is_full_inside_dark_outside_and_smooth_between() {
    let spot = |x: f32| Light {
        kind: LightKind::Spot { position: [x, 10.0, 0.0], direction: [0.0, -1.0, 0.0], inner: 0.2, outer: 0.4 },
        ..point([0.0; 3], 1.0)
    };
    let brightness = |x: f32| {
        let plane = scene(vec![square(0.0, 50.0, 0)], vec![matt(1.0)], vec![spot(x)]);
        seen(&plane, &camera_above(10.0, [0.0; 3]), 0)
    };
    let cosine = |x: f32| 10.0 / (100.0 + x * x).sqrt();
    assert_close(brightness(1.0), cosine(1.0));
    assert_close(brightness(5.0), 0.0);
    let x = 10.0 * 0.3f32.tan();
    let share = (cosine(x) - 0.4f32.cos()) / (0.2f32.cos() - 0.4f32.cos());
    assert_close(brightness(x), cosine(x) * share * share);
}

#[test]
fn a_shadow_is_black_and_the_light_beside_it_is_not() {
    let blocker = |at: f32| {
        let mut blocker = square(0.0, 0.5, 0);
        blocker.positions.iter_mut().for_each(|p| *p = [p[0] + at, 5.0, p[2]]);
        let lights = vec![point([4.0, 10.0, 0.0], 1.0)];
        scene(vec![square(0.0, 50.0, 0), blocker], vec![matt(1.0)], lights)
    };
    let camera = camera_above(4.0, [0.0; 3]);
    let lit = 10.0 / 116.0f32.sqrt();
    assert_close(seen(&blocker(2.0), &camera, 0), 0.0);
    assert_close(seen(&blocker(2.6), &camera, 0), lit);
    // Behind the light nothing casts a shadow.
    let mut behind = blocker(2.0);
    behind.meshes[1].positions.iter_mut().for_each(|p| *p = [p[0] + 4.0, 15.0, p[2]]);
    assert_close(seen(&behind, &camera, 0), lit);
}

#[test]
fn a_lamp_in_a_ceiling_is_not_behind_it() {
    for height in [500.0f32, 499.9999, 1e-3] {
        let room = scene(
            vec![square(0.0, 500.0, 0), square(height.ceil().max(height), 500.0, 0)],
            vec![matt(1.0)],
            vec![point([0.0, height, 0.0], 1.0)],
        );
        assert_close(seen(&room, &camera_above(0.5 * height, [0.0; 3]), 0), 1.0);
    }
}

#[test]
fn a_narrow_spot_is_full_in_its_middle() {
    let kind = LightKind::Spot { position: [0.0, 10.0, 0.0], direction: [0.0, -1.0, 0.0], inner: 0.0, outer: 0.008 };
    let plane = scene(vec![square(0.0, 50.0, 0)], vec![matt(1.0)], vec![Light { kind, ..Light::default() }]);
    assert!(seen(&plane, &camera_above(5.0, [0.0; 3]), 0)[0] > 0.99);
}

/// A plane under a texture, lit along +x at 45 degrees; the camera sees the middle of the texture.
fn relief(normal_map: NormalMap, image: Image) -> f32 {
    let mut mesh = square(0.0, 1.0, 0);
    mesh.uvs = mesh.positions.iter().map(|p| [0.5 + 0.5 * p[0], 0.5 - 0.5 * p[2]]).collect();
    let material = Material { normal_map: Some(normal_map), ..matt(1.0) };
    let sun = Light { kind: LightKind::Directional { direction: [1.0, -1.0, 0.0] }, ..Light::default() };
    let mut plane = scene(vec![mesh], vec![material], vec![sun]);
    plane.images = vec![image];
    seen(&plane, &camera_above(4.0, [0.0; 3]), 0)[0]
}

fn image(width: u32, texel: impl Fn(u32) -> [u8; 3]) -> Image {
    let texels = (0..width * width).map(|i| texel(i % width)).map(|[r, g, b]| [r, g, b, 255]).collect();
    Image { name: "relief".into(), width, height: width, texels }
}

/// The texture mirrored along u.
fn mirrored(texture: Texture) -> Texture {
    Texture { transform: [[-1.0, 0.0, 1.0], [0.0, 1.0, 0.0]], ..texture }
}

#[test]
fn normal_maps_lean_the_way_they_are_painted() {
    // Normal (0.6, 0, 0.8) in 8 bits: the light comes from -x, where it leans away from.
    let painted = || image(4, |_| [204, 128, 230]);
    let texture = Texture::new(0, false);
    let [away, towards] =
        [texture, mirrored(texture)].map(|texture| relief(NormalMap::Tangent { texture, scale: 1.0 }, painted()));
    let diagonal = 0.5f32.sqrt();
    assert!((away - diagonal * (0.8 - 0.6)).abs() < 0.01, "{away}");
    assert!((towards - diagonal * (0.8 + 0.6)).abs() < 0.01, "{towards}");
    let flat = relief(NormalMap::Tangent { texture, scale: 0.0 }, painted());
    assert!((flat - diagonal).abs() < 0.01, "{flat}");
}

#[test]
fn heights_rise_towards_white() {
    // Rising by 16 of 255 a texel to the right: with a white of 15.9375 texels a slope of 1, which leans to -x.
    let ramp = || image(16, |x| [16 * x as u8; 3]);
    let texture = Texture { wrap: [Wrap::Clamp; 2], ..Texture::new(0, false) };
    let [facing, averted] =
        [texture, mirrored(texture)].map(|texture| relief(NormalMap::Height { texture, scale: 15.9375 }, ramp()));
    assert!((facing - 1.0).abs() < 0.01, "{facing}");
    assert!(averted.abs() < 0.01, "{averted}");
}

#[test]
fn textures_are_decoded_from_srgb_and_scaled() {
    let mut mesh = square(0.0, 1.0, 0);
    mesh.uvs = vec![[0.5; 2]; 4];
    let grey = |srgb: bool, gain: f32, base: f32| {
        let texture = Texture { gain, base, ..Texture::new(0, srgb) };
        let material = Material { unlit: true, diffuse_map: Some(texture), ..matt(1.0) };
        let mut plane = scene(vec![mesh.clone()], vec![material], vec![]);
        plane.images = vec![image(2, |_| [188; 3])];
        seen(&plane, &camera_above(10.0, [0.0; 3]), 0)
    };
    assert_close(grey(false, 1.0, 0.0), 188.0 / 255.0);
    assert_close(grey(true, 1.0, 0.0), ((188.0f32 / 255.0 + 0.055) / 1.055).powf(2.4));
    assert_close(grey(false, 0.5, 0.25), 0.25 + 0.5 * 188.0 / 255.0);
}

#[test]
fn transparent_and_half_covered_surfaces_filter_shadows() {
    let glass = Material { transmission: [0.5; 3], ..black() };
    let veil = Material { opacity: 0.25, alpha: AlphaMode::Blend, ..black() };
    let hole = Material { opacity: 0.25, alpha: AlphaMode::Mask(0.5), ..black() };
    // The light stands straight above: the camera below the panes sees what falls through all of them.
    for (panes, share) in
        [(vec![1, 1], 0.25), (vec![2], 0.75), (vec![1, 2, 3], 0.375), (vec![3], 1.0), (vec![1, 0], 0.0)]
    {
        let mut meshes = vec![square(0.0, 50.0, 0)];
        meshes.extend(panes.iter().zip(5..).map(|(&material, height)| square(height as f32, 1.0, material)));
        let materials = vec![matt(1.0), glass.clone(), veil.clone(), hole.clone()];
        let room = scene(meshes, materials, vec![point([0.0, 20.0, 0.0], 1.0)]);
        assert_close(seen(&room, &camera_above(4.0, [0.0; 3]), 0), share);
    }
}

#[test]
fn a_mirror_shows_what_stands_at_the_mirror_angle() {
    let mirror = Material { reflection: [0.9; 3], ..black() };
    let lamp = Material { emission: [2.0; 3], ..black() };
    let mut ceiling = square(10.0, 0.5, 1);
    ceiling.positions.iter_mut().for_each(|p| p[0] += 4.0);
    let room = scene(vec![square(0.0, 50.0, 0), ceiling], vec![mirror, lamp], vec![]);
    // From height 10 to (2, 0, 0), up to (4, 10, 0).
    assert_close(seen(&room, &camera_above(10.0, [2.0, 0.0, 0.0]), 1), 1.8);
    assert_close(seen(&room, &camera_above(10.0, [2.0, 0.0, 0.0]), 0), 0.0);
    assert_close(seen(&room, &camera_above(10.0, [3.0, 0.0, 0.0]), 1), 0.0);
}

#[test]
fn two_mirrors_multiply_at_every_bounce() {
    let mirror = Material { reflection: [0.5; 3], emission: [1.0; 3], ..black() };
    // The camera stands between them and sees each bounce add half of the one before.
    let hall = scene(vec![square(0.0, 50.0, 0), square(20.0, 50.0, 0)], vec![mirror], vec![]);
    for depth in 0..=16u32 {
        let expected = 2.0 - 0.5f32.powi(depth as i32);
        assert_close(seen(&hall, &camera_above(10.0, [0.0; 3]), depth), expected);
    }
}

/// A sky that is 1 above and 3 below, so that what is mirrored and what is refracted can be told apart.
fn between_skies(meshes: Vec<Mesh>, material: Material) -> Scene {
    let mut scene = scene(meshes, vec![material], vec![]);
    scene.background = Some(Background { zenith: [1.0; 3], horizon: [2.0; 3], ground: [3.0; 3] });
    scene
}

#[test]
fn fresnel_shares_out_the_light_at_normal_incidence() {
    let glass = Material { transmission: [0.8; 3], ior: 1.5, fresnel: true, ..black() };
    let surface = between_skies(vec![square(0.0, 50.0, 0)], glass);
    assert_close(seen(&surface, &camera_above(10.0, [0.0; 3]), 1), 0.04 * 1.0 + 0.96 * 0.8 * 3.0);
}

#[test]
fn glass_neither_makes_nor_loses_light() {
    for reflection in [0.0, 1.0] {
        let [reflection, transmission] = [[reflection; 3], [1.0; 3]];
        let glass = Material { reflection, transmission, ior: 1.5, fresnel: true, ..black() };
        let mut surface = between_skies(vec![square(0.0, 50.0, 0)], glass);
        surface.background = Some(Background::constant([1.0; 3]));
        for x in [0.0, 5.0, 30.0] {
            assert_close(seen(&surface, &camera_above(10.0, [x, 0.0, 0.0]), 1), 1.0);
        }
    }
}

#[test]
fn refraction_bends_by_snells_law() {
    let glass = Material { transmission: [1.0; 3], ior: 1.5, ..black() };
    let surface = between_skies(vec![square(0.0, 50.0, 0)], glass);
    for x in [1.0f32, 5.0, 20.0] {
        let sine = x / (x * x + 100.0).sqrt();
        let below = (1.0 - (sine / 1.5).powi(2)).sqrt();
        // The sky below is linear in the sine of the elevation, which is the refracted cosine.
        assert_close(seen(&surface, &camera_above(10.0, [x, 0.0, 0.0]), 1), 2.0 + below);
    }
}

#[test]
fn a_slab_shifts_the_view_and_keeps_its_direction() {
    let glass = Material { transmission: [1.0; 3], ior: 1.5, ..black() };
    let lamp = Material { emission: [1.0; 3], ..black() };
    // The lower side faces down: the slab is closed as far as rays inside it can tell.
    let mut bottom = square(-2.0, 50.0, 0);
    bottom.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    // Towards (10, 0, 0) at 45 degrees: in the glass the ray advances 2 tan(asin(sin 45 / 1.5)) = 1.0690 and not 2.
    let lit = |x: f32| {
        let mut strip = square(-3.0, 0.05, 1);
        strip.positions.iter_mut().for_each(|p| p[0] += x);
        let slab = scene(vec![square(0.0, 50.0, 0), bottom.clone(), strip], vec![glass.clone(), lamp.clone()], vec![]);
        seen(&slab, &camera_above(10.0, [10.0, 0.0, 0.0]), 2)
    };
    let inside = 2.0 * (0.5f32.sqrt() / 1.5).asin().tan();
    assert_close(lit(10.0 + inside + 1.0), 1.0);
    assert_close(lit(10.0 + 2.0 + 1.0), 0.0);
}

#[test]
fn beyond_the_critical_angle_everything_is_mirrored() {
    for fresnel in [false, true] {
        let glass = Material { transmission: [1.0; 3], ior: 1.5, fresnel, ..black() };
        let mut surface = between_skies(vec![square(0.0, 50.0, 0)], glass);
        // Seen from inside the glass: the square faces away.
        surface.meshes[0].triangles.iter_mut().for_each(|t| t.swap(1, 2));
        // 45 degrees is beyond asin(1 / 1.5): the upper sky at the elevation of 45 degrees.
        let expected = 2.0 - 0.5f32.sqrt();
        assert_close(seen(&surface, &camera_above(10.0, [10.0, 0.0, 0.0]), 1), expected);
    }
}

#[test]
fn partial_coverage_mixes_with_what_lies_behind() {
    let veil = Material { opacity: 0.25, alpha: AlphaMode::Blend, emission: [1.0; 3], ..black() };
    let wall = Material { emission: [4.0; 3], ..black() };
    let room = scene(vec![square(0.0, 50.0, 1), square(1.0, 50.0, 0)], vec![veil, wall], vec![]);
    assert_close(seen(&room, &camera_above(10.0, [0.0; 3]), 0), 0.25 + 0.75 * 4.0);
}

#[test]
fn interpolated_normals_shade_a_flat_triangle_like_the_sphere() {
    let mut mesh = square(0.0, 1.0, 0);
    mesh.normals = mesh.positions.iter().map(|p| normalized([p[0], 1.0, p[2]])).collect();
    let sun = Light { kind: LightKind::Directional { direction: [0.0, -1.0, 0.0] }, ..Light::default() };
    let dome = scene(vec![mesh], vec![matt(1.0)], vec![sun]);
    // In the middle of the edge from (-1, 1) to (1, 1) the normal is the mean of two that lean apart in x.
    let y = 0.5f32.sqrt();
    let found = seen(&dome, &camera_above(10.0, [0.0, 0.0, 0.999]), 0);
    assert!((found[0] - y).abs() < 2e-3, "{found:?}, not {y}");
}

fn normalized([x, y, z]: [f32; 3]) -> [f32; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

#[test]
fn each_texture_reads_its_own_set_of_coordinates() {
    // Left half black, right half white; the first set shows the left, the second the right.
    let mut mesh = square(0.0, 1.0, 0);
    (mesh.uvs, mesh.second_uvs) = (vec![[0.25, 0.5]; 4], vec![[0.75, 0.5]; 4]);
    let texture = |uv_set| Some(Texture { uv_set, filter: Filter::Nearest, ..Texture::new(0, false) });
    let show = |material: Material| {
        let sun = Light { kind: LightKind::Directional { direction: [0.0, -1.0, 0.0] }, ..Light::default() };
        let mut plane = scene(vec![mesh.clone()], vec![material], vec![sun]);
        plane.images = vec![image(2, |x| [255 * x as u8; 3])];
        seen(&plane, &camera_above(10.0, [0.0; 3]), 0)
    };
    for (set, expected) in [(UvSet::First, 0.0), (UvSet::Second, 1.0)] {
        let map = || texture(set);
        assert_close(show(Material { unlit: true, diffuse_map: map(), ..matt(1.0) }), expected);
        assert_close(show(Material { emission: [1.0; 3], emission_map: map(), ..black() }), expected);
        assert_close(show(Material { specular: [1.0; 3], specular_map: map(), ..black() }), expected);
        let cut = Material { opacity_map: map(), alpha: AlphaMode::Blend, unlit: true, ..matt(1.0) };
        assert_close(show(cut), expected);
    }
    let both = Material { emission: [1.0; 3], emission_map: texture(UvSet::Second), ..matt(1.0) };
    assert_close(show(Material { diffuse_map: texture(UvSet::First), ..both }), 1.0);
}

#[test]
fn a_normal_map_leans_along_the_coordinates_that_it_reads() {
    let lean = |uv_set, turned: bool| {
        let mut mesh = square(0.0, 1.0, 0);
        let along = |p: &[f32; 3]| [0.5 + 0.5 * p[0], 0.5 - 0.5 * p[2]];
        mesh.uvs = mesh.positions.iter().map(along).collect();
        mesh.second_uvs = mesh.uvs.iter().map(|&[u, v]| if turned { [1.0 - u, v] } else { [u, v] }).collect();
        let texture = Texture { uv_set, ..Texture::new(0, false) };
        let material = Material { normal_map: Some(NormalMap::Tangent { texture, scale: 1.0 }), ..matt(1.0) };
        let sun = Light { kind: LightKind::Directional { direction: [1.0, -1.0, 0.0] }, ..Light::default() };
        let mut plane = scene(vec![mesh], vec![material], vec![sun]);
        plane.images = vec![image(4, |_| [204, 128, 230])];
        seen(&plane, &camera_above(4.0, [0.0; 3]), 0)[0]
    };
    assert_eq!(lean(UvSet::First, true), lean(UvSet::Second, false));
    assert!(lean(UvSet::Second, true) > lean(UvSet::First, true) + 0.5);
}

#[test]
fn surfaces_of_a_single_side_are_not_seen_from_behind_and_cast_shadows() {
    // `square` shows its outside upwards; turned round it shows it downwards.
    let turned = |mut mesh: Mesh| {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        mesh
    };
    let single = Material { single_sided: true, unlit: true, ..matt(0.25) };
    let floor = Material { unlit: true, ..matt(1.0) };
    let below = |roof: Mesh, material: &Material| {
        let room = scene(vec![square(0.0, 50.0, 0), roof], vec![floor.clone(), material.clone()], vec![]);
        seen(&room, &camera_above(10.0, [0.0; 3]), 0)
    };
    assert_close(below(square(5.0, 1.0, 1), &single), 0.25);
    assert_close(below(turned(square(5.0, 1.0, 1)), &single), 1.0);
    assert_close(below(turned(square(5.0, 1.0, 1)), &Material { single_sided: false, ..single.clone() }), 0.25);
    // What transmits is left from its inside.
    let glass = Material { transmission: [0.5; 3], single_sided: true, ..black() };
    let through = |roof: Mesh| {
        let room = scene(vec![square(0.0, 50.0, 0), roof], vec![floor.clone(), glass.clone()], vec![]);
        seen(&room, &camera_above(10.0, [0.0; 3]), 1)
    };
    assert_close(through(turned(square(5.0, 1.0, 1))), 0.5);
    // The camera is below the roof, the light above: either side shades the floor.
    for roof in [square(5.0, 1.0, 1), turned(square(5.0, 1.0, 1))] {
        let room = scene(
            vec![square(0.0, 50.0, 0), roof],
            vec![matt(1.0), single.clone()],
            vec![point([0.0, 20.0, 0.0], 1.0)],
        );
        assert_close(seen(&room, &camera_above(4.0, [0.0; 3]), 0), 0.0);
    }
    // A mirrored ray passes as well: the mirror shows the sky through the back of what is above it.
    let mirror = Material { reflection: [1.0; 3], ..black() };
    for (roof, expected) in [(turned(square(5.0, 9.0, 1)), 0.25), (square(5.0, 9.0, 1), 0.75)] {
        let mut room = scene(vec![square(0.0, 50.0, 0), roof], vec![mirror.clone(), single.clone()], vec![]);
        room.background = Some(Background::constant([0.75; 3]));
        assert_close(seen(&room, &camera_above(4.0, [0.0; 3]), 1), expected);
    }
}

/// A block of glass that does not bend: its top at `top`, its bottom at 1, both seen as outside from outside.
fn block(top: f32, material: u32) -> Vec<Mesh> {
    let mut bottom = square(1.0, 50.0, material);
    bottom.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    vec![bottom, square(top, 50.0, material)]
}

#[test]
fn glass_absorbs_by_the_length_inside() {
    let absorption = [0.0, 0.5, 2.0];
    let glass = Material { transmission: [1.0; 3], absorption, ..black() };
    let mut room = scene(block(4.0, 1), vec![Material { unlit: true, ..matt(1.0) }, glass], vec![]);
    room.meshes.push(square(0.0, 50.0, 0));
    room.instances.push(Instance { name: String::new(), mesh: 2, transform: Transform::IDENTITY, material: None });
    let [r, g, b] = seen(&room, &camera_above(10.0, [0.0; 3]), 4);
    let left = absorption.map(|a: f32| (-3.0 * a).exp());
    assert!([(r, left[0]), (g, left[1]), (b, left[2])].iter().all(|(a, b)| (a - b).abs() < 1e-4), "{:?}", [r, g, b]);

    // A shadow ray goes straight through the block as well.
    room.materials[0] = matt(1.0);
    room.lights = vec![point([0.0, 20.0, 0.0], 1.0)];
    let [r, g, b] = seen(&room, &camera_above(0.5, [0.0; 3]), 0);
    assert!([(r, left[0]), (g, left[1]), (b, left[2])].iter().all(|(a, b)| (a - b).abs() < 1e-4), "{:?}", [r, g, b]);

    // Where there is no way out, nothing is left but what is not absorbed at all.
    room.meshes.truncate(2);
    room.meshes.remove(0);
    room.instances.truncate(1);
    room.background = Some(Background::constant([1.0; 3]));
    assert_eq!(seen(&room, &camera_above(10.0, [0.0; 3]), 4), [1.0, 0.0, 0.0]);
}

#[test]
fn what_tints_a_metal_tints_its_mirror_and_its_highlight() {
    let gold = [1.0, 0.5, 0.25];
    let show = |material: Material, color: Option<[f32; 3]>| {
        let mut mesh = square(0.0, 50.0, 0);
        mesh.colors = color.map_or(vec![], |[r, g, b]| vec![[r, g, b, 1.0]; 4]);
        let mut plane = scene(vec![mesh], vec![material], vec![point([0.0, 20.0, 0.0], 1.0)]);
        plane.background = Some(Background::constant([0.5; 3]));
        seen(&plane, &camera_above(10.0, [0.0; 3]), 1)
    };
    let metal = Material { specular: [0.5; 3], shininess: 10.0, reflection: [0.8; 3], metallic: true, ..black() };
    let solid = Material {
        specular: gold.map(|c| 0.5 * c),
        reflection: gold.map(|c| 0.8 * c),
        metallic: false,
        ..metal.clone()
    };
    assert_eq!(show(metal.clone(), Some(gold)), show(solid.clone(), None));
    assert_eq!(show(Material { metallic: false, ..metal.clone() }, Some(gold)), show(metal, None));
}

#[test]
fn glass_at_the_limit_of_depth_shows_the_surroundings_and_not_black() {
    let glass = Material { transmission: [1.0; 3], ior: 1.5, fresnel: true, ..black() };
    let mut panes = scene(vec![square(0.0, 1.0, 0), square(-0.1, 1.0, 0)], vec![glass], vec![]);
    panes.background = Some(Background::constant([0.5; 3]));
    for depth in 0..4 {
        assert_close(seen(&panes, &camera_above(1.0, [0.0; 3]), depth), 0.5);
    }
    // Where no background is as bright, the ambient light.
    panes.background = Some(Background::constant([0.0; 3]));
    panes.ambient = Some([0.25; 3]);
    panes.materials[0].ambient = [0.0; 3];
    assert_close(seen(&panes, &camera_above(1.0, [0.0; 3]), 0), 0.25);
}
