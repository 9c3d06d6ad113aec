//! The first stage: a ray through each pixel, somewhere in it.

use super::Path;
use crate::kernels::{Frame, Thread};
use crate::ray::Ray;
use crate::view::ViewMut;

/// Starts the paths of a sample.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CameraRays {
    /// Which pixels, and which sample.
    pub frame: Frame,
    /// One a slot, written.
    pub rays: ViewMut<Ray>,
    /// One a slot, written.
    pub paths: ViewMut<Path>,
}

impl CameraRays {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Some(pixel) = self.frame.pixel_of_slot(thread.x) else { return };
        let [dx, dy] = self.frame.sampler(pixel).pair(0).point();
        let ray = self.frame.camera.ray(pixel[0] as f32 + dx, pixel[1] as f32 + dy);
        // SAFETY: one thread a slot.
        unsafe {
            self.rays.set(thread.x, ray);
            self.paths.set(thread.x, Path::start());
        }
    }
}
