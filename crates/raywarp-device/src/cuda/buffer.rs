//! Arrays in the memory of a CUDA device.

use std::fmt;
use std::marker::PhantomData;

use cudarc::driver::{CudaSlice, DevicePtr};
use raywarp_core::view::Plain;

use super::{Cuda, DeviceError, Pinned};

/// Bytes that are copied at once: a frame that another thread wants comes between two parts of a large scene.
const PART: usize = 8 << 20;

/// Bytes on the device that hold items of `T`.
pub(crate) struct CudaBuffer<T> {
    gpu: Cuda,
    bytes: CudaSlice<u8>,
    items: PhantomData<T>,
}

impl<T> fmt::Debug for CudaBuffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "CudaBuffer({} bytes on {})", self.bytes.len(), self.gpu.description())
    }
}

impl<T: Plain> CudaBuffer<T> {
    pub fn upload(gpu: &Cuda, items: &[T]) -> Result<Self, DeviceError> {
        let mut buffer = Self::zeroed(gpu, items.len())?;
        buffer.write(0, items)?;
        Ok(buffer)
    }

    /// Copies items to the place from `first` on; they fit.
    pub fn write(&mut self, first: usize, items: &[T]) -> Result<(), DeviceError> {
        let failed = |error| self.gpu.failed("took data", error);
        let size = std::mem::size_of_val(items);
        // SAFETY: `Plain` items are bytes without padding.
        let source = unsafe { std::slice::from_raw_parts(items.as_ptr().cast::<u8>(), size) };
        let stream = self.gpu.stream();
        let mut at = first * std::mem::size_of::<T>();
        for part in source.chunks(PART) {
            stream.memcpy_htod(part, &mut self.bytes.slice_mut(at..at + part.len())).map_err(failed)?;
            // The copy reads `items` until the stream gets there.
            stream.synchronize().map_err(failed)?;
            at += part.len();
        }
        Ok(())
    }

    /// Copies all items to the host.
    pub fn read(&self, target: &mut Pinned<T>) -> Result<(), DeviceError> {
        let failed = |error| self.gpu.failed("gave data back", error);
        let raw = target.bytes_mut();
        if raw.is_empty() {
            return Ok(());
        }
        self.gpu.stream().memcpy_dtoh(&self.bytes.slice(..raw.len()), raw).map_err(failed)?;
        self.gpu.stream().synchronize().map_err(failed)
    }

    pub fn zeroed(gpu: &Cuda, items: usize) -> Result<Self, DeviceError> {
        // The driver refuses to allocate nothing.
        let size = (items * std::mem::size_of::<T>()).max(1);
        let bytes = gpu.stream().alloc_zeros(size).map_err(|e| gpu.failed(&format!("reserved {size} bytes"), e))?;
        Ok(Self { gpu: gpu.clone(), bytes, items: PhantomData })
    }

    pub fn clear(&mut self) -> Result<(), DeviceError> {
        let failed = |error| self.gpu.failed("cleared a buffer", error);
        self.gpu.stream().memset_zeros(&mut self.bytes).map_err(failed)
    }

    /// Copies items from `first` on, which are there, to the host.
    pub fn download(&self, first: usize, items: usize) -> Result<Vec<T>, DeviceError> {
        let failed = |e| self.gpu.failed("gave data back", e);
        let (at, size) = (first * std::mem::size_of::<T>(), items * std::mem::size_of::<T>());
        // SAFETY: zeros are a `Plain` value.
        let mut target: Vec<T> = vec![unsafe { std::mem::zeroed() }; items];
        if size > 0 {
            // SAFETY: the items are `size` bytes, and any bytes are a `Plain` value.
            let raw = unsafe { std::slice::from_raw_parts_mut(target.as_mut_ptr().cast::<u8>(), size) };
            self.gpu.stream().memcpy_dtoh(&self.bytes.slice(at..at + size), raw).map_err(failed)?;
            self.gpu.stream().synchronize().map_err(failed)?;
        }
        Ok(target)
    }

    pub fn is_on(&self, gpu: &Cuda) -> bool {
        self.gpu.is(gpu)
    }

    pub fn address(&self) -> u64 {
        self.bytes.device_ptr(self.gpu.stream()).0
    }
}
