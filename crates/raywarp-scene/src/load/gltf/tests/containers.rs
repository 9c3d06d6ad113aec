use super::*;

const IN_CHUNK: &str = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":36}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]}"#;

fn corners() -> Vec<u8> {
    triangle_positions().3
}

fn glb_refusal(bytes: &[u8]) -> String {
    let (path, result) = load_named("f.glb", &[("f.glb", bytes)]);
    without_folder(&path, result.unwrap_err())
}

#[test]
fn a_glb_holds_json_and_bytes() {
    let bytes = glb(IN_CHUNK, Some(&corners()));
    for name in ["f.glb", "f.gltf"] {
        let loaded = load_named(name, &[(name, &bytes)]).1.unwrap();
        assert_eq!(loaded.scene.meshes[0].triangles, [[0, 1, 2]]);
    }
}

#[test]
fn files_beside_the_json_are_found_by_percent_decoded_names() {
    let json = IN_CHUNK.replace(r#"{"byteLength":36}]"#, r#"{"byteLength":36,"uri":"my%20data.bin"}]"#);
    let loaded = load_named("f.gltf", &[("f.gltf", json.as_bytes()), ("my data.bin", &corners())]).1.unwrap();
    assert_eq!(loaded.scene.meshes[0].positions[1], [1.0, 0.0, 0.0]);
}

#[test]
fn missing_buffers_are_named() {
    let message = refusal(&IN_CHUNK.replace(r#"{"byteLength":36}]"#, r#"{"byteLength":36,"uri":"none.bin"}]"#));
    assert!(message.contains("none.bin: No such file") || message.contains("none.bin"), "{message}");
    assert_eq!(
        refusal(IN_CHUNK),
        "F: buffers[0], which bufferViews[0] reads, has no uri; expected a uri, or the first buffer of a GLB with a binary chunk. \
         Export the model again, or check the file with the Khronos glTF validator."
    );
}

#[test]
fn short_buffers_are_refused_with_both_lengths() {
    let message = glb_refusal(&glb(IN_CHUNK, Some(&corners()[..32])));
    assert!(message.starts_with("F: buffers[0] has 32 bytes; expected its byteLength of 36."), "{message}");
}

#[test]
fn broken_glbs_are_refused_at_a_byte() {
    let whole = glb(IN_CHUNK, Some(&corners()));
    let with = |place: usize, value: u8| {
        let mut bytes = whole.clone();
        bytes[place] = value;
        bytes
    };
    let cases = [
        (whole[..7].to_vec(), "F, byte 4: the file ends after 7 bytes; expected a whole GLB header."),
        (with(4, 1), "F, byte 4: GLB version 1; expected version 2."),
        (with(11, 1), "F, byte 8: a length of"),
        (with(15, 1), "F, byte 12: a chunk of"),
        (with(16, b'X'), "F, byte 16: the first chunk is not JSON; expected a chunk of type 'JSON'."),
    ];
    for (bytes, start) in cases {
        let message = glb_refusal(&bytes);
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn broken_json_is_refused_at_its_place() {
    let message = refusal("{\"asset\":\n  {\"version\" \"2.0\"}}");
    assert!(message.starts_with("F:2:14: expected `:`; expected the JSON of glTF 2.0."), "{message}");
    let message = glb_refusal(&glb("{\"asset\":\n  nothing}", None));
    assert!(message.starts_with("F, byte 33: expected ident; expected the JSON"), "{message}");
    let message = refusal("");
    assert!(message.starts_with("F:1:1: EOF while parsing"), "{message}");
    let message = refusal("{}");
    assert!(message.starts_with("F:1:2: missing field `asset`"), "{message}");
}

#[test]
fn other_versions_are_refused() {
    let message = refusal(r#"{"asset":{"version":"1.0"},"buffers":{}}"#);
    assert!(message.starts_with("F: asset.version '1.0'; expected version 2.0."), "{message}");
    let message = refusal(r#"{"asset":{"version":1},"buffers":{}}"#);
    assert!(message.starts_with("F: asset.version 1; expected version 2.0."), "{message}");
}

#[test]
fn required_extensions_that_are_missing_are_named_with_a_way_out() {
    let message = |name: &str| {
        // What else is wrong may follow from it: the extension has to be the one reported.
        refusal(&format!(r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["{name}"],"meshes":7}}"#))
    };
    assert_eq!(
        message("KHR_texture_basisu"),
        "F: the extension KHR_texture_basisu, which the file requires, is not supported. \
         Export the model again with PNG or JPEG textures instead of KTX2."
    );
    assert!(message("ACME_new").ends_with("Export the model again without it."));
}

#[test]
fn extensions_that_are_merely_used_are_a_warning() {
    let used = r#","extensionsUsed":["KHR_materials_clearcoat","KHR_materials_ior"]"#;
    assert_eq!(warnings(&triangle(used)), ["the extension KHR_materials_clearcoat is ignored"]);
}

#[test]
fn a_surface_that_is_not_known_is_a_warning_even_where_it_is_required() {
    let required = r#","extensionsUsed":["KHR_materials_sheen"],"extensionsRequired":["KHR_materials_sheen","ACME_materials_fur"]"#;
    assert_eq!(
        warnings(&triangle(required)),
        ["the extension KHR_materials_sheen is ignored", "the extension ACME_materials_fur is ignored"]
    );
}

#[test]
fn extensions_that_only_annotate_are_no_warning() {
    let used = r#","extensionsUsed":["EXT_structural_metadata","EXT_mesh_features","KHR_xmp_json_ld","MSFT_lod"],
        "extensionsRequired":["EXT_instance_features"]"#;
    assert_eq!(warnings(&triangle(used)), [""; 0]);
}

#[test]
fn foreign_schemes_are_refused() {
    let message = refusal(&IN_CHUNK.replace(r#"{"byteLength":36}]"#, r#"{"byteLength":36,"uri":"https://x/y"}]"#));
    assert!(message.starts_with("F: the scheme 'https' in the URI of buffers[0] is not supported. Put"), "{message}");
}

#[test]
fn data_uris_that_are_not_base64_are_refused() {
    let uri = |uri: &str| refusal(&IN_CHUNK.replace(r#"36}]"#, &format!(r#"36,"uri":"{uri}"}}]"#)));
    let message = uri("data:x;base64,AA!A");
    assert!(message.starts_with("F: buffers[0] has '!' at character 2 of its data; expected base64."), "{message}");
    let message = uri("data:x;base64");
    assert!(message.starts_with("F: buffers[0] has the URI 'data:x;base64'; expected a comma"), "{message}");
}
