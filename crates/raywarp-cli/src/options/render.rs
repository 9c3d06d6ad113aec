//! Options of `raywarp render`.

use std::path::PathBuf;

use clap::{Parser, ValueEnum, ValueHint};
use raywarp::image::Layer;
use raywarp::scene::{Background, Loaded, RenderDefaults, Scene};
use raywarp::write::Outputs;

use super::{CameraOptions, EnvironmentOptions, FrameOptions, LightSettings, MachineOptions, PictureSettings};
use crate::failure::Result;
use crate::values::{self, Backdrop};

const EXAMPLES: &str = "\
Examples:
  raywarp render scene.toml -o a.png -o a.exr --samples 16
  raywarp render model.glb --eye 3,2,5 --target 0,1,0 --fov 35
  raywarp render --accel kd --heatmap cost.png --stats
  raywarp render scene.obj -o a.exr --aov depth,normal,primitive
  raywarp render scene.ply -o - | display
  raywarp render model.glb --frames 1..240 --orbit -o out/frame-####.png
  raywarp render scene.toml --frames 1..96 --path tour --animation tour.mp4

The same scene, options and seed give the same picture on any number of threads.";

/// Options of `render`.
#[derive(Debug, Parser)]
#[command(after_help = EXAMPLES)]
pub struct RenderOptions {
    /// Scene file: .obj, .ply, .stl, .gltf, .glb, or .toml (see docs/scene-file.md); none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,

    /// Picture file, .png (sRGB) or .exr (linear), or - for PNG to standard output; may be repeated; none: raywarp.png
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub output: Vec<PathBuf>,
    /// Layers, with commas: depth, normal, albedo, uv, position, primitive, instance, material, tests; within an EXR, beside a
    /// PNG in false colours as NAME.LAYER.png
    #[arg(long, value_name = "LIST", value_delimiter = ',', help_heading = "Output")]
    #[arg(value_parser = values::words::<Layer>(Layer::ALL.map(Layer::name)), hide_possible_values = true)]
    pub aov: Vec<Layer>,
    /// Write the tests a pixel (nodes and triangles) as a coloured PNG with its scale
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub heatmap: Option<PathBuf>,
    /// Tests that the brightest colour of the heat map stands for; none: what 99 % of the pixels do not exceed
    #[arg(long, value_name = "N", requires = "heatmap", value_parser = values::whole::<u64>(1, u64::MAX))]
    #[arg(help_heading = "Output")]
    pub heatmap_max: Option<u64>,

    #[command(flatten)]
    pub picture: PictureSettings,
    #[command(flatten)]
    pub light: LightSettings,
    /// What rays see that leave the scene: black, white, #rrggbb, r,g,b (linear); or none, which makes PNG and EXR
    /// transparent there, and mirrors keep what they see
    #[arg(long, value_name = "COLOUR", value_parser = values::backdrop, help_heading = "Picture")]
    pub background: Option<Backdrop>,
    #[command(flatten)]
    pub environment: EnvironmentOptions,
    /// Render only columns x0 to x1 and rows y0 to y1, in pixels from the upper left, x1 and y1 excluded
    #[arg(long, value_name = "x0,y0,x1,y1", value_parser = values::crop, help_heading = "Picture")]
    pub crop: Option<[u32; 4]>,

    #[command(flatten)]
    pub camera: CameraOptions,

    #[command(flatten)]
    pub frames: FrameOptions,

    #[command(flatten)]
    pub machine: MachineOptions,

    /// Print statistics: a table to standard error, or JSON to standard output. Tests are counted in a second run
    #[arg(long, value_name = "FORM", num_args = 0..=1, require_equals = true, default_missing_value = "table")]
    #[arg(help_heading = "Messages")]
    pub stats: Option<StatsForm>,
    /// Take the scene's warnings as errors
    #[arg(long, help_heading = "Messages")]
    pub strict: bool,
    /// Print nothing but errors
    #[arg(short, long, help_heading = "Messages")]
    pub quiet: bool,
}

impl RenderOptions {
    /// All defaults: what `raywarp` alone does.
    pub fn built_in() -> Self {
        Self::parse_from(["raywarp"])
    }

    /// What was asked for; the scene's own and raywarp's defaults fill the rest.
    pub fn overrides(&self) -> RenderDefaults {
        self.picture.values.or(&self.light.values).or(&self.machine.structure.values)
    }

    /// The same with what a scene asks for. The built-in one is the paper's figure, which has a sample a pixel.
    pub fn settings(&self, scene: &Scene) -> RenderDefaults {
        let paper = RenderDefaults { spp: self.scene.is_none().then_some(1), ..RenderDefaults::default() };
        self.overrides().or(&scene.render).or(&paper)
    }

    /// Gives a scene what was asked for instead of its own.
    pub fn change(&self, loaded: &mut Loaded, outputs: &mut Outputs) -> Result<()> {
        let scene = &mut loaded.scene;
        scene.up = self.camera.viewpoint().scene_up;
        if let Some(Backdrop::Color(color)) = self.background {
            scene.background = Some(Background::constant(color));
        }
        self.environment.change(loaded, outputs)
    }
}

/// Forms of the statistics. Without documentation of each: clap would spread the whole help over two lines an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StatsForm {
    Table,
    Json,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_asked_for_unless_it_is() {
        assert_eq!(RenderOptions::built_in().overrides(), RenderDefaults::default());
    }

    #[test]
    fn the_built_in_scene_has_one_sample_a_pixel_and_others_have_four() {
        let samples = |words: &[&str]| RenderOptions::parse_from(words).settings(&Scene::default()).spp();
        assert_eq!(samples(&["render"]), 1);
        assert_eq!(samples(&["render", "--samples", "9"]), 9);
        assert_eq!(samples(&["render", "a.obj"]), 4);
    }
}
