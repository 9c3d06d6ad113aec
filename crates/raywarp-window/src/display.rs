//! A display of the desktop, and a window on it.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use raywarp::write::WriteError;
use raywarp_viewer::live::{LiveScene, Viewer};
use winit::event_loop::EventLoop;

use crate::app::App;
use crate::error::{self, WindowError};
use crate::libraries;

/// A scene that fails or is ready within this time needs no window that says that it is read.
const PATIENCE: Duration = Duration::from_millis(150);

/// How a window begins, and where its files go.
pub struct WindowOptions {
    /// Pixels of the picture.
    pub size: [u32; 2],
    /// Whether to fill the screen.
    pub fullscreen: bool,
    /// Keeps a file under about this name, but over none of the scene's, and tells its path: [`keep`](crate::keep::keep) in a
    /// folder.
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
    pub fn show(self, mut live_scene: LiveScene, viewer: Viewer, options: WindowOptions) -> Result<(), WindowError> {
        wait_for(&mut live_scene);
        let mut app = App::new(live_scene, viewer, options);
        app.check()?;
        let ran = self.events.run_app(&mut app);
        app.take_error().map_or(Ok(()), Err)?;
        ran.map_err(|error| error::of_winit("keep the window open", error))
    }
}

fn wait_for(live_scene: &mut LiveScene) {
    let start = Instant::now();
    while live_scene.busy().is_some() && start.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(2));
        live_scene.poll();
    }
}
