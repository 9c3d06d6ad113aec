//! glTF 2.0, as JSON with files beside it or as one binary GLB.
//!
//! The JSON is read by the `gltf` crate; everything it points at (buffers, views, accessors, indices of all kinds) is
//! checked here, as the crate's own readers trust it. Every glTF primitive becomes a [`Mesh`](crate::Mesh);
//! primitives with the same accessors share one. Every node with a mesh becomes an instance of each of its primitives.
//!
//! Where glTF and raywarp differ:
//! - glTF's texture coordinates have v down, raywarp's v up: `v' = 1 - v`, and texture transforms are turned to match.
//!   Tangents stay as they are: in both, the bitangent points to the top of the picture.
//! - A mesh has one set of texture coordinates: that of the base colour texture, else of the first texture there is.
//! - Materials are physically based, raywarp's follow Phong: see [`phong`]. Sidedness is ignored: all surfaces are seen
//!   from both sides.
//! - Light intensities are in candela and lux, and `Light::color` is what a surface of reflectance 1 sends back: the
//!   intensity over pi.
//! - Skins, morph targets and animations stay in the rest pose.

mod accessor;
mod budget;
mod buffers;
mod cameras;
mod container;
mod extensions;
mod instancing;
mod lights;
mod material;
mod mesh;
mod nodes;
mod origin;
mod phong;
mod texture;
mod topology;
mod uri;

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use ::gltf::json::Root;

use self::budget::Budget;
use self::buffers::Buffers;
use self::origin::Origin;
use super::{LoadError, Sources};
use crate::Scene;

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
    let buffers = Buffers::load(origin, &root, parts.binary, sources)?;
    let budget = Budget::new(bytes.len() + buffers.total_bytes());
    let mut reader = Reader {
        origin,
        root: &root,
        buffers: &buffers,
        sources,
        budget,
        cache: Cache::default(),
        dropped: Dropped::default(),
        scene: Scene::default(),
    };
    reader.warn_about_motion()?;
    nodes::read(&mut reader)?;
    reader.warn_about_numbers()?;
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
}

/// What is left out for numbers that are not finite.
#[derive(Default)]
struct Dropped {
    triangles: usize,
    instances: usize,
}

/// What was read already, by its index in the JSON.
#[derive(Default)]
struct Cache {
    geometry: HashMap<mesh::Geometry, usize>,
    meshes: HashMap<usize, Rc<[mesh::Part]>>,
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

    fn warn_about_numbers(&mut self) -> Result<(), LoadError> {
        let Dropped { triangles, instances } = self.dropped;
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
        if self.root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(|primitive| primitive.targets.is_some()) {
            self.warn("morph targets are not applied: the base shape is shown")?;
        }
        if self.root.nodes.iter().any(|node| node.skin.is_some()) {
            self.warn("skins are not applied: skinned meshes stand as modelled")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
