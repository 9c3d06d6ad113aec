//! What can go wrong with a file, as sentences.

use std::fmt;
use std::path::{Path, PathBuf};

use super::quote::printable;
use crate::memory::Shortage;

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line and a column, both from 1.
    Line(usize, usize),
    /// A byte offset, from 0.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(line, column) => write!(f, ":{line}:{column}"),
            Place::Byte(offset) => write!(f, ", byte {offset}"),
        }
    }
}

/// Why a scene could not be read. Shown, it is one line of printable text, whatever the file says.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file could not be opened or read.
    #[error("{}", printable(&format!("cannot read {}: {}. {}", path.display(), source, help)))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
        /// What to do.
        help: String,
    },
    /// The file breaks its format.
    #[error("{}", printable(&format!("{}{}: {}; expected {}. {}", path.display(), place, read, expected, help)))]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What was found, as a phrase: "'f 1 2' has 2 vertices".
        read: String,
        /// What should have been there, as a phrase: "at least 3".
        expected: String,
        /// What to do, a sentence.
        help: String,
    },
    /// The file is right but asks for something that raywarp lacks.
    #[error("{}", printable(&format!("{}{}: {} is not supported. {}", path.display(), place, what, help)))]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// The feature, a noun phrase.
        what: String,
        /// What to do, a sentence.
        help: String,
    },
    /// The file claims more than it can hold, or more than indices can count.
    #[error("{}", printable(&format!("{}{}: {}. {}", path.display(), place, what, help)))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// The claim and the limit, with both numbers.
        what: String,
        /// What to do, a sentence.
        help: String,
    },
    /// What the file holds does not fit in memory.
    #[error("{}", printable(&format!("{}: {what} would not fit: {shortage}", path.display())))]
    Memory {
        /// The file.
        path: PathBuf,
        /// What needs the memory, a noun phrase.
        what: String,
        /// What is needed, and what there is.
        shortage: Shortage,
    },
    /// A file that another one names cannot be used.
    #[error("{}{place} names {name}: {error}", path.display())]
    Named {
        /// The file that names the other.
        path: PathBuf,
        /// Where.
        place: Place,
        /// The name as it stands there, printable.
        name: String,
        /// What is wrong with the other.
        #[source]
        error: Box<LoadError>,
    },
    /// A warning, with [`LoadOptions::strict`](super::LoadOptions::strict).
    #[error("{0} (an error, as reading is strict)")]
    Strict(super::Warning),
}

impl LoadError {
    /// Whether it is said of this file as a whole, and of no place in it.
    pub(crate) fn is_about_all_of(&self, file: &Path) -> bool {
        match self {
            Self::Io { path, .. }
            | Self::Unsupported { path, place: Place::File, .. }
            | Self::TooLarge { path, place: Place::File, .. }
            | Self::Memory { path, .. } => path == file,
            _ => false,
        }
    }

    /// Why a text in TOML, that is no scene file, is not what it should be; `help` is what to do, a sentence.
    pub fn of_toml(path: &Path, text: &str, error: &::toml::de::Error, help: &str) -> Self {
        super::toml::failure(path, text, error, help)
    }

    /// How to say that something of a file does not fit.
    pub(crate) fn memory<'a>(path: &'a Path, what: &'a str) -> impl Fn(Shortage) -> Self + 'a {
        move |shortage| Self::Memory { path: path.to_owned(), what: what.to_owned(), shortage }
    }

    pub(crate) fn unknown_format(path: &Path) -> Self {
        Self::Unsupported {
            path: path.to_owned(),
            place: Place::File,
            what: match path.extension() {
                Some(extension) => format!("the scene format '.{}'", extension.to_string_lossy()),
                None => "a scene file without an extension".to_owned(),
            },
            help: format!("Give a file that ends in .{}.", super::EXTENSIONS.join(", .")),
        }
    }
}
