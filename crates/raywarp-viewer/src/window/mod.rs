//! The viewer in a window of the desktop.
//!
//! The core renders, on whichever device; everything that a window adds is done on the CPU: its pictures are scaled to
//! the window and handed to X11 or Wayland as plain pixels. Machines with data-centre GPUs have neither OpenGL nor
//! Vulkan to draw with, and often show their windows over a network. egui lays out the panel and the text;
//! `raster` draws its triangles. (The crate `egui_software_backend` would draw them too: its one egui asks for a
//! newer compiler than raywarp does, and 200 lines do.)
//!
//! On a turn of the `app`'s loop the core gets to render one frame, if it wants to; when it has, the window is drawn:
//! `interface` lays out `overlay` and `side`, `paint` fills the pixels by `scale` and `raster`. `input`
//! brings events to the core. When nothing happens, nothing is drawn.

mod app;
mod error;
mod input;
mod interface;
mod keep;
mod libraries;
mod overlay;
mod paint;
mod raster;
mod scale;
mod side;
mod surface;
#[cfg(test)]
mod tests;
mod texture;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use raywarp::write::WriteError;
use winit::event_loop::EventLoop;

use crate::live::{Stage, Viewer};
use app::App;
pub use error::WindowError;
pub use keep::keep;

/// A scene that fails or is ready within this time needs no window that says that it is read.
const PATIENCE: Duration = Duration::from_millis(150);

/// How a window begins, and where its files go.
pub struct WindowOptions {
    /// Pixels of the picture.
    pub size: [u32; 2],
    /// Whether to fill the screen.
    pub fullscreen: bool,
    /// Keeps a file under about this name, but over none of the scene's, and tells its path: [`keep()`] in a folder.
    pub keep: Keep,
}

/// Takes a file's suggested name, its content and the files of the scene, and returns its path.
pub type Keep = Box<dyn FnMut(&str, &[u8], &[PathBuf]) -> Result<PathBuf, WriteError>>;

/// A display that windows can be shown on.
pub struct Display {
    events: EventLoop<()>,
}

impl Display {
    /// Connects to the display. A program does that once.
    ///
    /// # Errors
    /// [`WindowError`] where there is no display, or a library of it is missing.
    pub fn open() -> Result<Self, WindowError> {
        libraries::check()?;
        let failed = |error| error::of_winit("open a window", error);
        Ok(Self { events: EventLoop::new().map_err(failed)? })
    }

    /// Shows a window until people close it.
    ///
    /// # Errors
    /// [`WindowError`] where the display or the device fails, and where the first scene cannot be shown.
    pub fn show(self, mut stage: Stage, viewer: Viewer, options: WindowOptions) -> Result<(), WindowError> {
        wait_for(&mut stage);
        let mut app = App::new(stage, viewer, options);
        app.check()?;
        let ran = self.events.run_app(&mut app);
        app.take_error().map_or(Ok(()), Err)?;
        ran.map_err(|error| error::of_winit("keep the window open", error))
    }
}

fn wait_for(stage: &mut Stage) {
    let start = Instant::now();
    while stage.busy().is_some() && start.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(2));
        stage.poll();
    }
}
