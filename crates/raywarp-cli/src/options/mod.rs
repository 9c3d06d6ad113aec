//! Every option of the program, a command a file. Help, man pages and completions are made from these definitions; the
//! options of rendering come from the schema (`settings`).

mod camera;
mod completions;
mod environment;
mod info;
mod live;
mod machine;
mod man;
mod query;
mod render;
mod serve;
mod settings;
mod view;

use clap::{Parser, Subcommand};

pub use crate::bench::BenchOptions;
pub use crate::frames::FrameOptions;
pub use camera::CameraOptions;
pub use completions::CompletionsOptions;
pub use environment::EnvironmentOptions;
pub use info::InfoOptions;
pub use live::LiveOptions;
pub use machine::{MachineOptions, DEVICES};
pub use man::ManOptions;
pub use query::QueryOptions;
pub use render::{RenderOptions, StatsForm};
pub use serve::ServeOptions;
pub use settings::{flags, LightSettings, PictureSettings, StructureSettings};
pub use view::ViewOptions;

/// Ray tracing on any CUDA GPU with nothing but its driver, or on the CPU
#[derive(Debug, Parser)]
#[command(
    name = "raywarp",
    version,
    max_term_width = 100,
    after_help = EXAMPLES,
    disable_help_subcommand = true,
)]
pub struct Options {
    /// What to do; without a command the built-in scene is rendered to raywarp.png
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXAMPLES: &str = "\
Examples:
  raywarp                                  the built-in scene, to raywarp.png
  raywarp render model.obj -o picture.png  a model, framed and lit if it has no camera and no lights
  raywarp model.obj                        walk around it in a window or the browser
  raywarp query model.obj --rays rays.npy  what each of many rays hits, to hits.npz
  raywarp serve model.glb                  walk through a scene in a browser, also one far away
  raywarp info scene.gltf                  what is in a scene
  raywarp doctor                           whether a GPU can be used, and if not what to do

`raywarp render --help` has all options of rendering.

Exit codes: 0 done, 2 usage or scene error, 3 device error, 130 interrupted";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to PNG or EXR files
    Render(Box<RenderOptions>),
    /// Walk through a scene in a window, or in the browser where there is none
    View(Box<ViewOptions>),
    /// Ask many rays what they hit: the closest, any, all of it, or how much
    Query(QueryOptions),
    /// Show a scene in browsers, here or through ssh, and let people walk through it
    Serve(Box<ServeOptions>),
    /// Show what is in a scene: counts, bounds, materials, memory, quality of the trees
    Info(InfoOptions),
    /// Measure rays a second: primary, shadow, ambient occlusion, diffuse and random, beside other ray tracers
    Bench(Box<BenchOptions>),
    /// Check the CUDA driver and the devices, and say what to do about problems
    Doctor,
    /// Print the completions for a shell
    Completions(CompletionsOptions),
    /// Print the manual page, or write the pages of all commands into a directory
    Man(ManOptions),
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_definitions_are_consistent() {
        super::Options::command().debug_assert();
    }
}
