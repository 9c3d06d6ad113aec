//! What crates need that launch kernels of their own: whoever only uses such crates does not.

use raywarp_core::view::{Plain, View, ViewMut};

use crate::buffer::Storage;
pub use crate::launchable::Launchable;
pub use crate::mark::Timed;
pub use crate::pace::Pace;
use crate::Buffer;

/// The items of a buffer as kernels have them. What a view holds is an address of the device: only kernels follow it, and
/// [`Device::launch`](crate::Device::launch) is where it is promised that the buffer is still there.
pub trait Views<T: Plain> {
    /// The items, for a kernel to read.
    fn view(&self) -> View<T>;

    /// The items, for a kernel to write.
    fn view_mut(&mut self) -> ViewMut<T>;
}

impl<T: Plain> Views<T> for Buffer<T> {
    fn view(&self) -> View<T> {
        let address = match &self.storage {
            _ if self.is_empty() => return View::EMPTY,
            Storage::Host(items) => items.as_ptr(),
            Storage::Cuda(buffer) => buffer.address() as *const T,
        };
        // SAFETY: the address and length are the buffer's own, the rest is part of the contract of `Device::launch`, the
        // only place where a view is followed.
        unsafe { View::new(address, self.len()) }
    }

    fn view_mut(&mut self) -> ViewMut<T> {
        let len = self.len();
        let address = match &mut self.storage {
            _ if len == 0 => return ViewMut::EMPTY,
            Storage::Host(items) => items.as_mut_ptr(),
            Storage::Cuda(buffer) => buffer.address() as *mut T,
        };
        // SAFETY: as in `view`; exclusive through `&mut self`.
        unsafe { ViewMut::new(address, len) }
    }
}
