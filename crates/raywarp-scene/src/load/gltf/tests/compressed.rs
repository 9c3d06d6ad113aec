//! Geometry compressed by Draco and by meshopt.

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, MeshEncoder, PointAttribute,
};
use meshoptimizer_rs::codec::{self, ExpMode, IndexEncoding, VertexEncoding};
use meshoptimizer_rs::Workspace;

use super::*;

/// Vertices along each side of the grid.
const SIDE: usize = 9;

fn grid_positions() -> Vec<[f32; 3]> {
    let at = |i: usize| i as f32 / (SIDE - 1) as f32;
    (0..SIDE * SIDE).map(|v| [at(v % SIDE), at(v / SIDE), at(v % SIDE) * at(v / SIDE)]).collect()
}

fn grid_triangles() -> Vec<[u32; 3]> {
    let corners = (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (y * SIDE + x) as u32));
    let side = SIDE as u32;
    corners.flat_map(|v| [[v, v + 1, v + side], [v + 1, v + side + 1, v + side]]).collect()
}

fn bytes_of(vectors: &[[f32; 3]]) -> Vec<u8> {
    floats(&vectors.concat())
}

/// The grid as Draco encodes it at a speed, which picks the way of encoding: from 10 on one after the other, else by
/// edgebreaker.
fn draco_stream(speed: i32) -> Vec<u8> {
    let (positions, triangles) = (grid_positions(), grid_triangles());
    let mut mesh = draco_core::Mesh::new();
    let attribute = |kind, lanes, values: &[u8]| {
        let mut attribute = PointAttribute::new();
        attribute.init(kind, lanes, DataType::Float32, false, positions.len());
        attribute.buffer_mut().write(0, values);
        attribute
    };
    mesh.set_num_points(positions.len());
    mesh.add_attribute(attribute(GeometryAttributeType::Position, 3, &bytes_of(&positions)));
    let uvs: Vec<f32> = positions.iter().flat_map(|p| [p[0], p[1]]).collect();
    mesh.add_attribute(attribute(GeometryAttributeType::TexCoord, 2, &floats(&uvs)));
    mesh.set_num_faces(triangles.len());
    for (index, triangle) in triangles.iter().enumerate() {
        mesh.set_face(FaceIndex(index as u32), triangle.map(Into::into));
    }
    let mut options = EncoderOptions::new();
    options.set_global_int("encoding_speed", speed);
    options.set_global_int("decoding_speed", speed);
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    encoder.encode(&options, &mut buffer).unwrap();
    buffer.data().to_vec()
}

/// A GLB whose only view is a Draco stream.
fn with_draco(stream: &[u8]) -> Vec<u8> {
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_draco_mesh_compression"],
        "extensionsRequired":["KHR_draco_mesh_compression"],"buffers":[{{"byteLength":{length}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}}],"accessors":[{{"componentType":5126,"type":"VEC3","count":81}},
        {{"componentType":5126,"type":"VEC2","count":81}},{{"componentType":5123,"type":"SCALAR","count":384}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"extensions":
        {{"KHR_draco_mesh_compression":{{"bufferView":0,"attributes":{{"POSITION":0,"TEXCOORD_0":1}}}}}}}}]}}],
        "nodes":[{{"mesh":0}}]}}"#,
        length = stream.len()
    );
    glb(&json, Some(stream))
}

fn load_glb(bytes: &[u8]) -> Result<Loaded, String> {
    let (path, result) = load_named("f.glb", &[("f.glb", bytes)]);
    result.map_err(|error| without_folder(&path, error))
}

/// The area of a mesh, whichever way its vertices are numbered.
fn area(mesh: &crate::Mesh) -> f32 {
    let corner = |v: u32| glam::Vec3::from(mesh.positions[v as usize]);
    let areas =
        mesh.triangles.iter().map(|&[a, b, c]| 0.5 * (corner(b) - corner(a)).cross(corner(c) - corner(a)).length());
    areas.sum()
}

#[test]
fn draco_is_decoded() {
    let expected = crate::Mesh { positions: grid_positions(), triangles: grid_triangles(), ..Default::default() };
    for speed in [0, 5, 10] {
        let loaded = load_glb(&with_draco(&draco_stream(speed))).unwrap();
        let mesh = &loaded.scene.meshes[0];
        assert_eq!((loaded.warnings.len(), mesh.triangles.len(), mesh.uvs.len()), (0, 128, mesh.positions.len()));
        assert!((area(mesh) - area(&expected)).abs() < 1e-2, "{} and {}", area(mesh), area(&expected));
        // v is up here, and down in the file.
        let uvs = mesh.positions.iter().zip(&mesh.uvs);
        assert!(uvs.clone().all(|(p, uv)| (p[0] - uv[0]).abs() < 1e-2 && (1.0 - p[1] - uv[1]).abs() < 1e-2));
    }
}

#[test]
fn a_stream_that_is_not_draco_is_refused_by_name() {
    let message = load_glb(&with_draco(&[0; 60])).unwrap_err();
    assert!(
        message.starts_with("F: the Draco stream of meshes[0].primitives[0] cannot be decoded: ")
            && message.contains("expected a triangle mesh of Draco 2.2."),
        "{message}"
    );
    let cut = draco_stream(5);
    assert!(load_glb(&with_draco(&cut[..cut.len() / 2])).is_err());
}

#[test]
fn what_is_there_uncompressed_is_not_decoded() {
    let json = triangle("").replace(
        r#"{"POSITION":0}"#,
        r#"{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}"#,
    );
    assert_eq!(scene(&json).meshes[0].triangles, [[0, 1, 2]]);
}

/// A GLB of the grid: positions and indices compressed by meshopt, in a buffer that only claims to be there.
fn with_meshopt(version: u8, name: &str, positions: &[u8], filter: &str) -> Vec<u8> {
    let triangles = grid_triangles();
    let workspace = &mut Workspace::default();
    let vertices =
        codec::encode_vertex_buffer(positions, SIDE * SIDE, 12, VertexEncoding::new(version, 2).unwrap(), workspace);
    let vertices = vertices.unwrap();
    let indices = codec::encode_index_buffer(&triangles.concat(), IndexEncoding::new(1).unwrap(), workspace).unwrap();
    let start = vertices.len().next_multiple_of(4);
    let mut binary = vertices.clone();
    binary.resize(start, 0);
    binary.extend(&indices);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["{name}"],"extensionsRequired":["{name}"],
        "buffers":[{{"byteLength":{total}}},{{"byteLength":1740,"extensions":{{"{name}":{{"fallback":true}}}}}}],
        "bufferViews":[{{"buffer":1,"byteLength":972,"byteStride":12,"extensions":{{"{name}":{{"buffer":0,"byteLength":{first},
        "byteStride":12,"count":81,"mode":"ATTRIBUTES","filter":"{filter}"}}}}}},
        {{"buffer":1,"byteOffset":972,"byteLength":768,"extensions":{{"{name}":{{"buffer":0,"byteOffset":{start},
        "byteLength":{second},"byteStride":2,"count":384,"mode":"TRIANGLES"}}}}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":81}},
        {{"bufferView":1,"componentType":5123,"type":"SCALAR","count":384}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"nodes":[{{"mesh":0}}]}}"#,
        total = binary.len(),
        first = vertices.len(),
        second = indices.len()
    );
    glb(&json, Some(&binary))
}

#[test]
fn meshopt_is_decoded() {
    let positions = grid_positions();
    for (version, name) in [(0, "EXT_meshopt_compression"), (1, "KHR_meshopt_compression")] {
        let loaded = load_glb(&with_meshopt(version, name, &bytes_of(&positions), "NONE")).unwrap();
        let mesh = &loaded.scene.meshes[0];
        assert_eq!(mesh.positions, positions);
        assert_eq!(mesh.triangles.len(), grid_triangles().len());
        let around = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        let sorted = |triangles: &[[u32; 3]]| {
            let mut sorted: Vec<_> = triangles.iter().map(|&triangle| around(triangle)).collect();
            sorted.sort();
            sorted
        };
        assert_eq!(sorted(&mesh.triangles), sorted(&grid_triangles()), "the codec may turn a triangle");
    }
}

#[test]
fn filters_of_meshopt_are_undone() {
    let positions = grid_positions();
    let filtered = codec::encode_filter_exp(
        positions.len(),
        12,
        15,
        &positions.concat(),
        ExpMode::Separate,
        &mut Workspace::default(),
    );
    let bytes = with_meshopt(0, "EXT_meshopt_compression", &filtered.unwrap(), "EXPONENTIAL");
    let loaded = load_glb(&bytes).unwrap();
    let mesh = &loaded.scene.meshes[0];
    let near = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
    assert!(mesh.positions.iter().zip(&positions).all(|(a, b)| near(a, b)));
}

#[test]
fn broken_meshopt_is_refused_by_name() {
    let whole = with_meshopt(0, "EXT_meshopt_compression", &bytes_of(&grid_positions()), "NONE");
    let changed = |from: &str, to: &str| {
        let length = u32::from_le_bytes([whole[12], whole[13], whole[14], whole[15]]) as usize;
        let json = std::str::from_utf8(&whole[20..20 + length]).unwrap();
        assert!(json.contains(from), "{json}");
        load_glb(&glb(&json.replace(from, to), Some(&whole[20 + length + 8..]))).unwrap_err()
    };
    let cases = [
        (
            "ATTRIBUTES",
            "ATTRIBUTE",
            "F: bufferViews[0] cannot be decoded: invalid parameter; expected 81 elements of 12",
        ),
        (r#""filter":"NONE""#, r#""filter":"OCT""#, "F: bufferViews[0] cannot be decoded: invalid parameter; expected"),
        (
            r#""mode":"TRIANGLES""#,
            r#""mode":"ATTRIBUTES""#,
            "F: bufferViews[1] cannot be decoded: invalid vertex layout",
        ),
        (
            r#""count":81,"mode""#,
            r#""count":810000000,"mode""#,
            "F: 1936 bytes of files decode to 810000000 elements of 12",
        ),
        (
            r#""byteStride":12,"count":81"#,
            r#""byteStride":"x","count":81"#,
            "F: the meshopt compression of bufferViews[0]",
        ),
    ];
    for (from, to, start) in cases {
        let message = changed(from, to);
        assert!(message.starts_with(start), "{message}");
    }
}
