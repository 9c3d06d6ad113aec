//! What crates need that launch kernels of their own: whoever only uses such crates does not.

use raywarp_core::view::{Plain, View, ViewMut};

pub use crate::launchable::Launchable;
pub use crate::pace::Pace;
pub use crate::stream::Launch;
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
        // SAFETY: nothing but a launch follows it, whose contract says the rest.
        unsafe { self.lend() }
    }

    fn view_mut(&mut self) -> ViewMut<T> {
        // SAFETY: as above.
        unsafe { self.lend_mut() }
    }
}
