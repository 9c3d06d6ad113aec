//! What OBJ and MTL share: statements, one a line, a keyword and then fields between blanks.

mod number;
mod skipped;
mod statements;

pub(super) use number::{parse_f32, parse_f64, parse_integer};
pub(super) use skipped::{is_keyword, Kind, SkippedStatements, Strays};
pub(super) use statements::{unpadded, Field, Statement, Statements};

use std::path::Path;

use super::{LoadError, Place};

/// Refuses what is no text in ASCII's footsteps, before each of its lines is wrong in its own way.
///
/// # Errors
/// [`LoadError::Syntax`] for UTF-16.
pub(super) fn check_encoding(path: &Path, bytes: &[u8]) -> Result<(), LoadError> {
    if !(bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff])) {
        return Ok(());
    }
    Err(LoadError::Syntax {
        path: path.to_owned(),
        place: Place::Line(1, 1),
        read: "the file is UTF-16".to_owned(),
        expected: "ASCII or UTF-8".to_owned(),
        help: "Save it as UTF-8.".to_owned(),
    })
}
