//! Hits in the memory of a device.

use rayon::prelude::*;
use raywarp_core::ray::{HitArrays, MeshHit};
use raywarp_device::kernels::Views;
use raywarp_device::{Buffer, Device, DeviceError};

use super::QueryError;
use crate::Hit;

/// Hits on a device: two arrays, so that threads that are neighbours write side by side.
#[derive(Debug)]
pub struct HitBuffers {
    /// `t`, `u`, `v` and `primitive`, one a hit.
    pub hits: Buffer<MeshHit>,
    /// The instance, one a hit.
    pub instances: Buffer<u32>,
}

impl HitBuffers {
    /// Bytes of a hit.
    pub const HIT: usize = size_of::<MeshHit>() + size_of::<u32>();

    /// Room for so many; until then they are zeros.
    ///
    /// # Errors
    /// The device has no room, or they are 2^32 or more.
    pub fn new(device: &Device, hits: usize) -> Result<Self, DeviceError> {
        Ok(Self { hits: device.zeroed(hits)?, instances: device.zeroed(hits)? })
    }

    /// Copies them to this machine.
    ///
    /// # Errors
    /// The device fails.
    pub fn to_vec(&self) -> Result<Vec<Hit>, DeviceError> {
        let (hits, instances) = (self.hits.to_vec()?, self.instances.to_vec()?);
        Ok(hits.par_iter().zip(&instances).map(|(hit, &instance)| hit.of_instance(instance)).collect())
    }

    /// Whether both are on the device and hold `each` hits a ray.
    pub(super) fn check(&self, device: &Device, rays: u32, each: u32) -> Result<(), QueryError> {
        super::device::check(&self.hits, "hits", device, rays, each)?;
        super::device::check(&self.instances, "instances", device, rays, each)
    }

    /// Zeros again.
    ///
    /// # Errors
    /// The device fails.
    pub fn clear(&mut self) -> Result<(), DeviceError> {
        self.hits.clear()?;
        self.instances.clear()
    }

    /// For a kernel that writes them.
    #[doc(hidden)]
    pub fn arrays(&mut self) -> HitArrays {
        HitArrays { hits: self.hits.view_mut(), instances: self.instances.view_mut() }
    }
}
