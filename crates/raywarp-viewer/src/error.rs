//! What can go wrong in a viewer.

use raywarp::backend::DeviceError;
use raywarp::image::ImageError;
use raywarp::render::RenderError;
use raywarp::scene::LoadError;

/// Why there is nothing to see.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// The scene cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The scene cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The device fails.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The picture cannot be encoded.
    #[error(transparent)]
    Image(#[from] ImageError),
}
