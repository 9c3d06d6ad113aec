//! Pictures and their layers are the same through every structure, on every device.

use raywarp::accel::AccelKind;
use raywarp::device_scene::world_triangles;
use raywarp::render::{RenderOptions, Tracer};
use raywarp_lab::structures::{Build, Tree};

use crate::{devices, OWN};

#[test]
fn every_structure_gives_the_same_picture() {
    let scene = raywarp::scene::load::builtin().unwrap().scene;
    let triangles = world_triangles(&scene, &scene.instances, &scene.materials).unwrap();
    let cpu = &devices()[0];
    let options = RenderOptions { size: [48, 27], spp: 1, count_tests: true, ..RenderOptions::default() };
    let reference = Tracer::new(&scene, AccelKind::Bvh, cpu).unwrap();
    let camera = reference.default_camera();
    let expected = reference.render(camera, &options, &mut |_| ()).unwrap();
    let layers = reference.layers(camera, &options).unwrap();
    for device in devices() {
        let mut tracer = Tracer::new(&scene, AccelKind::Bvh2, &device).unwrap();
        for what in OWN.map(Build::from) {
            let tree = Tree::build(what, triangles.clone()).unwrap();
            let boxes = tree.boxes(6);
            tracer.scene_mut().unwrap().replace(tree.structure(what.quality, &device).unwrap());
            let name = format!("{} on {}", what.kind, device.description());
            let counted = tracer.render(camera, &options, &mut |_| ()).unwrap();
            let plain = tracer.render(camera, &RenderOptions { count_tests: false, ..options }, &mut |_| ()).unwrap();
            let bits = |pixels: &[[f32; 4]]| -> Vec<[u32; 4]> { pixels.iter().map(|p| p.map(f32::to_bits)).collect() };
            assert!(bits(&counted.picture.pixels) == bits(&expected.picture.pixels), "{name}");
            assert!(bits(&plain.picture.pixels) == bits(&expected.picture.pixels), "{name}");
            assert!(counted.rays == expected.rays && counted.tests.is_some(), "{name}");
            assert!(tracer.layers(camera, &options).unwrap() == layers, "{name}: layers");
            assert_eq!(tracer.scene().structure().boxes(6).unwrap(), boxes, "{name}: boxes");
        }
    }
}
