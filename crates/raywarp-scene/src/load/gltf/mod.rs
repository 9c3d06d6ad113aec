//! glTF 2.0, as JSON with files beside it or as one binary GLB.
//!
//! The JSON is read by the `gltf` crate; everything it points at (buffers, views, accessors, indices of all kinds) is
//! checked here, as the crate's own readers trust it. Every glTF primitive becomes a [`Mesh`](crate::Mesh);
//! primitives with the same accessors share one. Every node with a mesh becomes an instance of each of its primitives.
//!
//! Where glTF and raywarp differ:
//! - glTF's texture coordinates have v down, raywarp's v up: `v' = 1 - v`, and texture transforms are turned to match.
//!   Tangents stay as they are: in both, the bitangent points to the top of the picture.
//! - A mesh keeps two sets of texture coordinates: TEXCOORD_0 and 1, or the first two that its material reads.
//! - Materials are physically based, raywarp's follow Phong: see [`phong`].
//! - Light intensities are in candela and lux, and `Light::color` is what a surface of reflectance 1 sends back: the
//!   intensity over pi.
//! - Skinned and morphed meshes are read in the pose that the file opens with, and each pose is a mesh of its own, skinned
//!   ones in world space. Animations are not played.

mod accessor;
mod attributes;
mod budget;
mod buffers;
mod cameras;
mod container;
mod decoded;
mod draco;
mod extensions;
mod instancing;
mod lights;
mod material;
mod mended;
mod mesh;
mod meshopt;
mod nodes;
mod origin;
mod phong;
mod physical;
mod places;
mod pose;
mod skin;
mod texture;
mod topology;
mod uri;

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use ::gltf::json::Root;
use glam::DAffine3;

use self::budget::Budget;
use self::buffers::Buffers;
use self::origin::Origin;
use super::precision::Rounding;
use super::{LoadError, Sources};
use crate::{Scene, Transform};

/// Reads a glTF file with the buffers and pictures it names.
///
/// # Errors
/// [`LoadError::Io`] for unreadable files, [`LoadError::Unsupported`] for extensions that the file requires and raywarp
/// lacks, [`LoadError::TooLarge`] for more geometry than the bytes of the file account for, [`LoadError::Syntax`] for
/// everything else.
pub(super) fn read(path: &Path, sources: &mut Sources) -> Result<Scene, LoadError> {
    let origin = Origin { path };
    let bytes = sources.bytes(path)?;
    let parts = container::split(origin, &bytes)?;
    let root = container::parse(origin, &parts, sources)?;
    let mut buffers = Buffers::load(origin, &root, parts.binary, sources)?;
    let mut budget = Budget::new(bytes.len() + buffers.total_bytes(), sources.budget().clone());
    decoded::read(origin, &root, &mut buffers, &mut budget)?;
    let mut reader = Reader {
        origin,
        root: &root,
        buffers: &buffers,
        sources,
        budget,
        cache: Cache::default(),
        dropped: Dropped::default(),
        scene: Scene::default(),
        rounding: places::rounding(parts.json),
    };
    reader.warn_about_motion()?;
    nodes::read(&mut reader)?;
    reader.warn_about_dropped()?;
    Ok(reader.scene)
}

/// What the stages share while one file is read.
struct Reader<'a> {
    origin: Origin<'a>,
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    sources: &'a mut Sources,
    budget: Budget,
    cache: Cache,
    dropped: Dropped,
    scene: Scene,
    /// Of the places of nodes.
    rounding: Rounding,
}

/// What is left out, by number.
#[derive(Default)]
struct Dropped {
    /// Primitives that are not triangles.
    points_and_lines: usize,
    /// Primitives without positions.
    without_positions: usize,
    /// With positions that are not finite.
    triangles: usize,
    /// With placements that are not finite.
    instances: usize,
}

/// What was read already, by its index in the JSON.
#[derive(Default)]
struct Cache {
    geometry: HashMap<mesh::Geometry, usize>,
    meshes: HashMap<(usize, pose::Pose), Rc<[mesh::Part]>>,
    skins: HashMap<usize, Rc<[Transform]>>,
    /// Where each node is in the world, once a skin asks.
    worlds: Option<Rc<[DAffine3]>>,
    /// `None` is the material of primitives without one.
    materials: HashMap<Option<usize>, material::Known>,
    images: HashMap<usize, u32>,
    /// Mean texels of pictures.
    means: HashMap<usize, [f32; 4]>,
}

impl Reader<'_> {
    fn warn(&mut self, message: impl Into<String>) -> Result<(), LoadError> {
        self.sources.warn(self.origin.path, None, message)
    }

    /// A copy of a name, on the budget: a long one may be asked for many times.
    fn copy_name(&mut self, name: &str) -> Result<String, LoadError> {
        self.budget.take(self.origin, name.len(), 1)?;
        Ok(name.to_owned())
    }

    fn warn_about_dropped(&mut self) -> Result<(), LoadError> {
        let Dropped { points_and_lines, without_positions, triangles, instances } = self.dropped;
        if points_and_lines > 0 {
            self.warn(format!("{points_and_lines} primitives of points or lines are left out"))?;
        }
        if without_positions > 0 {
            self.warn(format!("{without_positions} primitives without positions are left out"))?;
        }
        if triangles > 0 {
            self.warn(format!("{triangles} triangles use positions that are not finite and were dropped"))?;
        }
        if instances > 0 {
            self.warn(format!("{instances} placements of meshes are not finite and were dropped"))?;
        }
        Ok(())
    }

    fn warn_about_motion(&mut self) -> Result<(), LoadError> {
        let count = self.root.animations.len();
        if count > 0 {
            self.warn(format!("{count} animations are not played: the rest pose is shown"))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
