//! The files behind a scene: opened with limits, warned about once.

use std::collections::HashSet;
use std::fmt;
use std::path::{Path, PathBuf};

use super::error::Place;
use super::images::ImageIndices;
use super::LoadError;

/// How forgiving reading is.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoadOptions {
    /// Warnings are errors.
    pub strict: bool,
}

/// Something that is not as the file asks, and what was done instead.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Warning {
    /// The file that asks.
    pub path: PathBuf,
    /// Where it asks.
    pub line: Option<usize>,
    /// What is wrong and what was done, a sentence without the full stop.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}", self.message)
    }
}

/// What the readers share while one scene is read.
pub struct Sources {
    options: LoadOptions,
    warnings: Vec<Warning>,
    seen: HashSet<Warning>,
    pub(super) images: ImageIndices,
}

impl Sources {
    /// No file read yet.
    pub fn new(options: &LoadOptions) -> Self {
        Self { options: *options, warnings: Vec::new(), seen: HashSet::new(), images: ImageIndices::default() }
    }

    /// Records a warning, the same one only once.
    ///
    /// # Errors
    /// [`LoadError::Strict`] where warnings are errors.
    pub fn warn(&mut self, path: &Path, line: Option<usize>, message: impl Into<String>) -> Result<(), LoadError> {
        let warning = Warning { path: path.to_owned(), line, message: message.into() };
        if self.options.strict {
            return Err(LoadError::Strict(warning));
        }
        if self.seen.insert(warning.clone()) {
            self.warnings.push(warning);
        }
        Ok(())
    }

    /// The whole file.
    ///
    /// # Errors
    /// [`LoadError::Io`] for a missing or unreadable file, [`LoadError::Unsupported`] for what is no regular file: a
    /// directory holds nothing to read, and a pipe or a device might never end.
    pub fn bytes(&self, path: &Path) -> Result<Vec<u8>, LoadError> {
        let failed = |source: std::io::Error| LoadError::Io {
            path: path.to_owned(),
            help: help_for(&source).to_owned(),
            source,
        };
        let metadata = std::fs::metadata(path).map_err(failed)?;
        if !metadata.is_file() {
            return Err(not_a_file(path, metadata.is_dir()));
        }
        std::fs::read(path).map_err(failed)
    }

    /// What was recorded, in order.
    pub fn into_warnings(self) -> Vec<Warning> {
        self.warnings
    }
}

fn not_a_file(path: &Path, is_directory: bool) -> LoadError {
    let (what, help) = if is_directory {
        ("a directory as a scene", "Name the scene file inside it.")
    } else {
        ("a pipe or a device as a scene", "Write it to a file first.")
    };
    LoadError::Unsupported { path: path.to_owned(), place: Place::File, what: what.to_owned(), help: help.to_owned() }
}

fn help_for(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::NotFound => "Check the path.",
        std::io::ErrorKind::PermissionDenied => "Check the file's permissions.",
        _ => "Check the file and the disk.",
    }
}
