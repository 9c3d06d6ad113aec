//! The program `raywarp-window`: the viewer in a window of the desktop. `raywarp view` starts it where it is installed.
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
mod display;
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
use std::process::ExitCode;

use clap::Parser;
use raywarp::device::Device;
use raywarp_cli::failure::Result;
use raywarp_cli::interrupt::Interrupt;
use raywarp_cli::messages;
use raywarp_cli::options::ViewOptions;
use raywarp_cli::render::limit_threads;
use raywarp_viewer::live::{LiveScene, Viewer};

use display::{Display, WindowOptions};

/// Walk through a scene in a window
#[derive(Debug, Parser)]
#[command(name = "raywarp-window", version, max_term_width = 100)]
struct Options {
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    match run(&Options::parse().view) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell().into(),
    }
}

/// Shows a scene in a window until it is closed.
fn run(options: &ViewOptions) -> Result<()> {
    let display = Display::open()?;
    let interrupt = Interrupt::install();
    let folder = std::env::current_dir()?;
    limit_threads(options.live.machine.threads)?;

    let device = Device::open(options.live.machine.device)?;
    messages::fallback(&device);
    let live_scene = LiveScene::open(options.source(), device, options.live.live_scene()?);
    let keep = move |name: &str, content: &[u8], files: &[PathBuf]| {
        let _held = interrupt.hold();
        keep::keep(&folder, name, content, files)
    };
    let window = WindowOptions { size: options.size, fullscreen: options.fullscreen, keep: Box::new(keep) };
    Ok(display.show(live_scene, Viewer::new(options.size), window)?)
}
