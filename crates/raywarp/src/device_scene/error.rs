//! What can go wrong between a scene and its device.

use crate::accel::BuildError;
use crate::device::DeviceError;

/// Why a scene is not on a device, or is not changed there.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The scene's parts do not fit together: a file's reader or a caller made it wrong.
    #[error("{part} of {mesh} is out of range")]
    Part {
        /// The mesh or instance.
        mesh: String,
        /// The index that is wrong.
        part: &'static str,
    },
    /// Others hold it, and may be reading it.
    #[error("a scene that {holders} hold cannot be changed: it can where one of them holds it alone")]
    Shared {
        /// Tracers, casters and batches under way.
        holders: usize,
    },
    /// It was made for queries.
    #[error("of the scene on the device there is the geometry alone: pictures need its materials and lights")]
    GeometryAlone,
    /// The structure cannot hold it.
    #[error(transparent)]
    Build(BuildError),
    /// The device fails.
    #[error(transparent)]
    Device(#[from] DeviceError),
}

impl From<BuildError> for SceneError {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Device(error) => Self::Device(error),
            error => Self::Build(error),
        }
    }
}
