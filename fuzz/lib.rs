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
        assert!(material.transmission.iter().chain(&material.diffuse).all(|x| x.is_finite() && *x >= 0.0));
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
