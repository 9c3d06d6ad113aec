//! Options of the viewer, in a window and in browsers.

use clap::Args;
use raywarp::scene::RenderDefaults;
use raywarp_viewer::live::view_settings::MAX_SAMPLES;
use raywarp_viewer::live::LiveSceneOptions;

use super::{CameraOptions, EnvironmentOptions, LightSettings, MachineOptions};
use crate::failure::Result;
use crate::values;

/// How a scene is shown to people: options of `view` and `serve`.
#[derive(Debug, Args)]
pub struct LiveOptions {
    /// Samples a pixel that the picture goes up to at rest [default: the scene file's, else 64]
    #[arg(long = "samples", visible_alias = "spp", value_name = "N", value_parser = values::whole::<u32>(1, MAX_SAMPLES.into()))]
    #[arg(help_heading = "Picture")]
    pub spp: Option<u32>,
    #[command(flatten)]
    pub light: LightSettings,
    /// What rays see that leave the scene: black, white, #rrggbb, or r,g,b (linear)
    #[arg(long, value_name = "COLOUR", value_parser = values::color, help_heading = "Picture")]
    pub background: Option<[f32; 3]>,
    #[command(flatten)]
    pub environment: EnvironmentOptions,
    #[command(flatten)]
    pub camera: CameraOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
}

impl LiveOptions {
    /// The same in the viewer's words, with the environment read.
    ///
    /// # Errors
    /// It cannot be read, or there is none to turn.
    pub fn live_scene(&self) -> Result<LiveSceneOptions> {
        let own = RenderDefaults { spp: self.spp, ..RenderDefaults::default() };
        Ok(LiveSceneOptions {
            overrides: own.or(&self.light.values).or(&self.machine.structure.values),
            viewpoint: self.camera.viewpoint(),
            background: self.background,
            cached: !self.machine.no_cache,
            environment: self.environment.instead_of(None)?,
            ..LiveSceneOptions::default()
        })
    }
}
