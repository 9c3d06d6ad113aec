//! Wavefront OBJ: polygons with materials, groups and smoothing.
//!
//! The reader is raywarp's own, as `tobj` knows neither smoothing groups nor texture options, and its errors name
//! neither line nor column.
//!
//! Two passes: the first collects all points, so that faces may come before the points they name; the second cuts the
//! faces into triangles and puts them into one mesh for each object or group name. Free-form curves and surfaces, lines
//! and points are skipped and counted, and so are lines that are no statements of OBJ, as long as there are vertices.

mod corner;
mod elements;
mod materials;
mod meshes;
mod points;

use std::path::Path;

use super::text::check_encoding;
use super::{LoadError, Place, Sources};
use crate::{AlphaMode, Instance, Material, Mesh, Scene, Transform};
use elements::Elements;
use materials::Materials;
use meshes::Meshes;
use points::Points;

/// Below this size no count can pass what a `u32` holds: a corner of a face, the shortest thing counted, is two bytes.
const MAX_BYTES: u64 = 1 << 33;

/// Reads an OBJ file with its material libraries.
pub(super) fn read(path: &Path, sources: &mut Sources) -> Result<Scene, LoadError> {
    let bytes = sources.bytes(path)?;
    check_size(path, bytes.len() as u64)?;
    check_encoding(path, &bytes)?;

    let points = Points::read(path, &bytes, sources.budget())?;
    points.warn(path, sources)?;
    let mut scene = Scene::default();
    let materials = Materials::read(path, &points.libraries, &mut scene, sources)?;

    let fallback_name = path.file_stem().unwrap_or_default().to_string_lossy();
    let meshes = Meshes::new(&points, &fallback_name);
    let elements = Elements::read(path, &bytes, meshes, materials, sources.budget())?;
    elements.warn(path, sources)?;
    let meshes = elements.finish(path, &mut scene, sources)?;
    blend_where_translucent(&meshes, &mut scene.materials);
    place(meshes, &mut scene);
    Ok(scene)
}

/// MTL does not know of vertex colours: where their alpha covers in part, the material has to let what lies behind through.
fn blend_where_translucent(meshes: &[Mesh], materials: &mut [Material]) {
    for mesh in meshes {
        let is_translucent = |vertex: &u32| mesh.colors.get(*vertex as usize).is_some_and(|color| color[3] < 1.0);
        for (triangle, &material) in mesh.triangles.iter().zip(&mesh.materials) {
            let alpha = materials.get_mut(material as usize).map(|material| &mut material.alpha);
            if let Some(alpha) =
                alpha.filter(|alpha| **alpha == AlphaMode::Opaque && triangle.iter().any(is_translucent))
            {
                *alpha = AlphaMode::Blend;
            }
        }
    }
}

/// OBJ has no instances: each mesh is where it is, once.
fn place(meshes: Vec<Mesh>, scene: &mut Scene) {
    let instance = |(mesh, named): (usize, &Mesh)| Instance {
        name: named.name.clone(),
        mesh,
        transform: Transform::IDENTITY,
        material: None,
    };
    scene.instances = meshes.iter().enumerate().map(instance).collect();
    scene.meshes = meshes;
}

fn check_size(path: &Path, size: u64) -> Result<(), LoadError> {
    if size <= MAX_BYTES {
        return Ok(());
    }
    Err(LoadError::TooLarge {
        path: path.to_owned(),
        place: Place::File,
        what: format!("the file has {size} bytes and the limit for OBJ is {MAX_BYTES}"),
        help: "Split it into several files.".to_owned(),
    })
}

#[cfg(test)]
mod tests;
