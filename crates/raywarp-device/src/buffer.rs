//! Arrays on a device.

use std::borrow::Cow;

use raywarp_core::view::Plain;

use super::cuda::CudaBuffer;
use super::{DeviceError, Machine};

/// An array in the memory of the device that made it; freed when dropped.
#[derive(Debug)]
pub struct Buffer<T: Plain> {
    pub(crate) storage: Storage<T>,
    len: u32,
}

#[derive(Debug)]
pub(crate) enum Storage<T: Plain> {
    Host(Vec<T>),
    Cuda(CudaBuffer<T>),
}

impl<T: Plain> Buffer<T> {
    pub(crate) fn upload(machine: &Machine, items: &[T]) -> Result<Self, DeviceError> {
        let len = length(items.len())?;
        let storage = match machine {
            Machine::Cpu => Storage::Host(items.to_vec()),
            Machine::Cuda(gpu) => Storage::Cuda(CudaBuffer::upload(gpu, items)?),
        };
        Ok(Self { storage, len })
    }

    pub(crate) fn zeroed(machine: &Machine, items: usize) -> Result<Self, DeviceError> {
        let len = length(items)?;
        let storage = match machine {
            // SAFETY: zeros are a `Plain` value.
            Machine::Cpu => Storage::Host(vec![unsafe { std::mem::zeroed() }; items]),
            Machine::Cuda(gpu) => Storage::Cuda(CudaBuffer::zeroed(gpu, items)?),
        };
        Ok(Self { storage, len })
    }

    /// Number of items.
    pub fn len(&self) -> u32 {
        self.len
    }

    /// Whether there are no items.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Bytes that the items take.
    pub fn bytes(&self) -> u64 {
        self.len as u64 * std::mem::size_of::<T>() as u64
    }

    /// Makes all items zero.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn clear(&mut self) -> Result<(), DeviceError> {
        match &mut self.storage {
            Storage::Host(items) => {
                // SAFETY: zeros are a `Plain` value.
                items.fill(unsafe { std::mem::zeroed() });
                Ok(())
            }
            Storage::Cuda(buffer) => buffer.clear(),
        }
    }

    /// Writes items from `first` on.
    ///
    /// # Errors
    /// [`DeviceError::Range`] where they do not fit, else where the device fails.
    pub fn write(&mut self, first: usize, items: &[T]) -> Result<(), DeviceError> {
        let fits = first.checked_add(items.len()).is_some_and(|end| end <= self.len as usize);
        if !fits {
            return Err(DeviceError::Range { first, items: items.len(), len: self.len });
        }
        match &mut self.storage {
            Storage::Host(all) => {
                all[first..first + items.len()].copy_from_slice(items);
                Ok(())
            }
            Storage::Cuda(buffer) => buffer.write(first, items),
        }
    }

    /// The items, where they are on the host.
    pub(crate) fn host_items(&self) -> &[T] {
        match &self.storage {
            Storage::Host(items) => items,
            Storage::Cuda(_) => &[],
        }
    }

    /// The items, where they are on a CUDA device.
    pub(crate) fn on_cuda(&self) -> Option<&CudaBuffer<T>> {
        match &self.storage {
            Storage::Host(_) => None,
            Storage::Cuda(buffer) => Some(buffer),
        }
    }

    /// Whether the items are in the memory of this device.
    pub(crate) fn is_on(&self, machine: &Machine) -> bool {
        match (&self.storage, machine) {
            (Storage::Host(_), Machine::Cpu) => true,
            (Storage::Cuda(buffer), Machine::Cuda(gpu)) => buffer.is_on(gpu),
            _ => false,
        }
    }

    /// The items: where they are on the host, or a copy of them.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn items(&self) -> Result<Cow<'_, [T]>, DeviceError> {
        match &self.storage {
            Storage::Host(items) => Ok(Cow::Borrowed(items)),
            Storage::Cuda(_) => self.to_vec().map(Cow::Owned),
        }
    }

    /// A copy of `count` items from `first` on.
    ///
    /// # Errors
    /// [`DeviceError::Range`] where there are fewer, else where the device fails.
    pub fn read(&self, first: usize, count: usize) -> Result<Vec<T>, DeviceError> {
        let there = first.checked_add(count).is_some_and(|end| end <= self.len as usize);
        if !there {
            return Err(DeviceError::Range { first, items: count, len: self.len });
        }
        match &self.storage {
            Storage::Host(items) => Ok(items[first..first + count].to_vec()),
            Storage::Cuda(buffer) => buffer.download(first, count),
        }
    }

    /// A copy of the items.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn to_vec(&self) -> Result<Vec<T>, DeviceError> {
        match &self.storage {
            Storage::Host(items) => Ok(items.clone()),
            Storage::Cuda(buffer) => buffer.download(0, self.len as usize),
        }
    }

    /// Brings the items back.
    ///
    /// # Errors
    /// [`DeviceError`] where the device fails.
    pub fn download(self) -> Result<Vec<T>, DeviceError> {
        match self.storage {
            Storage::Host(items) => Ok(items),
            Storage::Cuda(buffer) => buffer.download(0, self.len as usize),
        }
    }
}

fn length(items: usize) -> Result<u32, DeviceError> {
    u32::try_from(items).map_err(|_| DeviceError::TooMany { len: items })
}

#[cfg(test)]
mod tests {
    use crate::{Device, DeviceChoice, DeviceError};

    #[test]
    fn items_are_written_where_they_fit() {
        let mut buffer = Device::open(DeviceChoice::Cpu).unwrap().upload(&[1_u32, 2, 3]).unwrap();
        buffer.write(1, &[5, 6]).unwrap();
        assert_eq!(buffer.to_vec().unwrap(), [1, 5, 6]);
        assert_eq!(buffer.read(1, 2).unwrap(), [5, 6]);
        for (first, items) in [(2, [7, 8]), (usize::MAX, [7, 8])] {
            assert!(matches!(buffer.write(first, &items), Err(DeviceError::Range { len: 3, .. })), "{first}");
            assert!(matches!(buffer.read(first, 2), Err(DeviceError::Range { len: 3, .. })), "{first}");
        }
    }
}
