//! Options of `raywarp view`.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use raywarp_viewer::live::Source;

use super::LiveOptions;
use crate::values;

const EXAMPLES: &str = "\
Examples:
  raywarp view model.glb
  raywarp view scene.toml --watch --size 1920x1080

H shows what keys and pointer do. The window is the program raywarp-window, which is built apart:
without it, or without a display, the scene is shown in a browser at the address that is printed.
--size and --fullscreen are the window's.";

/// Options of `view`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ViewOptions {
    /// Scene file: .obj, .ply, .stl, .gltf, .glb, or .toml (see docs/scene-file.md); none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,
    /// Read the scene again when its file changes
    #[arg(long)]
    pub watch: bool,

    /// Size of the picture in the window, in pixels of the screen
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = values::size)]
    #[arg(help_heading = "Window")]
    pub size: [u32; 2],
    /// Fill the screen
    #[arg(long, help_heading = "Window")]
    pub fullscreen: bool,

    #[command(flatten)]
    pub live: LiveOptions,

    /// Take the scene's warnings as errors
    #[arg(long, help_heading = "Messages")]
    pub strict: bool,
}

impl ViewOptions {
    /// The scene in the viewer's words.
    pub fn source(&self) -> Source {
        Source { path: self.scene.clone(), strict: self.strict, watch: self.watch }
    }
}
