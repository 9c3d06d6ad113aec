//! The last stage: what each path brought is added to its pixel.

use super::Path;
use crate::film::Pixel;
use crate::kernels::{Frame, Thread};
use crate::view::{View, ViewMut};

/// Ends the sample of all pixels.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AddToFilm {
    /// Which pixels.
    pub frame: Frame,
    /// One a slot.
    pub paths: View<Path>,
    /// Sums, read and written.
    pub film: ViewMut<Pixel>,
}

impl AddToFilm {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let Some([x, y]) = self.frame.pixel_of_slot(thread.x) else { return };
        let [left, top, width] = self.frame.film;
        let index = (y - top) * width + (x - left);
        let path = self.paths.load(thread.x);
        // SAFETY: a slot a pixel.
        let Some(mut pixel) = (unsafe { self.film.get(index) }) else { return };
        pixel.radiance += path.radiance;
        pixel.hits += (path.state & Path::MET != 0) as u32 as f32;
        // SAFETY: a slot a pixel.
        unsafe { self.film.set(index, pixel) };
    }
}
