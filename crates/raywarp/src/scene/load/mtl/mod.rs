//! Wavefront MTL.
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::{LoadError, Sources};
use crate::scene::Scene;

pub(super) fn beside(path: &Path, name: &str) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(name.replace('\\', "/"))
}

pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    by_name: &mut HashMap<String, u32>,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<(), LoadError> {
    let _ = (path, bytes, by_name, scene, sources);
    Ok(())
}
