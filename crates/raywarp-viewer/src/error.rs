//! What can go wrong in a viewer.

use raywarp::accel::Unhittable;
use raywarp::device::DeviceError;
use raywarp::device_scene::SceneError;
use raywarp::image::ImageError;
use raywarp::render::RenderError;
use raywarp::scene::save::SaveError;
use raywarp::scene::{LoadError, UnknownCamera};

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
    /// The scene does not have the camera that is asked for.
    #[error(transparent)]
    Camera(#[from] UnknownCamera),
    /// Triangles would be dropped that are not to be.
    #[error(transparent)]
    Unhittable(#[from] Unhittable),
    /// Work beside the loop ended without a result.
    #[error("{0} failed without a word: this is a fault of raywarp; please report what the terminal says")]
    Lost(&'static str),
    /// The scene cannot be saved.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// The picture cannot be encoded.
    #[error(transparent)]
    Image(#[from] ImageError),
}

impl From<SceneError> for ViewerError {
    fn from(error: SceneError) -> Self {
        Self::Render(error.into())
    }
}

impl ViewerError {
    /// Whether the device works and has no room: a smaller picture may find some.
    pub fn is_memory(&self) -> bool {
        let (Self::Device(device) | Self::Render(RenderError::Device(device))) = self else { return false };
        matches!(device, DeviceError::Memory { .. })
    }
}
