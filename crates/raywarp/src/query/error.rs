//! What can go wrong with a query, as sentences.

use crate::device::DeviceError;
use crate::device_scene::SceneError;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// The scene is not on the device.
    #[error(transparent)]
    Scene(SceneError),
    /// The device fails.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A buffer of answers has another length than the batch asks for.
    #[error("{rays} rays need {needed} {what}, and the buffer has {has}")]
    Length {
        /// Rays in the batch.
        rays: u32,
        /// What the buffer holds.
        what: &'static str,
        /// Items that there must be.
        needed: u64,
        /// Items that there are.
        has: u32,
    },
    /// Whoever watched asked for an end.
    #[error("stopped after {done} of {total} rays")]
    Stopped {
        /// Rays answered.
        done: usize,
        /// Rays in the batch.
        total: usize,
    },
}

impl From<SceneError> for QueryError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Device(error) => Self::Device(error),
            other => Self::Scene(other),
        }
    }
}
