//! What can go wrong with a file of rays, as sentences.

use std::fmt;
use std::io;

/// A place in a file of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// A byte from the start, counted from 0.
    Byte(u64),
    /// A line, counted from 1.
    Line(u64),
    /// A line and a column of numbers, both counted from 1.
    Column(u64, usize),
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Column(line, column) => write!(f, "line {line}, column {column}"),
        }
    }
}

/// Why rays could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RayFileError {
    /// The system cannot read it.
    #[error("cannot read {name}: {source}")]
    Io {
        /// The file.
        name: String,
        /// The system's reason.
        source: io::Error,
    },
    /// It is not what it should be.
    #[error("{name}: {at}: {what}")]
    Content {
        /// The file.
        name: String,
        /// Where.
        at: At,
        /// What was read, what was expected, and what to do.
        what: String,
    },
}

/// What goes wrong while reading, before the file's name is known.
pub(super) enum Trouble {
    Io(io::Error),
    Flaw(At, String),
}

impl From<io::Error> for Trouble {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Trouble {
    pub fn flaw(at: At, what: impl Into<String>) -> Self {
        Self::Flaw(at, what.into())
    }

    pub fn in_file(self, name: &str) -> RayFileError {
        let name = name.to_owned();
        match self {
            Self::Io(source) => RayFileError::Io { name, source },
            Self::Flaw(at, what) => RayFileError::Content { name, at, what },
        }
    }
}
