use super::*;
use proptest::prelude::*;

const POSITION_ACCESSOR: &str = r#"{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}"#;

/// The triangle with its accessor written otherwise.
fn with_accessor(accessor: &str) -> String {
    let json = triangle("");
    assert!(json.contains(POSITION_ACCESSOR));
    json.replace(POSITION_ACCESSOR, accessor)
}

#[test]
fn accessors_beyond_their_bytes_are_refused() {
    let cases = [
        (
            r#"{"bufferView":0,"componentType":5126,"type":"VEC3","count":4}"#,
            "F: accessors[0] has 4 elements of 12 bytes, 12 apart, from byte 0; expected a part of its view of 36 bytes.",
        ),
        (
            r#"{"bufferView":0,"byteOffset":18446744073709551615,"componentType":5126,"type":"VEC3","count":3}"#,
            "F: accessors[0] has 3 elements of 12 bytes, 12 apart, from byte 18446744073709551615; expected",
        ),
        (
            r#"{"bufferView":0,"componentType":5126,"type":"VEC3","count":18446744073709551615}"#,
            "F: accessors[0] claims 18446744073709551615 elements, and 4294967294 is the limit.",
        ),
        (
            r#"{"componentType":5126,"type":"VEC3","count":4000000000}"#,
            "F: 445 bytes of files unfold to more than the limit of 67123104 bytes.",
        ),
        (
            r#"{"bufferView":7,"componentType":5126,"type":"VEC3","count":3}"#,
            "F: accessors[0] uses bufferViews[7]; expected an index below 1, the number of views.",
        ),
        (
            r#"{"bufferView":0,"componentType":5127,"type":"VEC3","count":3}"#,
            "F: accessors[0] has a wrong componentType; expected 5120 to 5126.",
        ),
        (
            r#"{"bufferView":0,"componentType":5126,"type":"MAT4","count":1}"#,
            "F: accessors[0] has 1 elements of 64 bytes, 64 apart, from byte 0; expected a part of its view of 36 bytes.",
        ),
        (
            r#"{"bufferView":0,"componentType":5126,"type":"VEC2","count":3}"#,
            "F: accessors[0], used by meshes[0].primitives[0], has 2 components; expected 3.",
        ),
    ];
    for (accessor, start) in cases {
        let message = refusal(&with_accessor(accessor));
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn sparse_indices_are_checked() {
    let sparse = |count: usize, offset: usize| {
        with_accessor(&format!(
            r#"{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"sparse":{{"count":{count},
            "indices":{{"bufferView":0,"byteOffset":{offset},"componentType":5121}},"values":{{"bufferView":0}}}}}}"#
        ))
    };
    let message = refusal(&sparse(2, 0));
    assert!(
        message.starts_with("F: the sparse indices of accessors[0] are out of order or of range; expected"),
        "{message}"
    );
    let message = refusal(&sparse(1, 15));
    assert!(message.contains("expected increasing indices below 3"), "63 is too large: {message}");
    assert!(refusal(&sparse(1000, 0)).starts_with("F: accessors[0] has 1000 elements of 1 bytes, 1 apart"));
}

#[test]
fn indices_that_lead_nowhere_are_refused() {
    let cases = [
        (
            r#""POSITION":0"#,
            r#""POSITION":9"#,
            "F: meshes[0].primitives[0] uses accessors[9]; expected an index below 1",
        ),
        (r#"{"mesh":0}"#, r#"{"mesh":5}"#, "F: a node uses meshes[5]; expected an index below 1"),
        (r#"{"mesh":0}"#, r#"{"camera":5}"#, "F: a node uses cameras[5]; expected an index below 0"),
        (r#""nodes":[0]"#, r#""nodes":[3]"#, "F: nodes[3] is a child or a root; expected an index below 1"),
        (r#"[{"nodes":[0]}]"#, r#"[{"nodes":[0]}],"scene":2"#, "F: scene is 2; expected an index below 1"),
        (r#"{"POSITION":0}"#, r#"{"POSITION":0},"material":1"#, "F: a primitive uses materials[1]; expected an index"),
        (
            r#"{"POSITION":0}"#,
            r#"{"POSITION":0},"mode":9"#,
            "F: meshes[0].primitives[0] has a wrong mode; expected 0 to 6.",
        ),
        (r#""buffer":0"#, r#""buffer":4"#, "F: bufferViews[0] uses buffers[4]; expected an index below 1"),
        (
            r#""byteOffset":0,"byteLength":36"#,
            r#""byteOffset":8,"byteLength":36"#,
            "F: bufferViews[0] has 36 bytes from byte 8; expected a part of the 36 bytes of buffers[0].",
        ),
        (
            r#"{"mesh":0}"#,
            r#"{"mesh":0,"extensions":{"KHR_lights_punctual":{"light":1}}}"#,
            "F: a node uses lights[1]; expected an index below 0, the number of lights.",
        ),
    ];
    for (from, to, start) in cases {
        let json = triangle("");
        assert!(json.contains(from), "{from}");
        let message = refusal(&json.replace(from, to));
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn vertex_indices_and_counts_are_checked() {
    let indices = |component, data: Vec<u8>| {
        let piece: Piece = (component, "SCALAR", 3, data, "");
        refusal(&file(&[triangle_positions(), piece], r#"{"attributes":{"POSITION":0},"indices":1}"#, ""))
    };
    let message = indices(5121, vec![0, 1, 3]);
    assert!(
        message.starts_with(
            "F: index 3 at place 2 of meshes[0].primitives[0]; expected an index below 3, the number of positions."
        ),
        "{message}"
    );
    assert!(indices(FLOAT, floats(&[0.0; 3])).contains("are floats; expected unsigned integers"));

    let normals: Piece = (FLOAT, "VEC3", 2, floats(&[0.0; 6]), "");
    let message = refusal(&file(&[triangle_positions(), normals], r#"{"attributes":{"POSITION":0,"NORMAL":1}}"#, ""));
    assert!(message.contains("has 2 elements; expected 3, one for each position."), "{message}");
}

#[test]
fn many_views_of_the_same_bytes_are_refused_in_the_end() {
    // Each primitive reads one buffer through accessors of its own: memory would grow by the square.
    let count = 100_000;
    let accessor = format!(r#"{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{count}}}"#);
    let accessors = vec![accessor; 60].join(",");
    let primitives: Vec<String> = (0..60).map(|index| format!(r#"{{"attributes":{{"POSITION":{index}}}}}"#)).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":1200000,"uri":"data.bin"}}],
        "bufferViews":[{{"buffer":0,"byteLength":1200000}}],"accessors":[{accessors}],
        "meshes":[{{"primitives":[{}]}}],"nodes":[{{"mesh":0}}]}}"#,
        primitives.join(",")
    );
    let zeros = vec![0; 1_200_000];
    let (path, result) = load_named("f.gltf", &[("f.gltf", json.as_bytes()), ("data.bin", &zeros)]);
    let message = without_folder(&path, result.unwrap_err());
    assert!(message.contains("bytes of files unfold to more than the limit of"), "{message}");
}

#[test]
fn strict_reading_makes_warnings_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.gltf");
    std::fs::write(&path, r#"{"asset":{"version":"2.0"}}"#).unwrap();
    assert!(matches!(load(&path, &LoadOptions { strict: true }), Err(LoadError::Strict(_))));
}

/// A GLB with every kind of object that is read.
fn everything() -> Vec<u8> {
    let mut binary = triangle_positions().3;
    binary.extend(floats(&[0.0, 0.0, 1.0].repeat(3)));
    binary.extend(floats(&[0.5; 6]));
    binary.extend([0, 1, 2, 0]);
    let json = r#"{"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual","EXT_mesh_gpu_instancing"],
        "buffers":[{"byteLength":100}],"bufferViews":[{"buffer":0,"byteLength":100},{"buffer":0,"byteOffset":36,
        "byteLength":64},{"buffer":0,"byteOffset":96,"byteLength":4}],
        "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"sparse":{"count":1,
        "indices":{"bufferView":2,"byteOffset":1,"componentType":5121},"values":{"bufferView":0}}},
        {"bufferView":1,"componentType":5126,"type":"VEC3","count":3},
        {"bufferView":1,"byteOffset":36,"componentType":5126,"type":"VEC2","count":3},
        {"bufferView":2,"componentType":5121,"type":"SCALAR","count":3},
        {"componentType":5121,"type":"VEC4","count":3},{"componentType":5126,"type":"VEC4","count":3}],
        "skins":[{"joints":[1]}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":
        {"rotation":1}}},"metallicRoughnessTexture":{"index":0}},"alphaMode":"BLEND","normalTexture":{"index":0},
        "extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5},"KHR_materials_ior":{"ior":1.4}}}],
        "textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],"images":[{"bufferView":1}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"JOINTS_0":4,"WEIGHTS_0":5},
        "indices":3,"material":0,"targets":[{"POSITION":1,"NORMAL":0}]},{"attributes":{"POSITION":1},"mode":5}],
        "weights":[0.5]}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],
        "nodes":[{"mesh":0,"skin":0,"camera":0,"children":[1],"rotation":[0,0,0,1]},{"mesh":0,"extensions":{
        "EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}},"KHR_lights_punctual":{"light":0}}}],
        "scenes":[{"nodes":[0]}],"scene":0,"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{}}]}}}"#;
    glb(json, Some(&binary))
}

fn load_mutated(bytes: &[u8]) -> Result<Loaded, LoadError> {
    load_named("f.glb", &[("f.glb", bytes)]).1
}

#[test]
fn the_file_that_is_mutated_is_sound() {
    let loaded = load_mutated(&everything()).unwrap();
    assert_eq!((loaded.scene.instances.len(), loaded.scene.lights.len(), loaded.scene.cameras.len()), (8, 1, 1));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_bytes_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::weighted(0.2, any::<prop::sample::Index>()),
    ) {
        let mut bytes = everything();
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = load_mutated(&bytes);
    }

    /// Digits in the place of digits: the JSON stays sound and what it says goes wrong.
    #[test]
    fn mutated_numbers_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 1..6),
    ) {
        let mut bytes = everything();
        let digits: Vec<usize> = (20..bytes.len() - 108).filter(|&place| bytes[place].is_ascii_digit()).collect();
        for (place, digit) in changes {
            bytes[digits[place.index(digits.len())]] = digit;
        }
        let _ = load_mutated(&bytes);
    }
}

#[test]
fn a_long_name_that_many_nodes_show_is_refused() {
    let name = "n".repeat(1 << 20);
    let json = triangle("").replace("shape", &name);
    let json = json.replace(r#"{"mesh":0}"#, &vec![r#"{"mesh":0}"#; 200].join(","));
    let json = json.replace(r#""scenes":[{"nodes":[0]}]"#, r#""extras":0"#);
    assert!(refusal(&json).contains("unfold to more than the limit"));
}
