//! Which material `usemtl` means.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::load::quote::{file_name, quote};
use crate::load::text::check_encoding;
use crate::load::{mtl, LoadError, Sources};
use crate::{Material, Scene};

/// Beyond these, undefined names are counted only.
const MAX_LISTED: usize = 20;

/// The materials of a file's libraries by name, and what becomes of all other names.
pub(super) struct Materials {
    by_name: HashMap<String, u32>,
    /// Index that the grey default will have.
    fallback: u32,
    fallback_used: bool,
    libraries: Libraries,
    /// First lines and names.
    undefined: Vec<(usize, String)>,
}

enum Libraries {
    Unnamed,
    Read,
    /// Some could not be read, and there was a warning: what they lack needs no further one.
    Incomplete,
}

impl Materials {
    /// Adds all materials of the libraries to the scene. One that cannot be read is a warning.
    pub fn read(
        path: &Path,
        names: &[(usize, String)],
        scene: &mut Scene,
        sources: &mut Sources,
    ) -> Result<Self, LoadError> {
        let mut by_name = HashMap::new();
        let mut libraries = if names.is_empty() { Libraries::Unnamed } else { Libraries::Read };
        let mut read = std::collections::HashSet::new();
        for (line, name) in names {
            if !read.insert(name) {
                continue;
            }
            let library = library(path, name, sources);
            let bytes = sources.bytes(&library).and_then(|bytes| check_encoding(&library, &bytes).map(|()| bytes));
            match bytes {
                Ok(bytes) => mtl::read(&library, &bytes, &mut by_name, scene, sources)?,
                // Nothing stands in for memory.
                Err(error @ LoadError::Memory { .. }) => return Err(error),
                Err(error) => {
                    libraries = Libraries::Incomplete;
                    sources.warn(path, Some(*line), unreadable(name, &error))?;
                }
            }
        }
        let fallback = scene.materials.len() as u32;
        Ok(Self { by_name, fallback, fallback_used: false, libraries, undefined: Vec::new() })
    }

    /// Index of the material of that name, or of the default.
    pub fn named(&mut self, name: String, line: usize) -> u32 {
        if let Some(&index) = self.by_name.get(&name) {
            return index;
        }
        // Blender writes `None` for faces without a material, others an empty name.
        if !name.is_empty() && name != "None" {
            self.undefined.push((line, name.clone()));
        }
        self.by_name.insert(name, self.fallback);
        self.fallback
    }

    /// Index of the grey default.
    pub fn fallback(&self) -> u32 {
        self.fallback
    }

    /// Takes note that a triangle has this material.
    #[inline]
    pub fn note(&mut self, index: u32) {
        self.fallback_used |= index == self.fallback;
    }

    /// Adds the default where it is needed, and reports the names that were not found.
    pub fn finish(self, path: &Path, scene: &mut Scene, sources: &mut Sources) -> Result<(), LoadError> {
        if self.fallback_used {
            scene.materials.push(Material { name: "default".to_owned(), ..Material::default() });
        }
        let Some(&(first, _)) = self.undefined.first() else { return Ok(()) };
        match self.libraries {
            Libraries::Incomplete => Ok(()),
            Libraries::Unnamed => {
                let message =
                    "'usemtl' names materials, but no 'mtllib' names their file; a grey one stands in for them";
                sources.warn(path, Some(first), message)
            }
            Libraries::Read => self.warn_undefined(path, sources),
        }
    }

    fn warn_undefined(&self, path: &Path, sources: &mut Sources) -> Result<(), LoadError> {
        for (line, name) in self.undefined.iter().take(MAX_LISTED) {
            let message = format!(
                "the material {} is not in the file's material libraries; a grey one stands in for it",
                quote(name.as_bytes())
            );
            sources.warn(path, Some(*line), message)?;
        }
        let more = self.undefined.len().saturating_sub(MAX_LISTED);
        if more > 0 {
            sources.warn(path, None, format!("{more} more materials are not in the file's material libraries"))?;
        }
        Ok(())
    }
}

/// A library's file. Quotes around a name are part of it only where there is such a file.
fn library(path: &Path, name: &str, sources: &Sources) -> PathBuf {
    let unquoted = name.strip_prefix('"').and_then(|name| name.strip_suffix('"'));
    let literal = mtl::beside(path, name);
    match unquoted {
        Some(unquoted) if !sources.has(&literal) => mtl::beside(path, unquoted),
        _ => literal,
    }
}

fn unreadable(name: &str, error: &LoadError) -> String {
    let reason = match error {
        LoadError::Io { source, .. } => source.to_string(),
        LoadError::Syntax { read, expected, .. } => format!("{read}; expected {expected}"),
        _ => "it is not a file".to_owned(),
    };
    format!(
        "the material library {} cannot be read: {reason}; a grey material stands in for what it defines",
        file_name(name)
    )
}
