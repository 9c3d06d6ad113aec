use super::*;
use crate::{NormalMap, UvSet};

const BYTE: u32 = 5120;
const UBYTE: u32 = 5121;
const USHORT: u32 = 5123;
const UINT: u32 = 5125;

fn square() -> Piece<'static> {
    (FLOAT, "VEC3", 4, floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]), "")
}

#[test]
fn a_primitive_is_a_mesh_and_an_instance() {
    let scene = scene(&triangle(""));
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.name, "shape");
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(mesh.materials, [0]);
    assert!(mesh.normals.is_empty(), "without normals a mesh is flat");
    assert!(mesh.uvs.is_empty() && mesh.tangents.is_empty() && mesh.colors.is_empty());
    assert_eq!((scene.instances.len(), scene.instances[0].name.as_str()), (1, "shape"));
    assert_eq!(scene.materials[0].name, "default");
}

#[test]
fn indices_of_all_types_and_modes_are_read() {
    let wide = |values: &[u32], size: usize| values.iter().flat_map(|v| v.to_le_bytes()[..size].to_vec()).collect();
    for (component, size) in [(UBYTE, 1), (USHORT, 2), (UINT, 4)] {
        for (mode, expected) in [(4, vec![[0, 1, 2]]), (5, vec![[0, 1, 2], [1, 3, 2]]), (6, vec![[1, 2, 0], [2, 3, 0]])]
        {
            let indices: Piece = (component, "SCALAR", 4, wide(&[0, 1, 2, 3], size), "");
            let primitive = format!(r#"{{"attributes":{{"POSITION":0}},"indices":1,"mode":{mode}}}"#);
            assert_eq!(scene(&file(&[square(), indices], &primitive, "")).meshes[0].triangles, expected);
        }
    }
}

#[test]
fn points_and_lines_are_one_warning() {
    let primitives =
        format!(r#"{{"attributes":{{"POSITION":0}},"mode":0}},{{"attributes":{{"POSITION":0}},"mode":3}},{PRIMITIVE}"#);
    assert_eq!(
        warnings(&file(&[triangle_positions()], &primitives, "")),
        ["2 primitives of points or lines are left out"]
    );
}

#[test]
fn attributes_are_converted() {
    let pieces = [
        triangle_positions(),
        (FLOAT, "VEC3", 3, floats(&[0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]), ""),
        (FLOAT, "VEC4", 3, floats(&[2.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]), ""),
        (
            USHORT,
            "VEC2",
            3,
            [0u16, 0, 65535, 0, 0, 65535].iter().flat_map(|v| v.to_le_bytes()).collect(),
            r#","normalized":true"#,
        ),
        (UBYTE, "VEC3", 3, vec![255, 0, 51, 0, 0, 0, 255, 255, 255], r#","normalized":true"#),
    ];
    // Elements of three bytes are four apart in a file by the book; the view here is packed, which is read all the same.
    let primitive = r#"{"attributes":{"POSITION":0,"NORMAL":1,"TANGENT":2,"TEXCOORD_0":3,"COLOR_0":4}}"#;
    let mesh = scene(&file(&pieces, primitive, "")).meshes.remove(0);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0], [0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(mesh.tangents[0], [1.0, 0.0, 0.0, -1.0]);
    assert_eq!(mesh.uvs, [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]], "v up");
    assert_eq!(mesh.colors[0], [1.0, 0.0, 0.2, 1.0]);
}

#[test]
fn quantized_positions_are_read() {
    let positions: Piece = (BYTE, "VEC3", 3, vec![0, 0, 0, 0x80, 0, 0, 0, 127, 0], r#","normalized":true"#);
    let json = file(&[positions], PRIMITIVE, r#","extensionsRequired":["KHR_mesh_quantization"]"#);
    assert_eq!(scene(&json).meshes[0].positions, [[0.0; 3], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn strides_offsets_and_sparse_values_are_followed() {
    // Positions 16 bytes apart from byte 4; the second one is replaced.
    let mut bytes = floats(&[9.0, 0.0, 0.0, 0.0, 9.0, 1.0, 0.0, 0.0, 9.0, 0.0, 1.0, 0.0]);
    bytes.extend(floats(&[5.0, 6.0, 7.0]));
    bytes.push(1);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":61,"uri":"{}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48,"byteStride":16}},{{"buffer":0,"byteOffset":48,"byteLength":13}}],
        "accessors":[{{"bufferView":0,"byteOffset":4,"componentType":5126,"type":"VEC3","count":3,"sparse":{{"count":1,
        "indices":{{"bufferView":1,"byteOffset":12,"componentType":5121}},"values":{{"bufferView":1}}}}}},
        {{"componentType":5126,"type":"VEC2","count":3}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}}}}]}}],"nodes":[{{"mesh":0}}]}}"#,
        data_uri(&bytes)
    );
    let mesh = scene(&json).meshes.remove(0);
    assert_eq!(mesh.positions, [[0.0, 0.0, 0.0], [5.0, 6.0, 7.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.uvs, [[0.0, 1.0]; 3], "an accessor without a view is zeros");
}

#[test]
fn a_missing_attribute_of_one_primitive_leaves_the_others_alone() {
    let normals: Piece = (FLOAT, "VEC3", 3, floats(&[0.0, 0.0, 1.0].repeat(3)), "");
    let primitives = format!(r#"{PRIMITIVE},{{"attributes":{{"POSITION":0,"NORMAL":1}}}}"#);
    let scene = scene(&file(&[triangle_positions(), normals], &primitives, ""));
    assert_eq!(scene.meshes.iter().map(|mesh| mesh.normals.len()).collect::<Vec<_>>(), [0, 3]);
    assert_eq!(scene.instances.len(), 2);
}

#[test]
fn shared_geometry_is_one_mesh_with_other_materials() {
    let primitives = r#"{"attributes":{"POSITION":0},"material":0},{"attributes":{"POSITION":0},"material":1}"#;
    let scene = scene(&file(&[triangle_positions()], primitives, r#","materials":[{"name":"a"},{"name":"b"}]"#));
    assert_eq!((scene.meshes.len(), scene.materials.len()), (1, 2));
    assert_eq!(scene.instances.iter().map(|i| i.material).collect::<Vec<_>>(), [None, Some(1)]);
}

#[test]
fn primitives_copy_only_the_vertices_they_use() {
    let indices: Piece = (UBYTE, "SCALAR", 3, vec![3, 1, 2], "");
    let mesh = scene(&file(&[square(), indices], r#"{"attributes":{"POSITION":0},"indices":1}"#, "")).meshes.remove(0);
    assert_eq!(mesh.positions, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(mesh.triangles, [[2, 0, 1]]);
}

#[test]
fn positions_that_are_not_finite_drop_their_triangles() {
    let positions: Piece =
        (FLOAT, "VEC3", 4, floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, f32::NAN, 0.0, 0.0]), "");
    let indices: Piece = (UBYTE, "SCALAR", 6, vec![0, 1, 2, 1, 2, 3], "");
    let json = file(&[positions, indices], r#"{"attributes":{"POSITION":0},"indices":1}"#, "");
    let loaded = load_json(&json);
    assert_eq!(loaded.scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(loaded.warnings[0].message, "1 triangles use positions that are not finite and were dropped");
}

#[test]
fn two_sets_of_texture_coordinates_are_kept() {
    let set = |value: f32| -> Piece { (FLOAT, "VEC2", 3, floats(&[value; 6]), "") };
    let pieces = [triangle_positions(), set(0.0), set(1.0), set(0.5), set(0.25)];
    let primitive =
        r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2,"TEXCOORD_2":3,"TEXCOORD_3":4},"material":0}"#;
    let read = |base: &str, emissive: &str, normal: &str| {
        let material = format!(
            r#","materials":[{{"name":"m","pbrMetallicRoughness":{{"baseColorTexture":{{"index":0{base}}}}},"emissiveFactor":
            [1,1,1],"emissiveTexture":{{"index":0{emissive}}},"normalTexture":{{"index":0{normal}}}}}],"textures":[{{"source":0}}],
            "images":[{{"uri":"data:image/png;base64,{}"}}]"#,
            base64(&one_texel())
        );
        load_json(&file(&pieces, primitive, &material))
    };
    let sets = |loaded: &Loaded| {
        let material = &loaded.scene.materials[0];
        let Some(NormalMap::Tangent { texture: normal, .. }) = material.normal_map else { panic!("a normal map") };
        [material.diffuse_map, material.emission_map, Some(normal)].map(|map| map.unwrap().uv_set)
    };
    let (one, both) = (read("", "", ""), read("", r#","texCoord":1"#, ""));
    assert_eq!((one.scene.meshes[0].uvs[0], one.scene.meshes[0].second_uvs.len()), ([0.0, 1.0], 0));
    assert_eq!((both.scene.meshes[0].uvs[0], both.scene.meshes[0].second_uvs[0]), ([0.0, 1.0], [1.0, 0.0]));
    assert_eq!(sets(&both), [UvSet::First, UvSet::Second, UvSet::First]);
    let transformed = read(r#","extensions":{"KHR_texture_transform":{"texCoord":1}}"#, "", "");
    assert_eq!(sets(&transformed), [UvSet::Second, UvSet::First, UvSet::First]);

    let others = read(r#","texCoord":3"#, r#","texCoord":2"#, r#","texCoord":3"#);
    assert_eq!((others.scene.meshes[0].uvs[0], others.scene.meshes[0].second_uvs[0]), ([0.25, 0.75], [0.5, 0.5]));
    assert_eq!((sets(&others), others.warnings.len()), ([UvSet::First, UvSet::Second, UvSet::First], 0));
    let many = read("", r#","texCoord":2"#, r#","texCoord":3"#);
    assert_eq!(
        many.warnings[0].message,
        "material 'm' uses 3 sets of texture coordinates: all but two are taken for TEXCOORD_0"
    );
}

/// A picture.
fn one_texel() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(1, 1).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[test]
fn colors_of_vertices_are_from_zero_to_one() {
    let colors: Piece = (FLOAT, "VEC3", 3, floats(&[5.0, -1.0, f32::NAN, 0.5, 1.0, 0.0, 1.0, 1.0, 1.0]), "");
    let json = file(&[triangle_positions(), colors], r#"{"attributes":{"POSITION":0,"COLOR_0":1}}"#, "");
    assert_eq!(scene(&json).meshes[0].colors[..2], [[1.0, 0.0, 0.0, 1.0], [0.5, 1.0, 0.0, 1.0]]);
}

#[test]
fn animations_are_one_warning() {
    let json = triangle(r#","animations":[{"channels":[],"samplers":[]},{"channels":[],"samplers":[]}]"#);
    assert_eq!(warnings(&json), ["2 animations are not played: the rest pose is shown"]);
}
