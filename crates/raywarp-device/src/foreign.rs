//! What others have on the same device: their streams and memory, and the order between those and the device's own.
//!
//! CUDA's runtime, and with it most libraries of arrays, works in a device's primary context, and so does raywarp: their addresses and
//! streams are valid here. A kernel is launched on a [borrowed stream](Device::borrow_stream) over [views](crate::View) of their memory, and
//! needs nothing else to be in order with their work on that stream. The device's own stream does not wait for others, nor they for
//! it: [`Stream::follow`] and [`Device::synchronize`] do that.

use raywarp_core::view::{Plain, View};

use crate::{Device, DeviceError, Machine, Stream};

impl Device {
    /// A stream of someone else: a `CUstream` of the device's primary context, where 0 and 1 are the legacy default stream and 2 is
    /// that of the calling thread. On the CPU, which has none, any number is a stream whose launches are over when they return.
    ///
    /// # Safety
    /// The handle is such a stream, and stays one as long as what is returned is used.
    pub unsafe fn borrow_stream(&self, handle: usize) -> Stream {
        match &self.machine {
            Machine::Cpu => Stream::on_cpu(),
            // SAFETY: the caller's promise.
            Machine::Cuda(gpu) => Stream::on_cuda(unsafe { gpu.borrow_stream(handle) }),
        }
    }

    /// Whether what lies at an address that someone else names is in memory of this device.
    ///
    /// # Errors
    /// [`DeviceError`] where the driver knows nothing of the address.
    pub fn holds(&self, address: usize) -> Result<bool, DeviceError> {
        match &self.machine {
            Machine::Cpu => Ok(true),
            Machine::Cuda(gpu) => gpu.holds(address),
        }
    }

    /// Waits for all that this process has told the device, on whichever stream.
    ///
    /// # Errors
    /// [`DeviceError`] where a kernel failed, or where a stream is being captured.
    pub fn synchronize(&self) -> Result<(), DeviceError> {
        match &self.machine {
            Machine::Cpu => Ok(()),
            Machine::Cuda(gpu) => gpu.synchronize(),
        }
    }

    /// Does something, after which the context is current again that was current in this thread before: others may rely on theirs.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn restoring_context<T>(&self, work: impl FnOnce() -> T) -> Result<T, DeviceError> {
        match &self.machine {
            Machine::Cpu => Ok(work()),
            Machine::Cuda(gpu) => gpu.restoring_context(work),
        }
    }
}

impl Stream {
    /// What comes next on this stream waits for all that another of the same device has been told so far.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn wait_for(&self, other: &Self) -> Result<(), DeviceError> {
        match (self.on_cuda_stream(), other.on_cuda_stream()) {
            (Some(stream), Some(other)) => stream.wait_for(other),
            // On the CPU all has been done.
            _ => Ok(()),
        }
    }

    /// Whether what the stream is told is being recorded into a graph, and not done.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn is_capturing(&self) -> Result<bool, DeviceError> {
        self.on_cuda_stream().map_or(Ok(false), |stream| stream.is_capturing())
    }

    /// What lies in memory of the device once the stream has done what it was told, which is waited for.
    ///
    /// # Safety
    /// The items are there, in memory of the stream's device, and nobody writes them until this returns but on this stream.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub unsafe fn read<T: Plain>(&self, items: View<T>) -> Result<Vec<T>, DeviceError> {
        match self.on_cuda_stream() {
            // SAFETY: the caller's promise.
            Some(stream) => unsafe { stream.read(items) },
            None => Ok((0..items.len()).map(|index| items.at(index)).collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::Views;
    use crate::DeviceChoice;

    #[test]
    fn on_the_cpu_any_stream_is_one_and_memory_is_read_where_it_lies() {
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        // SAFETY: the CPU has no streams to be wrong about.
        let stream = unsafe { device.borrow_stream(7) };
        assert_eq!(device.check_stream(&stream).ok(), Some(()));
        assert!(!stream.is_capturing().unwrap());
        let buffer = device.upload(&[1_u32, 2, 3]).unwrap();
        // SAFETY: the buffer outlives the call.
        assert_eq!(unsafe { stream.read(buffer.view()) }.unwrap(), [1, 2, 3]);
        assert_eq!(device.restoring_context(|| 5).unwrap(), 5);
        device.synchronize().unwrap();
    }
}
