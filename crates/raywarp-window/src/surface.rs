//! A window, and the pixels in it.

use std::num::NonZeroU32;
use std::rc::Rc;

use softbuffer::{Context, SoftBufferError, Surface};
use winit::dpi::PhysicalSize;
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::window::{Fullscreen, Window};

use crate::error::{of_winit, WindowError};

/// A window that pixels can be put into.
pub struct Canvas {
    /// The window.
    pub window: Rc<Window>,
    surface: Surface<OwnedDisplayHandle, Rc<Window>>,
}

impl Canvas {
    /// Opens a window.
    ///
    /// # Errors
    /// [`WindowError::Display`] where the display refuses.
    pub fn new(events: &ActiveEventLoop, title: &str, size: [u32; 2], full: bool) -> Result<Self, WindowError> {
        let attributes = Window::default_attributes()
            .with_title(title)
            .with_inner_size(PhysicalSize::new(size[0], size[1]))
            .with_fullscreen(full.then_some(Fullscreen::Borderless(None)));
        let window = events.create_window(attributes).map_err(|error| of_winit("open a window", error))?;
        let window = Rc::new(window);
        let failed = |error: SoftBufferError| of_winit("draw into the window", sentence(&error));
        let context = Context::new(events.owned_display_handle()).map_err(failed)?;
        let surface = Surface::new(&context, Rc::clone(&window)).map_err(failed)?;
        Ok(Self { window, surface })
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        let size = self.window.inner_size();
        [size.width, size.height]
    }

    /// Lets all pixels be filled, and shows them. A window without pixels stays as it is.
    ///
    /// # Errors
    /// [`WindowError::Display`] where the display fails.
    pub fn draw(&mut self, fill: impl FnOnce(&mut [u32], [usize; 2])) -> Result<(), WindowError> {
        let size = self.size();
        let (Some(width), Some(height)) = (NonZeroU32::new(size[0]), NonZeroU32::new(size[1])) else { return Ok(()) };
        let failed = |error: SoftBufferError| of_winit("draw into the window", sentence(&error));
        self.surface.resize(width, height).map_err(failed)?;
        let mut pixels = self.surface.buffer_mut().map_err(failed)?;
        fill(&mut pixels, size.map(|side| side as usize));
        self.window.pre_present_notify();
        pixels.present().map_err(failed)
    }
}

/// The error and its causes.
fn sentence(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |&cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}
