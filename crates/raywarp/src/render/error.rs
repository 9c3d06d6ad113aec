//! What can go wrong between a scene and its picture.

use crate::device::DeviceError;
use crate::device_scene::SceneError;

/// A camera as people know it: one that no file names has a name of raywarp's own.
fn camera(name: &str) -> String {
    match name {
        "" | super::framing::FRAMED => "the camera".to_owned(),
        _ => format!("the camera '{name}'"),
    }
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// An option is out of its range.
    #[error("{0}")]
    Option(String),
    /// The camera sees nothing.
    #[error("{} {problem}", camera(name))]
    Camera {
        /// The camera's name.
        name: String,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The scene is not on the device.
    #[error(transparent)]
    Scene(SceneError),
    /// The device fails.
    #[error(transparent)]
    Device(#[from] DeviceError),
}

impl From<SceneError> for RenderError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Device(error) => Self::Device(error),
            other => Self::Scene(other),
        }
    }
}
