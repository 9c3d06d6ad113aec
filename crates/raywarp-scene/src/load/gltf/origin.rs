//! The file that errors are about.

use std::path::Path;

use super::super::{LoadError, Place};

/// The glTF file. JSON objects have no line numbers once parsed: messages name them by their path in the JSON.
#[derive(Clone, Copy)]
pub(super) struct Origin<'a> {
    pub path: &'a Path,
}

impl Origin<'_> {
    /// Something breaks the format.
    pub fn broken(self, read: impl Into<String>, expected: impl Into<String>) -> LoadError {
        self.broken_at(Place::File, read, expected)
    }

    /// Something breaks the format at a known place.
    pub fn broken_at(self, place: Place, read: impl Into<String>, expected: impl Into<String>) -> LoadError {
        LoadError::Syntax {
            path: self.path.to_owned(),
            place,
            read: read.into(),
            expected: expected.into(),
            help: "Export the model again, or check the file with the Khronos glTF validator.".to_owned(),
        }
    }

    /// Something is claimed that the file's bytes do not account for.
    pub fn too_large(self, what: impl Into<String>) -> LoadError {
        LoadError::TooLarge {
            path: self.path.to_owned(),
            place: Place::File,
            what: what.into(),
            help: "The file is damaged or made to exhaust memory: export the model again.".to_owned(),
        }
    }
}
