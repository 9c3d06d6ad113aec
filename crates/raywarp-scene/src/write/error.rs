//! What can go wrong with a file that is written, as sentences.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// There is a directory of that name.
    #[error("cannot write {}: it is a directory", .0.display())]
    Directory(PathBuf),
    /// The directory for the file is missing.
    #[error("cannot write {}: there is no directory {}", path.display(), directory.display())]
    NoDirectory {
        /// The file.
        path: PathBuf,
        /// The directory that is missing.
        directory: PathBuf,
    },
    /// No right to write there.
    #[error("cannot write {}: {source}", path.display())]
    Denied {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: Error,
    },
    /// No room.
    #[error("cannot write {}: the disk is full ({bytes} bytes are needed)", path.display())]
    Full {
        /// The file.
        path: PathBuf,
        /// Size of the file.
        bytes: u64,
    },
    /// The same run reads the file.
    #[error("cannot write {}: {}", path.display(), is_read(path, read))]
    Read {
        /// The file.
        path: PathBuf,
        /// The name that it is read by.
        read: PathBuf,
    },
    /// The same run writes the file under this or another name.
    #[error("{}", written_twice(path, other))]
    Twice {
        /// The file.
        path: PathBuf,
        /// Its other name.
        other: PathBuf,
    },
    /// There is something of that name already, and it was not to be replaced.
    #[error("cannot write {}: there is one already", .0.display())]
    Exists(PathBuf),
    /// Any other failure of the file system.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: Error,
    },
}

fn is_read(path: &Path, read: &Path) -> String {
    if path == read {
        "it is read, and would be lost".to_owned()
    } else {
        format!("it is the same file as {}, which is read, and would be lost", super::name(read, "standard input"))
    }
}

fn written_twice(path: &Path, other: &Path) -> String {
    let path = super::name(path, "standard output");
    let other = super::name(other, "standard output");
    if path == other {
        format!("two outputs have the same name, {path}")
    } else {
        format!("two outputs are the same file, {other} and {path}")
    }
}

impl WriteError {
    pub(super) fn from_io(path: PathBuf, bytes: u64, source: Error) -> Self {
        match source.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::Full { path, bytes },
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Self::Denied { path, source },
            ErrorKind::IsADirectory => Self::Directory(path),
            ErrorKind::AlreadyExists => Self::Exists(path),
            // The folder was there when its name was looked at.
            ErrorKind::NotFound => Self::NoDirectory { directory: super::directory_of(&path), path },
            _ => Self::Write { path, source },
        }
    }

    /// Whoever read from a pipe has gone: no failure of the program.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Write { source, .. } if source.kind() == ErrorKind::BrokenPipe)
    }
}
