//! Page-locked memory of the host.

use std::ffi::c_void;
use std::marker::PhantomData;

use cudarc::driver::result;
use raywarp_core::view::Plain;

use super::{Cuda, DeviceError};

/// Items in page-locked memory; freed when dropped.
pub(crate) struct Pinned<T> {
    gpu: Cuda,
    address: *mut c_void,
    len: usize,
    items: PhantomData<T>,
}

// SAFETY: the memory is this value's own and holds plain data; the driver may free it from any thread.
unsafe impl<T: Plain> Send for Pinned<T> {}
// SAFETY: shared borrows only read.
unsafe impl<T: Plain> Sync for Pinned<T> {}

impl<T: Plain> Pinned<T> {
    /// All zero.
    pub fn new(gpu: &Cuda, len: usize) -> Result<Self, DeviceError> {
        let size = (len * std::mem::size_of::<T>()).max(1);
        let failed = |error| gpu.failed(&format!("locked {size} bytes of the host's memory"), error);
        gpu.context().bind_to_thread().map_err(failed)?;
        // cudarc's own pages are write-combined, which the host reads many times slower.
        // SAFETY: the context is bound; the size is not zero.
        let address = unsafe { result::malloc_host(size, 0) }.map_err(failed)?;
        // SAFETY: so many bytes are there.
        unsafe { address.cast::<u8>().write_bytes(0, size) };
        Ok(Self { gpu: gpu.clone(), address, len, items: PhantomData })
    }

    pub fn fits(&self, gpu: &Cuda, len: usize) -> bool {
        self.gpu.is(gpu) && self.len == len
    }

    pub fn items(&self) -> &[T] {
        // SAFETY: pages hold aligned, `Plain` items: first zeros, then what a device wrote and was waited for.
        unsafe { std::slice::from_raw_parts(self.address.cast(), self.len) }
    }

    pub fn bytes_mut(&mut self) -> &mut [u8] {
        // SAFETY: as in `items`; exclusive through `&mut self`, and any bytes are a `Plain` value.
        unsafe { std::slice::from_raw_parts_mut(self.address.cast(), self.len * std::mem::size_of::<T>()) }
    }
}

impl<T> Drop for Pinned<T> {
    fn drop(&mut self) {
        if self.gpu.context().bind_to_thread().is_ok() {
            // SAFETY: `malloc_host` gave the address, and nothing copies to it: `read` waits. What fails here fails at
            // the next call too.
            let _ = unsafe { result::free_host(self.address) };
        }
    }
}
