//! Kernels with their parameters, whichever they are.

use raywarp_core::kernels::Kernel;

use super::{Device, DeviceError, KernelInfo, Stream};

/// What can be done with a kernel whose type is not known where it is done: structures give such.
pub trait Launchable {
    /// See [`Device::launch`].
    ///
    /// # Safety
    /// As there.
    ///
    /// # Errors
    /// As there.
    unsafe fn launch(&self, device: &Device, extent: [u32; 2]) -> Result<(), DeviceError>;

    /// See [`Stream::launch`].
    ///
    /// # Safety
    /// As there.
    ///
    /// # Errors
    /// As there.
    unsafe fn launch_on(&self, stream: &Stream, extent: [u32; 2]) -> Result<(), DeviceError>;

    /// See [`Device::time`].
    ///
    /// # Safety
    /// As there.
    ///
    /// # Errors
    /// As there.
    unsafe fn time(&self, device: &Device, extent: [u32; 2], times: [u32; 2]) -> Result<Vec<f64>, DeviceError>;

    /// See [`Device::load`].
    ///
    /// # Errors
    /// As there.
    fn load(&self, device: &Device) -> Result<(), DeviceError>;

    /// See [`Device::kernel_info`].
    ///
    /// # Errors
    /// As there.
    fn info(&self, device: &Device, extent: [u32; 2]) -> Result<Option<KernelInfo>, DeviceError>;
}

impl<K: Kernel> Launchable for K {
    unsafe fn launch(&self, device: &Device, extent: [u32; 2]) -> Result<(), DeviceError> {
        // SAFETY: the caller's promise.
        unsafe { device.launch(self, extent) }
    }

    unsafe fn launch_on(&self, stream: &Stream, extent: [u32; 2]) -> Result<(), DeviceError> {
        // SAFETY: the caller's promise.
        unsafe { stream.launch(self, extent) }
    }

    unsafe fn time(
        &self,
        device: &Device,
        extent: [u32; 2],
        [warmup, repeats]: [u32; 2],
    ) -> Result<Vec<f64>, DeviceError> {
        // SAFETY: the caller's promise.
        unsafe { device.time(self, extent, warmup, repeats) }
    }

    fn load(&self, device: &Device) -> Result<(), DeviceError> {
        device.load::<K>()
    }

    fn info(&self, device: &Device, extent: [u32; 2]) -> Result<Option<KernelInfo>, DeviceError> {
        device.kernel_info(self, extent)
    }
}
