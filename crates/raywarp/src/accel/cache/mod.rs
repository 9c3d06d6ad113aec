//! Trees on disk, so that a scene that stays is built once.
//!
//! A file is named after a hash of the triangles, the structure, its quality and the version of the builders, and holds
//! the nodes and the order of the triangles; the triangles themselves are always the caller's. What a file says is
//! believed only after its lengths fit its size, its checksum fits its content and its validation has proved that no
//! link leaves the arrays and no ray can miss a triangle: a file that is cut short, damaged or even forged costs a build
//! and nothing else. It is then written anew.
//!
//! Files are written under another name and renamed, so that several programs may share a directory. Nothing that goes
//! wrong with the disk is an error: the tree is built, and [`Cached::warning`] says what happened.

mod directory;
mod file;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use raywarp_core::triangle::Triangle;

use super::{bvh2_build, Accel, AccelKind, Build, BuildError};

/// Scenes of fewer triangles are built sooner than read.
pub const SMALLEST: usize = 4096;

/// The most that a directory holds unless told otherwise, in bytes.
pub const LIMIT: u64 = 4 << 30;

/// Name of the environment variable with the directory; empty for no cache.
pub const VARIABLE: &str = "RAYWARP_CACHE";

/// A directory of built trees.
#[derive(Clone, Debug)]
pub struct Cache {
    directory: PathBuf,
    limit: u64,
}

impl Cache {
    /// In a directory, which is made when the first tree is kept.
    pub fn at(directory: impl Into<PathBuf>) -> Self {
        Self { directory: directory.into(), limit: LIMIT }
    }

    /// Where `RAYWARP_CACHE` says, or else in the user's directory for caches; nothing if the variable is empty or there
    /// is no such directory.
    pub fn standard() -> Option<Self> {
        match std::env::var_os(VARIABLE) {
            Some(directory) if directory.is_empty() => None,
            Some(directory) => Some(Self::at(directory)),
            None => dirs::cache_dir().map(|caches| Self::at(caches.join("raywarp").join("trees"))),
        }
    }

    /// With room for so many bytes. A tree that is larger is not kept; for others the longest unused ones go.
    pub fn with_limit(self, limit: u64) -> Self {
        Self { limit, ..self }
    }

    /// Where the trees are.
    pub fn directory(&self) -> &Path {
        &self.directory
    }
}

/// A structure, and what the cache had to do with it.
#[derive(Debug)]
pub struct Cached {
    /// The structure, as [`Accel::build`] makes it.
    pub accel: Accel,
    /// Whether it was found on disk.
    pub found: bool,
    /// What went wrong with the disk.
    pub warning: Option<CacheError>,
}

/// Why a tree could not be kept, or an old one not be read. The tree itself is there.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CacheError {
    /// No permission, most likely.
    #[error("the tree in '{}' cannot be read, so it was built again: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's words.
        source: std::io::Error,
    },
    /// A full or read-only disk, most likely.
    #[error(
        "the tree cannot be kept in '{}': {source}; the next run builds it again, unless {VARIABLE} names a directory \
         with room", path.display()
    )]
    Write {
        /// The directory.
        path: PathBuf,
        /// The system's words.
        source: std::io::Error,
    },
}

/// As [`Accel::build`], from `cache` if the same was built before. Only hierarchies of boxes over at least [`SMALLEST`]
/// triangles are kept, and none of [fast](super::Quality::Fast) quality: the others are there sooner than a file.
///
/// # Errors
/// Those of [`Accel::build`]; what the disk does is a warning.
pub fn build_cached(
    what: impl Into<Build>,
    triangles: Vec<Triangle>,
    cache: Option<&Cache>,
) -> Result<Cached, BuildError> {
    let what = what.into();
    let cache = cache.filter(|_| what.kind.is_hierarchy() && triangles.len() >= SMALLEST);
    let (Some(cache), Some(recipe)) = (cache, bvh2_build::recipe(what.quality)) else {
        return Ok(Cached { accel: Accel::build(what, triangles)?, found: false, warning: None });
    };
    // Every layout is made of the same tree.
    let key = file::key(Build { kind: AccelKind::Bvh2, ..what }, &triangles);
    let (tree, unreadable) = match cache.read(key, &triangles) {
        Ok(tree) => (tree, None),
        Err(warning) => (None, Some(warning)),
    };
    if let Some(tree) = tree {
        return Ok(Cached { accel: Accel::laid_out(what.kind, tree)?, found: true, warning: None });
    }
    let (tree, order) = bvh2_build::build_ordered(&triangles, recipe)?;
    let unwritable = cache.write(key, &tree.nodes, &order).err();
    Ok(Cached { accel: Accel::laid_out(what.kind, tree)?, found: false, warning: unwritable.or(unreadable) })
}

/// As [`build_cached`] with the [standard](Cache::standard) cache where the choice asks for it.
///
/// # Errors
/// Those of [`Accel::build`].
pub(crate) fn build(what: Build, triangles: Vec<Triangle>) -> Result<Cached, BuildError> {
    let cache = what.cached.then(Cache::standard).flatten();
    build_cached(what, triangles, cache.as_ref())
}
