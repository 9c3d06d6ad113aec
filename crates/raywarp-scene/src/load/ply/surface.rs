//! From vertices and faces to a scene of one mesh.

use std::path::Path;

use super::super::{repair, LoadError, Sources};
use super::faces::Faces;
use super::vertices::Vertices;
use crate::{normals, AlphaMode, Instance, Material, Mesh, Scene, Transform};

/// Diffuse reflectance of the material; vertex colours multiply it.
pub(super) const DIFFUSE: f32 = 0.8;

/// The scene, with a warning for each kind of thing that was dropped.
pub(super) fn assemble(
    path: &Path,
    vertices: Vertices,
    faces: Faces,
    sources: &mut Sources,
) -> Result<Scene, LoadError> {
    if faces.triangles.is_empty() && faces.too_small == 0 {
        let message = format!("{} vertices and no faces: a point cloud shows nothing", vertices.positions.len());
        sources.warn(path, None, message)?;
    }
    if faces.too_small > 0 {
        let message = format!("{} faces have fewer than 3 vertices and were dropped", faces.too_small);
        sources.warn(path, None, message)?;
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut mesh = Mesh {
        name: name.clone(),
        positions: vertices.positions,
        normals: vertices.normals,
        uvs: vertices.uvs,
        second_uvs: Vec::new(),
        colors: vertices.colors,
        tangents: Vec::new(),
        materials: vec![0; faces.triangles.len()],
        triangles: faces.triangles,
    };
    let dropped = repair::drop_non_finite(&mut mesh);
    if dropped > 0 {
        sources.warn(path, None, format!("{dropped} triangles use vertices that are not finite and were dropped"))?;
    }
    match mesh.normals.is_empty() {
        true => normals::smooth(&mut mesh),
        false => mesh.normals.iter_mut().for_each(|normal| *normal = repair::unit_or_zero(*normal)),
    }
    Ok(scene_of(name, mesh))
}

fn scene_of(name: String, mesh: Mesh) -> Scene {
    let translucent = mesh.colors.iter().any(|color| color[3] < 1.0);
    let material = Material {
        name: "default".to_owned(),
        ambient: [DIFFUSE; 3],
        diffuse: [DIFFUSE; 3],
        alpha: if translucent { AlphaMode::Blend } else { AlphaMode::Opaque },
        ..Material::default()
    };
    let instance = Instance { name, mesh: 0, transform: Transform::IDENTITY, material: None };
    Scene { meshes: vec![mesh], instances: vec![instance], materials: vec![material], ..Scene::default() }
}
