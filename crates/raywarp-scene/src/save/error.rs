//! Why a scene cannot be saved, as sentences.

use std::path::PathBuf;

use crate::write::WriteError;
use crate::LoadError;

/// Why a scene could not be saved as a scene file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The name does not end in `.toml`.
    #[error("cannot save the scene as {}: a scene file's name ends in .toml", .0.display())]
    Extension(PathBuf),
    /// The scene was read from the very file.
    #[error("cannot save the scene over {}: the scene is made of it", .0.display())]
    Original(PathBuf),
    /// TOML is UTF-8, and a name in it short.
    #[error("cannot name {} in a scene file: its path is not UTF-8, or too long", .0.display())]
    Name(PathBuf),
    /// The folder of the file, or of the original, cannot be found.
    #[error("cannot find the folder {}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A change that a scene file has no words for.
    #[error("cannot save {what}: a scene file has no words for it")]
    Unsupported {
        /// What changed, a noun phrase.
        what: String,
    },
    /// A number, or several together, that no scene file may hold.
    #[error("the scene as it is now makes no valid scene file. {0}")]
    Range(#[source] Box<LoadError>),
    /// Reading would not give back what was saved.
    #[error("cannot save {what}: reading it again would not give the same")]
    Inexact {
        /// What differs, a noun phrase.
        what: &'static str,
    },
    /// The serialiser failed.
    #[error("cannot write the scene as TOML: {0}")]
    Text(String),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
