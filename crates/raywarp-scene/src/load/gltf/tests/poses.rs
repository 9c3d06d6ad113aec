//! Skins and morph targets in the pose that the file opens with.

use super::*;

const UBYTE: u32 = 5121;

/// The triangle bound to the joints of a skin: accessors 1 to 3 are joints, weights and two inverse bind matrices.
fn skinned(primitive: &str, nodes: &str, skin: &str) -> String {
    let mut inverses = [0.0; 32];
    for column in 0..4 {
        inverses[5 * column] = 1.0;
        inverses[16 + 5 * column] = 1.0;
    }
    // The second joint was bound at x = 5.
    inverses[16 + 12] = -5.0;
    let pieces = [
        triangle_positions(),
        (UBYTE, "VEC4", 3, vec![0, 0, 0, 0, 0, 1, 0, 0, 1, 7, 7, 7], ""),
        (UBYTE, "VEC4", 3, vec![255, 0, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0], r#","normalized":true"#),
        (FLOAT, "MAT4", 2, floats(&inverses), ""),
    ];
    file(&pieces, primitive, &format!(r#","skins":[{skin}]"#))
        .replace(r#""nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]"#, &format!(r#""nodes":[{nodes}]"#))
}

const SKINNED: &str = r#"{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}"#;
/// The mesh's node is moved, which does not count; joints at x = 10 and, below it, y = 2.
const NODES: &str = r#"{"mesh":0,"skin":0,"translation":[0,100,0]},{"translation":[10,0,0],"children":[2]},
    {"translation":[0,2,0]}"#;
const SKIN: &str = r#"{"joints":[1,2],"inverseBindMatrices":3}"#;

#[test]
fn joints_alone_place_a_skinned_mesh() {
    let scene = scene(&skinned(SKINNED, NODES, SKIN));
    assert_eq!(scene.instances[0].transform, crate::Transform::IDENTITY);
    // The first joint moves by (10, 0, 0), the second by (10, 2, 0) - (5, 0, 0); the second vertex is halfway.
    assert_eq!(scene.meshes[0].positions, [[10.0, 0.0, 0.0], [8.5, 1.0, 0.0], [5.0, 3.0, 0.0]]);
}

#[test]
fn without_inverse_bind_matrices_the_mesh_is_at_each_joint() {
    let scene = scene(&skinned(SKINNED, NODES, r#"{"joints":[1,2]}"#));
    assert_eq!(scene.meshes[0].positions[2], [10.0, 3.0, 0.0]);
}

#[test]
fn a_primitive_without_joints_goes_with_its_node() {
    let scene = scene(&skinned(PRIMITIVE, NODES, SKIN));
    assert_eq!(scene.instances[0].transform.translation, [0.0, 100.0, 0.0]);
}

#[test]
fn nodes_of_one_mesh_and_different_skins_are_different_meshes() {
    let nodes = format!(r#"{NODES},{{"mesh":0,"skin":1}},{{"mesh":0,"skin":0}},{{"mesh":0}}"#);
    let scene = scene(&skinned(SKINNED, &nodes, &format!(r#"{SKIN},{{"joints":[2,1]}}"#)));
    assert_eq!(scene.instances.iter().map(|instance| instance.mesh).collect::<Vec<_>>(), [0, 1, 0, 2]);
    assert_eq!(scene.meshes[2].positions, scene_of_the_triangle().meshes[0].positions);
}

fn scene_of_the_triangle() -> Scene {
    scene(&triangle(""))
}

#[test]
fn broken_skins_are_refused() {
    let cases = [
        (
            SKIN,
            r#"{"joints":[1]}"#,
            "F: meshes[0].primitives[0] uses joint 1 of skins[0]; expected one below 1, the number",
        ),
        (SKIN, r#"{"joints":[1,9]}"#, "F: skins[0] uses nodes[9]; expected an index below 3, the number of nodes."),
        (
            SKIN,
            r#"{"joints":[1,2],"inverseBindMatrices":0}"#,
            "F: accessors[0], used by skins[0], has 3 components; expected 16.",
        ),
        (
            SKIN,
            r#"{"joints":[1,2,1],"inverseBindMatrices":3}"#,
            "F: accessors[3], used by skins[0], has 2 elements; expected 3, one for each joint.",
        ),
        (r#""skin":0"#, r#""skin":4"#, "F: a node uses skins[4]; expected an index below 1, the number of skins."),
    ];
    for (from, to, start) in cases {
        let message = refusal(&skinned(SKINNED, NODES, SKIN).replace(from, to));
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn joints_that_descend_from_themselves_end() {
    let nodes = r#"{"mesh":0,"skin":0},{"children":[2]},{"children":[1]}"#;
    let json =
        skinned(SKINNED, nodes, SKIN).replace(r#""nodes":[{"mesh""#, r#""scenes":[{"nodes":[0]}],"nodes":[{"mesh""#);
    assert_eq!(scene(&json).meshes[0].positions[0], [0.0; 3]);
}

fn morphed(weights: &str, node: &str) -> Scene {
    let pieces = [
        triangle_positions(),
        (FLOAT, "VEC3", 3, floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), ""),
        (FLOAT, "VEC3", 3, floats(&[0.0, 0.0, 1.0].repeat(3)), ""),
    ];
    let primitive = r#"{"attributes":{"POSITION":0},"targets":[{"POSITION":1},{"POSITION":2}]}"#;
    let json = file(&pieces, primitive, "").replace(r#"{"mesh":0}"#, &format!(r#"{{"mesh":0{node}}}"#));
    scene(&json.replace(r#"{"name":"shape""#, &format!(r#"{{"name":"shape"{weights}"#)))
}

#[test]
fn morph_targets_are_added_by_the_weights_of_the_mesh() {
    assert_eq!(morphed("", "").meshes[0].positions[1], [1.0, 0.0, 0.0]);
    assert_eq!(morphed(r#","weights":[1]"#, "").meshes[0].positions[1], [2.0, 0.0, 0.0]);
    assert_eq!(morphed(r#","weights":[0.5,3]"#, "").meshes[0].positions[1], [1.5, 0.0, 3.0]);
}

#[test]
fn the_weights_of_a_node_come_before_those_of_its_mesh() {
    let scene = morphed(r#","weights":[1,0]"#, r#","weights":[0,1]},{"mesh":0},{"mesh":0"#);
    assert_eq!(scene.instances.len(), 1, "the others are not in the scene");
    assert_eq!(scene.meshes[0].positions[1], [1.0, 0.0, 1.0]);
}
