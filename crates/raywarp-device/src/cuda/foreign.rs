//! Streams and memory that others have in the device's primary context.

use cudarc::driver::{result, sys, DriverError};
use raywarp_core::view::{Plain, View};

use super::{Cuda, DeviceError, Stream};

impl Cuda {
    /// # Safety
    /// See [`Device::borrow_stream`](crate::Device::borrow_stream).
    pub unsafe fn borrow_stream(&self, handle: usize) -> Stream {
        // SAFETY: the caller's promise; work is ordered by whoever launches it.
        let stream = unsafe { self.context().wrap_borrowed_stream(handle as sys::CUstream) };
        Stream::of(self, stream)
    }

    pub fn holds(&self, address: usize) -> Result<bool, DeviceError> {
        use sys::CUpointer_attribute::CU_POINTER_ATTRIBUTE_DEVICE_ORDINAL;
        let mut ordinal = 0_i32;
        // SAFETY: the attribute is an `int`, which is there for the call; any address may be asked about.
        let asked = unsafe {
            let room = std::ptr::from_mut(&mut ordinal).cast();
            sys::cuPointerGetAttribute(room, CU_POINTER_ATTRIBUTE_DEVICE_ORDINAL, address as sys::CUdeviceptr)
        };
        asked.result().map_err(|error| self.failed("looked for the device of an address", error))?;
        Ok(ordinal == self.index() as i32)
    }

    pub fn synchronize(&self) -> Result<(), DeviceError> {
        let done = self.restoring_context(|| self.context().synchronize())?;
        done.map_err(|error| self.failed("finished its work", error))
    }

    pub fn restoring_context<T>(&self, work: impl FnOnce() -> T) -> Result<T, DeviceError> {
        let failed = |error| self.failed("changed the context of a thread", error);
        let before = result::ctx::get_current().map_err(failed)?;
        let done = work();
        let restore = || -> Result<(), DriverError> {
            if result::ctx::get_current()? != before {
                // SAFETY: it was current before, or none was.
                unsafe { result::ctx::set_current(before.unwrap_or(std::ptr::null_mut())) }?;
            }
            Ok(())
        };
        restore().map_err(failed)?;
        Ok(done)
    }
}

impl Stream {
    pub fn wait_for(&self, other: &Self) -> Result<(), DeviceError> {
        self.queue().join(other.queue()).map_err(|error| self.gpu().failed("put streams in order", error))
    }

    pub fn is_capturing(&self) -> Result<bool, DeviceError> {
        let status = self.queue().capture_status().map_err(|error| self.gpu().failed("told of a capture", error))?;
        Ok(status != sys::CUstreamCaptureStatus::CU_STREAM_CAPTURE_STATUS_NONE)
    }

    /// # Safety
    /// See [`crate::Stream::read`].
    pub unsafe fn read<T: Plain>(&self, items: View<T>) -> Result<Vec<T>, DeviceError> {
        // SAFETY: zeros are a `Plain` value.
        let mut target: Vec<T> = vec![unsafe { std::mem::zeroed() }; items.len() as usize];
        let copy = |target: &mut [T]| -> Result<(), DriverError> {
            self.gpu().context().bind_to_thread()?;
            let (source, stream) = (items.address() as sys::CUdeviceptr, self.queue());
            // SAFETY: as many items as there is room for are at the address, by the caller's promise; the room is there until the
            // copy is over.
            unsafe { result::memcpy_dtoh_async(target, source, stream.cu_stream()) }?;
            stream.synchronize()
        };
        if !target.is_empty() {
            copy(&mut target).map_err(|error| self.gpu().failed("gave data back", error))?;
        }
        Ok(target)
    }
}
