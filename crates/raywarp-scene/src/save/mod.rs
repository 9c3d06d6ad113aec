//! Back to a file: what an edited scene has that the file it was read from has not, as a scene file on that one.
//!
//! Reading the new file gives the edited scene to the bit: numbers are written so that they come back as they were, and
//! the text is read again before it is handed out.
//!
//! ```
//! use std::path::Path;
//! use raywarp_scene::{load, save};
//!
//! let loaded = load::builtin()?;
//! let mut now = loaded.scene.outline();
//! now.lights[0].color = [1.0, 0.5, 0.25];
//! let text = save::to_toml(&save::Original::BuiltIn, &loaded.scene, &now, Path::new("mine.toml"))?;
//! assert!(text.contains("color = [1, 0.5, 0.25]"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod changes;
mod entries;
mod error;
mod name;
mod number;
mod parameters;

use std::path::{Path, PathBuf};

use super::load::{toml as reader, Loaded, BUILT_IN};
use super::Scene;
use changes::Changes;
use entries::{Base, File};
pub use error::SaveError;

/// What a scene was read from.
#[derive(Clone, Copy, Debug)]
pub enum Original<'a> {
    /// The scene that is part of the program.
    BuiltIn,
    /// A file.
    File {
        /// The file that was given to [`load`](super::load::load()).
        path: &'a Path,
        /// All files of the scene, [`Loaded::files`]: none of them is overwritten.
        files: &'a [PathBuf],
    },
}

impl<'a> Original<'a> {
    /// Of a scene that was loaded: from a path, or without one the built-in scene.
    pub fn of(path: Option<&'a Path>, loaded: &'a Loaded) -> Self {
        match path {
            Some(path) => Self::File { path, files: &loaded.files },
            None => Self::BuiltIn,
        }
    }
}

/// The text of a scene file at `target` that names the original and holds the differences between the scene as it was
/// `read` and as it is `now`: materials, transforms of instances, lights, cameras, background, ambient light, and defaults
/// for rendering. Geometry and images are not looked at: [`Scene::outline`] has all that this needs.
///
/// The folder of `target` has to exist, as the original is named relative to it.
///
/// # Errors
/// [`SaveError`] where the target is no scene file or one that the scene is made of, where a scene file cannot say what
/// differs, and where a number is out of the range that a scene file allows.
pub fn to_toml(original: &Original, read: &Scene, now: &Scene, target: &Path) -> Result<String, SaveError> {
    name::check_target(original, target)?;
    let base = match original {
        Original::BuiltIn => BUILT_IN.to_owned(),
        Original::File { path, .. } => name::relative(path, target)?,
    };
    let changes = Changes::between(read, now)?;
    let text = text(File::new(Base::new(base, &changes), changes))?;
    let again = reader::applied(target, &text, read.outline()).map_err(|error| SaveError::Range(Box::new(error)))?;
    match Changes::between(&again, now)?.first() {
        None => Ok(text),
        Some(what) => Err(SaveError::Inexact { what }),
    }
}

/// As [`to_toml`], into the file, which at any moment is what it was before or whole.
///
/// # Errors
/// As [`to_toml`], and [`SaveError::Write`].
pub fn to_file(original: &Original, read: &Scene, now: &Scene, target: &Path) -> Result<(), SaveError> {
    let text = to_toml(original, read, now, target)?;
    Ok(crate::write::file(target, text.as_bytes())?)
}

const HEAD: &str = "# Starts from the base and holds what differs from it; docs/scene-file.md describes every key.\n";

fn text(file: File) -> Result<String, SaveError> {
    let body = toml::to_string(&file).map_err(|error| SaveError::Text(error.to_string()))?;
    Ok(format!("{HEAD}{body}"))
}
