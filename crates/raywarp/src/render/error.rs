//! What can go wrong between a scene and its picture.

use crate::accel::BuildError;
use crate::device::DeviceError;

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
    /// The scene's parts do not fit together: a file's reader or a caller made it wrong.
    #[error("{part} of {mesh} is out of range")]
    Scene {
        /// The mesh or instance.
        mesh: String,
        /// The index that is wrong.
        part: &'static str,
    },
    /// The structure cannot hold the scene.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The device fails.
    #[error(transparent)]
    Device(#[from] DeviceError),
}
