use super::*;
use crate::{LightKind, Projection};
use std::f32::consts::PI;

fn with_nodes(nodes: &str, more: &str) -> String {
    triangle(more).replace(r#""nodes":[{"mesh":0}]"#, &format!(r#""nodes":[{nodes}]"#))
}

fn near(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
}

#[test]
fn transforms_multiply_down_the_tree() {
    // Scale (-2, 1, 1), quarter turn about z, move by x; below it a matrix that moves by y.
    let nodes = r#"{"name":"top","translation":[10,0,0],"rotation":[0,0,0.70710678,0.70710678],"scale":[-2,1,1],"children":[1]},
        {"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,3,0,1]}"#;
    let scene = scene(&with_nodes(nodes, ""));
    let transform = scene.instances[0].transform;
    assert!(near(transform.columns[0], [0.0, -2.0, 0.0]), "{transform:?}");
    assert!(near(transform.columns[1], [-1.0, 0.0, 0.0]));
    assert!(near(transform.columns[2], [0.0, 0.0, 1.0]));
    assert!(near(transform.translation, [7.0, 0.0, 0.0]));
}

#[test]
fn places_that_lose_digits_are_a_note() {
    let matrix = r#"{"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 4500000.123,0,0,1]}"#;
    // Each of the two is exact in single precision, their sum is not.
    let sum = r#"{"translation":[4500000,0,0],"children":[1]},{"mesh":0,"translation":[0.125,0,0]}"#;
    for nodes in [r#"{"mesh":0,"translation":[4500000.123,0,0]}"#, matrix, sum] {
        let told = notes(&with_nodes(nodes, ""));
        assert_eq!(told.len(), 1, "{nodes}: {told:?}");
        assert!(told[0].starts_with("places of instances lose up to 1.2"), "{told:?}");
    }
    assert!(notes(&with_nodes(r#"{"mesh":0,"translation":[4500000.5,0.1,0.3]}"#, "")).is_empty());
}

#[test]
fn only_the_scene_of_the_file_is_read() {
    let json = with_nodes(r#"{"mesh":0,"name":"a"},{"mesh":0,"name":"b"}"#, "");
    let names = |json: &str| scene(json).instances.into_iter().map(|i| i.name).collect::<Vec<_>>();
    assert_eq!(names(&json), ["a"]);
    let second = json.replace(r#""scenes":[{"nodes":[0]}]"#, r#""scenes":[{"nodes":[0]},{"nodes":[1]}],"scene":1"#);
    assert_eq!(names(&second), ["b"]);
    let none = json.replace(r#","scenes":[{"nodes":[0]}]"#, "");
    assert_eq!(names(&none), ["a", "b"]);
}

#[test]
fn cycles_and_shared_children_are_refused() {
    let message = refusal(&with_nodes(r#"{"children":[1]},{"children":[0]}"#, ""));
    assert!(message.starts_with("F: nodes[0] is reached twice; expected a tree, where every node has one parent."));
    let message = refusal(&with_nodes(r#"{"children":[1,1]},{"mesh":0}"#, ""));
    assert!(message.starts_with("F: nodes[1] is reached twice"), "{message}");
}

#[test]
fn a_deep_tree_is_no_matter() {
    let mut nodes: Vec<String> = (1..50_000).map(|child| format!(r#"{{"children":[{child}]}}"#)).collect();
    nodes.push(r#"{"mesh":0}"#.to_owned());
    assert_eq!(scene(&with_nodes(&nodes.join(","), "")).instances.len(), 1);
}

#[test]
fn transforms_that_are_not_finite_are_left_out() {
    let json = with_nodes(r#"{"mesh":0,"translation":[1e39,0,0]}"#, "");
    assert_eq!(warnings(&json)[1], "1 placements of meshes are not finite and were dropped");
}

#[test]
fn instancing_places_a_mesh_many_times() {
    let pieces = [
        triangle_positions(),
        (FLOAT, "VEC3", 2, floats(&[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]), ""),
        (FLOAT, "VEC3", 2, floats(&[1.0, 1.0, 1.0, 3.0, 3.0, 3.0]), ""),
    ];
    let node = r#"{"mesh":0,"translation":[0,5,0],
        "extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1,"SCALE":2}}}}"#;
    let json =
        file(&pieces, PRIMITIVE, r#","extensionsRequired":["EXT_mesh_gpu_instancing"]"#).replace(r#"{"mesh":0}"#, node);
    let instances = scene(&json).instances;
    assert_eq!(
        instances.iter().map(|i| i.transform.translation).collect::<Vec<_>>(),
        [[1.0, 5.0, 0.0], [2.0, 5.0, 0.0]]
    );
    assert_eq!(instances[1].transform.columns[0], [3.0, 0.0, 0.0]);
    let uneven = json.replace(r#""SCALE":2"#, r#""SCALE":0"#);
    assert!(refusal(&uneven).contains("has attributes of [2, 3] elements; expected equal numbers"));
}

#[test]
fn cameras_look_along_minus_z_of_their_node() {
    let cameras = r#","cameras":[{"type":"perspective","name":"lens","perspective":{"yfov":0.8,"znear":0.1}},
        {"type":"orthographic","orthographic":{"xmag":2,"ymag":3,"znear":0,"zfar":9}},
        {"type":"perspective","perspective":{"yfov":4,"znear":0.1}}]"#;
    let nodes = r#"{"mesh":0,"children":[1,2,3]},{"camera":0,"translation":[1,2,3],"rotation":[0,0.70710678,0,0.70710678]},
        {"camera":1,"name":"plan"},{"camera":2,"name":"fish"}"#;
    let loaded = load_json(&with_nodes(nodes, cameras));
    let [lens, plan] = &loaded.scene.cameras[..] else { panic!("two cameras") };
    assert_eq!((lens.name.as_str(), lens.projection), ("lens", Projection::Perspective { fov_y: 0.8 }));
    assert!(near(lens.eye, [1.0, 2.0, 3.0]) && near(lens.target, [0.0, 2.0, 3.0]) && near(lens.up, [0.0, 1.0, 0.0]));
    assert_eq!((plan.name.as_str(), plan.projection), ("plan", Projection::Orthographic { height: 6.0 }));
    assert_eq!(loaded.warnings[0].message, "camera 'fish' has no usable projection or placement and is left out");
}

#[test]
fn lights_become_what_a_white_surface_sends_back() {
    let lights = r#","extensions":{"KHR_lights_punctual":{"lights":[
        {"type":"point","name":"bulb","intensity":31.415927,"color":[1,0.5,0],"range":7},
        {"type":"directional","intensity":3.1415927},
        {"type":"spot","spot":{"innerConeAngle":0.1,"outerConeAngle":0.4}}]}}"#;
    let nodes = r#"{"mesh":0,"children":[1,2,3]},
        {"translation":[1,2,3],"scale":[9,9,9],"extensions":{"KHR_lights_punctual":{"light":0}}},
        {"name":"sun","rotation":[-0.70710678,0,0,0.70710678],"extensions":{"KHR_lights_punctual":{"light":1}}},
        {"extensions":{"KHR_lights_punctual":{"light":2}}}"#;
    let scene = scene(&with_nodes(nodes, lights));
    let [bulb, sun, spot] = &scene.lights[..] else { panic!("three lights") };
    assert_eq!(
        (bulb.name.as_str(), &bulb.kind, bulb.range),
        ("bulb", &LightKind::Point { position: [1.0, 2.0, 3.0] }, 7.0)
    );
    assert!(near(bulb.color, [10.0, 5.0, 0.0]) && bulb.attenuation == [0.0, 0.0, 1.0]);
    assert_eq!((sun.name.as_str(), sun.attenuation, sun.range), ("sun", [1.0, 0.0, 0.0], f32::INFINITY));
    let LightKind::Directional { direction } = sun.kind else { panic!("a direction") };
    assert!(near(direction, [0.0, -1.0, 0.0]) && near(sun.color, [1.0; 3]));
    let LightKind::Spot { direction, inner, outer, .. } = spot.kind else { panic!("a spot") };
    assert!(near(direction, [0.0, 0.0, -1.0]) && inner == 0.1 && outer == 0.4);
    assert!(near(spot.color, [1.0 / PI; 3]));
}

#[test]
fn a_scene_without_triangles_is_a_warning() {
    assert_eq!(warnings(r#"{"asset":{"version":"2.0"}}"#), ["the scene has no triangles: there is nothing to see"]);
}
