//! What can go wrong with a picture file, as sentences.

use std::path::PathBuf;

use super::Layer;

/// Why there is no picture to write.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The name does not say which kind of file is meant.
    #[error("cannot write {}: its name does not end in .png or .exr", .0.display())]
    UnknownExtension(PathBuf),
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
    /// A picture file cannot be used.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A layer was asked for that was not rendered.
    #[error("the layer '{0}' was not rendered")]
    NoLayer(Layer),
}
