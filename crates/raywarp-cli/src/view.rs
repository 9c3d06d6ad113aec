//! `raywarp view`.

use std::path::PathBuf;

use raywarp::backend::Device;
use raywarp_viewer::live::{Source, Stage, Viewer};
use raywarp_viewer::window::{self, Display, WindowOptions};

use crate::interrupt::Interrupt;
use crate::options::ViewOptions;
use crate::render::limit_threads;
use crate::say;

/// Shows a scene in a window until it is closed.
pub fn run(options: &ViewOptions) -> anyhow::Result<()> {
    let display = Display::open()?;
    let interrupt = Interrupt::install();
    let folder = std::env::current_dir()?;
    limit_threads(options.live.machine.threads)?;

    let device = Device::open(options.live.machine.device)?;
    say::fallback(&device);
    let stage = Stage::open(source(options), device, options.live.stage());
    let keep = move |name: &str, content: &[u8], files: &[PathBuf]| {
        let _held = interrupt.hold();
        window::keep(&folder, name, content, files)
    };
    let window = WindowOptions { size: options.size, fullscreen: options.fullscreen, keep: Box::new(keep) };
    Ok(display.show(stage, Viewer::new(options.size), window)?)
}

fn source(options: &ViewOptions) -> Source {
    Source { path: options.scene.clone(), strict: options.strict, watch: options.watch }
}
