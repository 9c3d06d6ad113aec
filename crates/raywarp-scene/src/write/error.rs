//! What can go wrong with a file that is written, as sentences.

use std::io::{Error, ErrorKind};
use std::path::PathBuf;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// There is a directory of that name.
    #[error("cannot write {}: it is a directory. Give a file name inside it", .0.display())]
    Directory(PathBuf),
    /// The directory for the file is missing.
    #[error("cannot write {}: there is no directory {}. Create it first", path.display(), directory.display())]
    NoDirectory {
        /// The file.
        path: PathBuf,
        /// The directory that is missing.
        directory: PathBuf,
    },
    /// No right to write there.
    #[error("cannot write {}: {source}. Choose a directory that you may write to", path.display())]
    Denied {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: Error,
    },
    /// No room.
    #[error("cannot write {}: the disk is full ({bytes} bytes are needed). Make room or choose another disk", path.display())]
    Full {
        /// The file.
        path: PathBuf,
        /// Size of the file.
        bytes: u64,
    },
    /// Any other failure of the file system.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: Error,
    },
}

impl WriteError {
    pub(super) fn from_io(path: PathBuf, bytes: u64, source: Error) -> Self {
        match source.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::Full { path, bytes },
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Self::Denied { path, source },
            ErrorKind::IsADirectory => Self::Directory(path),
            _ => Self::Write { path, source },
        }
    }

    /// Whoever read from a pipe has gone: no failure of the program.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Write { source, .. } if source.kind() == ErrorKind::BrokenPipe)
    }
}
