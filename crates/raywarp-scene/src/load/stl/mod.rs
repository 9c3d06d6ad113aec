//! STL: triangles and hardly anything else, as text or in binary.
//!
//! Each solid becomes a mesh with one instance, its vertices unified and its facets flat: their normals follow from their
//! corners, so the stated ones are not needed. The material is a matt grey. Binary files may colour facets, in one of two
//! ways: see [`binary`]. STL has neither units nor an axis that is up; coordinates are taken as they stand.
//!
//! The reader is raywarp's own: that of the crate `stl_io` (0.8) says neither line nor byte of an error, and knows
//! neither colours nor a second solid.

mod ascii;
mod binary;
mod solid;

use std::path::Path;

use self::solid::Solid;
use super::precision::Rounding;
use super::text::check_encoding;
use super::{repair, LoadError, Sources};
use crate::{AlphaMode, Instance, Material, Mesh, Scene, Transform};

/// What a file holds, whichever form it has.
struct Contents {
    solids: Vec<Solid>,
    rounding: Rounding,
    /// Warnings, with their lines.
    warnings: Vec<(Option<usize>, String)>,
}

/// Reads an STL file.
///
/// # Errors
/// [`LoadError::Io`] for an unreadable file, [`LoadError::TooLarge`] for more triangles than the file has room for,
/// [`LoadError::Syntax`] for everything else.
pub(super) fn read(path: &Path, sources: &mut Sources) -> Result<Scene, LoadError> {
    let bytes = sources.bytes(path)?;
    check_encoding(path, &bytes)?;
    // Text begins with `solid`, but so do some binary files: the size of those tells.
    let contents = match !binary::has_its_size(&bytes) && ascii::is_text(&bytes) {
        true => ascii::read(path, &bytes, sources.budget())?,
        false => binary::read(path, &bytes, sources.budget())?,
    };
    for (line, message) in contents.warnings {
        sources.warn(path, line, message)?;
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut meshes: Vec<Mesh> = contents.solids.into_iter().filter_map(|solid| solid.finish(&stem)).collect();
    contents.rounding.tell(path, meshes.iter().flat_map(|mesh| mesh.positions.iter().copied()), sources);
    let dropped: usize = meshes.iter_mut().map(repair::drop_non_finite).sum();
    if dropped > 0 {
        sources.warn(path, None, format!("{dropped} triangles use vertices that are not finite and were dropped"))?;
    }
    if meshes.is_empty() {
        sources.warn(path, None, "the file has no triangles: there is nothing to see")?;
        return Ok(Scene::default());
    }
    Ok(scene_of(meshes))
}

/// Diffuse reflectance, as in PLY: vertex colours multiply it.
const DIFFUSE: f32 = 0.8;

fn scene_of(meshes: Vec<Mesh>) -> Scene {
    let is_translucent = meshes.iter().flat_map(|mesh| &mesh.colors).any(|color| color[3] < 1.0);
    let material = Material {
        name: "default".to_owned(),
        ambient: [DIFFUSE; 3],
        diffuse: [DIFFUSE; 3],
        alpha: if is_translucent { AlphaMode::Blend } else { AlphaMode::Opaque },
        ..Material::default()
    };
    let instance = |(mesh, named): (usize, &Mesh)| Instance {
        name: named.name.clone(),
        mesh,
        transform: Transform::IDENTITY,
        material: None,
    };
    let instances = meshes.iter().enumerate().map(instance).collect();
    Scene { meshes, instances, materials: vec![material], ..Scene::default() }
}

#[cfg(test)]
mod tests;
