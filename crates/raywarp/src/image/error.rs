//! What can go wrong with a picture file, as sentences.

use std::io::{Error, ErrorKind};
use std::path::PathBuf;

use super::Layer;

/// Why a picture could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The name does not say which kind of file is meant.
    #[error("cannot write {}: its name does not end in .png or .exr. Give one of these endings, or '-' for PNG to standard output", .0.display())]
    UnknownExtension(PathBuf),
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
        /// Size of the picture file.
        bytes: usize,
    },
    /// Any other failure of the file system.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: Error,
    },
    /// The encoder refused.
    #[error("cannot encode a picture of {width}x{height} pixels as {format}: {reason}")]
    Encode {
        /// PNG or EXR.
        format: super::Format,
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The encoder's reason.
        reason: String,
    },
    /// A layer was asked for that was not rendered.
    #[error("the layer '{0}' was not rendered")]
    NoLayer(Layer),
}

impl ImageError {
    pub(super) fn from_io(path: PathBuf, bytes: usize, source: Error) -> Self {
        match source.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::Full { path, bytes },
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Self::Denied { path, source },
            ErrorKind::IsADirectory => Self::Directory(path),
            _ => Self::Write { path, source },
        }
    }

    /// Whoever read the picture from a pipe has gone: no failure of the program.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Write { source, .. } if source.kind() == ErrorKind::BrokenPipe)
    }
}
