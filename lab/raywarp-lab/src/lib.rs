//! Raywarp's laboratory: what was measured on the way to what renders, and can be measured again.
//!
//! [`structures`] has the structures that lost, beside those of the product, under one list of names. A [`Batch`] answers rays
//! by each [`Way`] of sharing them out among threads. [`lanes`] follows warps step by step, without a GPU, and says what
//! their lanes do. [`paths`] follows rays over several bounces, in one kernel or bounce by bounce. [`clocks`] says where a
//! frame's time goes. All of it answers as everything else in raywarp does, to the bit.
//!
//! The product knows nothing of this crate: structures join by [`Resident`](raywarp::accel::Resident), kernels by the modules
//! of the device that [`open`] gives.

pub mod clocks;
pub mod lanes;
pub mod paths;
mod ptx;
mod sharing;
pub mod structures;

use raywarp::device::{Device, DeviceChoice, DeviceError};

pub use sharing::{Batch, Queues, Way};

/// A device with the kernels of the laboratory.
///
/// # Errors
/// As for [`Device::open`].
pub fn open(choice: DeviceChoice) -> Result<Device, DeviceError> {
    Device::open_with(choice, ptx::MODULES)
}
