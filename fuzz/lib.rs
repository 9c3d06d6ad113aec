//! What the fuzz targets share: files in a folder, read as a program reads them, and what must hold for every scene.
//!
//! Run with `cargo fuzz run --sanitizer none obj`, on stable Rust with `RUSTC_BOOTSTRAP=1`.

use std::cell::OnceCell;
use std::fs;
use std::path::Path;

use raywarp::scene::load::{load, LoadOptions};
use raywarp::scene::{Mesh, Scene};

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// Writes the files, reads the first as a scene and checks it. An error is a legal answer; a panic, a hang or a broken
/// scene is not.
pub fn load_files(files: &[(&str, &[u8])]) {
    FOLDER.with(|cell| {
        let folder = cell.get_or_init(|| tempfile::tempdir().expect("a folder for temporary files"));
        for (name, bytes) in files {
            fs::write(folder.path().join(name), bytes).expect("room for temporary files");
        }
        read_and_check(&folder.path().join(files[0].0));
    });
}

/// Reads a GLB of some JSON and a binary chunk.
pub fn load_glb(json: &str, binary: &[u8]) {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, data, filler) in [(b"JSON", json.as_bytes(), b' '), (b"BIN\0", binary, 0)] {
        let length = data.len().next_multiple_of(4);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
        bytes.resize(bytes.len() + length - data.len(), filler);
    }
    let length = (bytes.len() as u32).to_le_bytes();
    bytes[8..12].copy_from_slice(&length);
    load_files(&[("fuzz.glb", &bytes)]);
}

/// Reads a primitive whose Draco stream these bytes are.
pub fn load_draco(stream: &[u8]) {
    let length = stream.len();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{length}}}],"bufferViews":[{{"buffer":0,"byteLength":{length}}}],
        "accessors":[{{"componentType":5126,"type":"VEC3","count":3}},{{"componentType":5126,"type":"VEC2","count":3}},
        {{"componentType":5125,"type":"SCALAR","count":3}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,
        "TEXCOORD_0":1}},"indices":2,"extensions":{{"KHR_draco_mesh_compression":{{"bufferView":0,"attributes":{{"POSITION":0,
        "TEXCOORD_0":1}}}}}}}}]}}],"nodes":[{{"mesh":0}}]}}"#
    );
    load_glb(&json, stream);
}

/// Reads a view whose meshopt stream these bytes are, after four that say how many elements it has and of what kind.
pub fn load_meshopt(bytes: &[u8]) {
    let Some(([low, high, size, kind], stream)) = bytes.split_first_chunk() else { return };
    let count = usize::from(*low) | usize::from(*high) << 8;
    let stride = 4 * usize::from(*size % 65);
    let modes = ["ATTRIBUTES", "TRIANGLES", "INDICES"];
    let filters = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"];
    let (mode, filter) = (modes[usize::from(kind % 3)], filters[usize::from(kind / 3) % 5]);
    let stride = if mode == "ATTRIBUTES" { stride } else { 2 + 2 * (stride / 4 % 2) };
    let (length, decoded) = (stream.len(), count * stride);
    // Read as positions, be they in the decoded bytes or not.
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{length}}}],"bufferViews":[{{"buffer":0,"byteLength":{decoded},
        "extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteLength":{length},"byteStride":{stride},"count":{count},
        "mode":"{mode}","filter":"{filter}"}}}}}}],"accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3",
        "count":{elements}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{{"mesh":0}}]}}"#,
        elements = decoded / 12
    );
    load_glb(&json, stream);
}

fn read_and_check(path: &Path) {
    match load(path, &LoadOptions::default()) {
        Ok(loaded) => {
            check(&loaded.scene);
            loaded.warnings.iter().chain(&loaded.notes).for_each(|warning| check_message(&warning.to_string()));
        }
        Err(error) => check_message(&error.to_string()),
    }
}

/// One line of bounded length that no terminal obeys.
fn check_message(message: &str) {
    assert!(message.len() < 2000, "a message of {} bytes", message.len());
    assert!(!message.contains(char::is_control), "a control character in {message:?}");
}

/// The invariants that the scene's documentation promises.
pub fn check(scene: &Scene) {
    let materials = scene.materials.len();
    scene.meshes.iter().for_each(|mesh| check_mesh(mesh, materials));
    for instance in &scene.instances {
        assert!(instance.mesh < scene.meshes.len());
        assert!(instance.material.is_none_or(|material| (material as usize) < materials));
    }
    for material in &scene.materials {
        let maps = [material.diffuse_map, material.specular_map, material.emission_map, material.opacity_map];
        assert!(maps.iter().flatten().all(|map| (map.image as usize) < scene.images.len()));
        assert!((0.0..=1.0).contains(&material.opacity) && material.ior.is_finite());
        let colors = material.transmission.iter().chain(&material.diffuse).chain(&material.absorption);
        assert!(colors.clone().all(|x| x.is_finite() && *x >= 0.0));
    }
    for image in &scene.images {
        assert!(image.width > 0 && image.height > 0);
        assert_eq!(image.texels.len() as u64, u64::from(image.width) * u64::from(image.height));
    }
}

fn check_mesh(mesh: &Mesh, materials: usize) {
    let vertices = mesh.positions.len();
    assert!(mesh.normals.is_empty() || mesh.normals.len() == vertices);
    assert!(mesh.uvs.is_empty() || mesh.uvs.len() == vertices);
    assert!(mesh.second_uvs.is_empty() || mesh.second_uvs.len() == vertices);
    assert!(mesh.colors.is_empty() || mesh.colors.len() == vertices);
    assert!(mesh.tangents.is_empty() || mesh.tangents.len() == vertices);
    assert_eq!(mesh.materials.len(), mesh.triangles.len());
    assert!(mesh.materials.iter().all(|&material| (material as usize) < materials));
    for triangle in &mesh.triangles {
        assert!(triangle.iter().all(|&vertex| (vertex as usize) < vertices));
        assert!(triangle.iter().all(|&vertex| mesh.positions[vertex as usize].iter().all(|x| x.is_finite())));
    }
    assert!(mesh.colors.iter().flatten().all(|channel| channel.is_finite() && *channel >= 0.0));
    for normal in &mesh.normals {
        let square: f32 = normal.iter().map(|x| x * x).sum();
        assert!(square == 0.0 || (square - 1.0).abs() < 1e-3, "a normal {normal:?}");
    }
}
