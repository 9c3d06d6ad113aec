//! Memory of the host that a device fills fast.

use std::fmt;
use std::ops::Deref;

use raywarp_core::view::Plain;

use super::{cuda, Buffer, Device, DeviceError, Machine};

/// Room on the host for what a device made, kept from one fetch to the next. For a CUDA device its pages are locked, so
/// that the device writes them at the full speed of the bus.
pub struct Staging<T: Plain> {
    memory: Memory<T>,
}

enum Memory<T: Plain> {
    Host(Vec<T>),
    Pinned(cuda::Pinned<T>),
}

impl<T: Plain> fmt::Debug for Staging<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Staging({} items)", self.len())
    }
}

impl<T: Plain> Default for Staging<T> {
    fn default() -> Self {
        Self { memory: Memory::Host(Vec::new()) }
    }
}

impl<T: Plain> Deref for Staging<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.memory {
            Memory::Host(items) => items,
            Memory::Pinned(items) => items.items(),
        }
    }
}

impl<T: Plain> Staging<T> {
    /// Holds a copy of the buffer's items from now on.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails or the host has no room.
    pub fn fetch(&mut self, device: &Device, buffer: &Buffer<T>) -> Result<(), DeviceError> {
        device.check(buffer, "what is to be fetched")?;
        let len = buffer.len() as usize;
        match &device.machine {
            Machine::Cpu => {
                let mut items = match std::mem::replace(&mut self.memory, Memory::Host(Vec::new())) {
                    Memory::Host(items) => items,
                    Memory::Pinned(_) => Vec::new(),
                };
                items.clear();
                items.extend_from_slice(buffer.host_items());
                self.memory = Memory::Host(items);
            }
            Machine::Cuda(gpu) => {
                if !matches!(&self.memory, Memory::Pinned(room) if room.fits(gpu, len)) {
                    self.memory = Memory::Pinned(cuda::Pinned::new(gpu, len)?);
                }
                if let (Memory::Pinned(room), Some(source)) = (&mut self.memory, buffer.on_cuda()) {
                    source.read(room)?;
                }
            }
        }
        Ok(())
    }
}
