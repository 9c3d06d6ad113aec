//! Small files written by hand: JSON with data URIs.

use std::path::{Path, PathBuf};

use crate::load::{load, LoadError, LoadOptions, Loaded};
use crate::Scene;

mod compressed;
mod containers;
mod geometry;
mod hostile;
mod materials;
mod placement;
mod poses;
mod validity;

fn load_named(name: &str, files: &[(&str, &[u8])]) -> (PathBuf, Result<Loaded, LoadError>) {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let path = folder.path().join(name);
    let result = load(&path, &LoadOptions::default());
    (path, result)
}

fn load_json(json: &str) -> Loaded {
    load_named("f.gltf", &[("f.gltf", json.as_bytes())]).1.unwrap()
}

/// The scene of a file that gives no warnings.
fn scene(json: &str) -> Scene {
    let loaded = load_json(json);
    assert_eq!(loaded.warnings, [], "no warnings");
    loaded.scene
}

/// Messages of the warnings.
fn warnings(json: &str) -> Vec<String> {
    load_json(json).warnings.into_iter().map(|warning| warning.message).collect()
}

fn notes(json: &str) -> Vec<String> {
    load_json(json).notes.into_iter().map(|note| note.message).collect()
}

fn without_folder(path: &Path, error: LoadError) -> String {
    error.to_string().replace(&path.display().to_string(), "F")
}

/// The message of the error, the path of the file replaced by F.
fn refusal(json: &str) -> String {
    let (path, result) = load_named("f.gltf", &[("f.gltf", json.as_bytes())]);
    without_folder(&path, result.unwrap_err())
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let bits = group.iter().fold(0u32, |bits, &byte| bits << 8 | u32::from(byte)) << (8 * (3 - group.len()));
        for digit in 0..4 {
            let wanted = digit <= group.len();
            text.push(if wanted { DIGITS[(bits >> (18 - 6 * digit) & 63) as usize] as char } else { '=' });
        }
    }
    text
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", base64(bytes))
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// One accessor to be written: component type, type, count, bytes, further JSON.
type Piece<'a> = (u32, &'a str, usize, Vec<u8>, &'a str);

/// `buffers`, `bufferViews` and `accessors`, one view an accessor.
fn tables(pieces: &[Piece]) -> String {
    let mut bytes = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    for (component, kind, count, data, more) in pieces {
        views.push(format!(r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#, bytes.len(), data.len()));
        accessors.push(format!(
            r#"{{"bufferView":{},"componentType":{component},"type":"{kind}","count":{count}{more}}}"#,
            accessors.len()
        ));
        bytes.extend_from_slice(data);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    format!(
        r#""buffers":[{{"byteLength":{},"uri":"{}"}}],"bufferViews":[{}],"accessors":[{}]"#,
        bytes.len(),
        data_uri(&bytes),
        views.join(","),
        accessors.join(",")
    )
}

const FLOAT: u32 = 5126;

fn triangle_positions() -> Piece<'static> {
    (FLOAT, "VEC3", 3, floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]), "")
}

/// A file with some pieces, one mesh of the given primitives, a node, and further JSON.
fn file(pieces: &[Piece], primitives: &str, more: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},{},"meshes":[{{"name":"shape","primitives":[{primitives}]}}],
        "nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}]{more}}}"#,
        tables(pieces)
    )
}

const PRIMITIVE: &str = r#"{"attributes":{"POSITION":0}}"#;

/// One triangle.
fn triangle(more: &str) -> String {
    file(&[triangle_positions()], PRIMITIVE, more)
}

/// A GLB of JSON and a binary chunk.
fn glb(json: &str, binary: Option<&[u8]>) -> Vec<u8> {
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8], filler: u8| {
        let length = data.len().next_multiple_of(4);
        out.extend_from_slice(&(length as u32).to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(data);
        out.resize(out.len() + length - data.len(), filler);
    };
    chunk(b"JSON", json.as_bytes(), b' ');
    if let Some(binary) = binary {
        chunk(b"BIN\0", binary, 0);
    }
    let length = (out.len() as u32).to_le_bytes();
    out[8..12].copy_from_slice(&length);
    out
}
