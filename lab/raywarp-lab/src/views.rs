//! Views of buffers for the kernels that this crate launches.

use raywarp::device::Buffer;
use raywarp_core::view::{Plain, View, ViewMut};

/// As kernels take a buffer. Whoever calls these waits for the kernel before the buffer is touched or gone.
pub(crate) trait Views<T> {
    fn view(&self) -> View<T>;
    fn view_mut(&mut self) -> ViewMut<T>;
}

impl<T: Plain> Views<T> for Buffer<T> {
    fn view(&self) -> View<T> {
        // SAFETY: as the trait says, which only this crate can call; kernels alone read views, on the buffer's device.
        unsafe { self.lend() }
    }

    fn view_mut(&mut self) -> ViewMut<T> {
        // SAFETY: as above.
        unsafe { self.lend_mut() }
    }
}
