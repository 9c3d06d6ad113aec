//! What can go wrong with a query, as sentences.

use crate::accel::BuildError;
use crate::device::DeviceError;
use crate::render::RenderError;

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum QueryError {
    /// The scene's parts do not fit together.
    #[error(transparent)]
    Scene(RenderError),
    /// The structure cannot hold the triangles.
    #[error(transparent)]
    Build(#[from] BuildError),
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

impl From<RenderError> for QueryError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Build(error) => Self::Build(error),
            RenderError::Device(error) => Self::Device(error),
            other => Self::Scene(other),
        }
    }
}
