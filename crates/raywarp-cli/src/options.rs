//! Every option of the program. Help, man pages and completions are made from these definitions.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum, ValueHint};
use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::backend::{Device, DeviceChoice};
use raywarp::image::{Layer, ToneMap};
use raywarp::query::files::{Format, Mode};
use raywarp::render::{MAX_DEPTH, MAX_SPP};
use raywarp::scene::{RenderDefaults, Scene, Viewpoint};
use raywarp_viewer::live::view_settings::MAX_SAMPLES;
use raywarp_viewer::live::{LiveSceneOptions, Source};

pub use crate::bench::BenchOptions;
pub use crate::frames::FrameOptions;
use crate::values;

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
  raywarp view model.obj                   walk around it in a window or the browser
  raywarp query model.obj --rays rays.npy  what each of many rays hits, to hits.npz
  raywarp serve model.glb                  walk through a scene in a browser, also one far away
  raywarp info scene.gltf                  what is in a scene
  raywarp doctor                           whether a GPU can be used, and if not what to do

`raywarp render --help` has all options of rendering.

Exit codes: 0 done, 2 usage or scene error, 3 device error, 130 interrupted";

const RENDER_EXAMPLES: &str = "\
Examples:
  raywarp render scene.toml -o a.png -o a.exr --samples 16
  raywarp render model.glb --eye 3,2,5 --target 0,1,0 --fov 35
  raywarp render --accel kd --heatmap cost.png --stats
  raywarp render scene.obj -o a.exr --aov depth,normal,primitive
  raywarp render scene.ply -o - | display
  raywarp render model.glb --frames 1..240 --orbit -o out/frame-####.png
  raywarp render scene.toml --frames 1..96 --path tour --animation tour.mp4

The same scene, options and seed give the same picture on any number of threads.";

const VIEW_EXAMPLES: &str = "\
Examples:
  raywarp view model.glb
  raywarp view scene.toml --watch --size 1920x1080

H shows what keys and pointer do. The window is the program raywarp-window, which is built apart:
without it, or without a display, the scene is shown in a browser at the address that is printed.
--size and --fullscreen are the window's.";

const QUERY_EXAMPLES: &str = "\
Examples:
  raywarp query scene.obj --rays rays.npy -o hits.npz
  raywarp query scene.ply --rays rays.csv --mode count -o counts.npy
  raywarp query scene.glb --rays - --mode any -o - --format csv < rays.npy

Rays: an array of float32 as numpy.save writes it, of any shape whose last axis is 6 (origin,
direction) or 8 (origin, t_min, direction, t_max); or CSV with as many columns. Directions need not
be unit vectors: t counts in their length. Both ends count, and a negative t_min reaches behind the
origin. A ray hits nothing that has NaN anywhere, an infinite origin or direction, a direction of
zero, or t_min > t_max.

Answers: t (inf for a miss), primitive and geometry (triangle of a mesh, instance of the scene;
4294967295 for a miss) and uv (weights of vertices 1 and 2); occluded; count; or for 'all' offsets
and the hits of all rays, those of ray i from offsets[i] to offsets[i + 1] and by distance.
docs/query.md has examples.";

const SERVE_EXAMPLES: &str = "\
Examples:
  raywarp serve model.glb                      open the address that it prints
  raywarp serve scene.toml --port 0 --token    any free port, and a secret, where others share the machine
  raywarp serve model.glb --host 0.0.0.0       for a whole network, always with a secret

The picture is rendered here and shown there; the browser needs no GPU. On a machine that is reached by
ssh, run the line that is printed on your own and open the address there. docs/serve.md has the rest.";

/// Words for devices; `cuda:N` has too many to list.
pub const DEVICES: [&str; 3] = ["auto", "cpu", "cuda"];

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
    Serve(ServeOptions),
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

/// Options of `render`.
#[derive(Debug, Parser)]
#[command(after_help = RENDER_EXAMPLES)]
pub struct RenderOptions {
    /// Scene file: .obj, .ply, .stl, .gltf, .glb, or .toml (see docs/scene-file.md); none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,

    /// Picture file, .png (sRGB) or .exr (linear), or - for PNG to standard output; may be repeated; none: raywarp.png
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub output: Vec<PathBuf>,
    /// Layers, with commas: depth, normal, albedo, uv, position, primitive, material, tests; within an EXR, beside a
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

    /// Size of the picture in pixels [default: the scene file's, else 1920x1080]
    #[arg(long, value_name = "WxH", value_parser = values::size, help_heading = "Picture")]
    pub size: Option<[u32; 2]>,
    /// Render only columns x0 to x1 and rows y0 to y1, in pixels from the upper left, x1 and y1 excluded
    #[arg(long, value_name = "x0,y0,x1,y1", value_parser = values::crop, help_heading = "Picture")]
    pub crop: Option<[u32; 4]>,
    /// Samples a pixel [default: the scene file's, else 1]
    #[arg(long = "samples", visible_alias = "spp", value_name = "N", value_parser = values::whole::<u32>(1, MAX_SPP.into()))]
    #[arg(help_heading = "Picture")]
    pub spp: Option<u32>,
    #[command(flatten)]
    pub shading: ShadingOptions,

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

    /// What was asked for; the scene's wishes and raywarp's own defaults fill the rest.
    pub fn overrides(&self) -> RenderDefaults {
        let own = RenderDefaults { size: self.size, spp: self.spp, ..RenderDefaults::default() };
        own.or(&self.shading.overrides()).or(&self.machine.overrides())
    }
}

/// Forms of the statistics. Without documentation of each: clap would spread the whole help over two lines an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StatsForm {
    Table,
    Json,
}

/// Options of `view`.
#[derive(Debug, Args)]
#[command(after_help = VIEW_EXAMPLES)]
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

/// How a scene is shown to people: options of `view` and `serve`.
#[derive(Debug, Args)]
pub struct LiveOptions {
    /// Samples a pixel that the picture goes up to at rest [default: the scene file's, else 64]
    #[arg(long = "samples", visible_alias = "spp", value_name = "N", value_parser = values::whole::<u32>(1, MAX_SAMPLES.into()))]
    #[arg(help_heading = "Picture")]
    pub spp: Option<u32>,
    #[command(flatten)]
    pub shading: ShadingOptions,
    #[command(flatten)]
    pub camera: CameraOptions,
    #[command(flatten)]
    pub machine: MachineOptions,
}

impl LiveOptions {
    /// The same in the viewer's words.
    pub fn live_scene(&self) -> LiveSceneOptions {
        let own = RenderDefaults { spp: self.spp, ..RenderDefaults::default() };
        LiveSceneOptions {
            overrides: own.or(&self.shading.overrides()).or(&self.machine.overrides()),
            viewpoint: self.camera.viewpoint(),
            cached: !self.machine.no_cache,
            ..LiveSceneOptions::default()
        }
    }
}

/// Options of `query`.
#[derive(Debug, Args)]
#[command(after_help = QUERY_EXAMPLES)]
pub struct QueryOptions {
    /// Scene file: .obj, .ply, .stl, .gltf, .glb, or .toml (see docs/scene-file.md); none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,

    /// Rays: a .npy or CSV file, or - for standard input
    #[arg(short, long, value_name = "FILE")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub rays: PathBuf,
    /// What to ask: closest, any, count, all
    #[arg(short, long, value_name = "MODE", default_value_t)]
    #[arg(value_parser = values::words::<Mode>(Mode::ALL.map(Mode::name)), hide_possible_values = true)]
    pub mode: Mode,
    /// Hits that 'all' and 'count' stop at; none: all of them
    #[arg(long, value_name = "K", value_parser = values::whole::<u32>(0, u32::MAX.into()))]
    pub max_hits: Option<u32>,
    /// Answers: a .npz, .npy (a single array: any, count) or .csv file, or - for standard output
    #[arg(short, long, value_name = "FILE", default_value = "hits.npz")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub output: PathBuf,
    /// Format of the answers: npz, npy, csv; none: by the file's name, csv to standard output
    #[arg(long, value_name = "FORMAT")]
    #[arg(value_parser = values::words::<Format>(Format::ALL.map(Format::name)), hide_possible_values = true)]
    pub format: Option<Format>,

    #[command(flatten)]
    pub machine: MachineOptions,

    /// Print one JSON object about the run
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
    /// Take the scene's warnings as errors
    #[arg(long, help_heading = "Messages")]
    pub strict: bool,
    /// Print nothing but errors
    #[arg(short, long, help_heading = "Messages")]
    pub quiet: bool,
}

/// Options of `serve`.
#[derive(Debug, Args)]
#[command(after_help = SERVE_EXAMPLES)]
pub struct ServeOptions {
    /// Scene file: .obj, .ply, .stl, .gltf, .glb, or .toml (see docs/scene-file.md); none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,

    /// Port; 0 takes any that is free
    #[arg(long, value_name = "N", default_value_t = 8787, value_parser = values::whole::<u16>(0, 65535))]
    #[arg(help_heading = "Network")]
    pub port: u16,
    /// Address to listen at: of this machine only as it stands, 0.0.0.0 for all networks
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1", help_heading = "Network")]
    pub host: String,
    /// Let in only who has the printed address, which works once, or a secret; for any other address than this machine's
    /// own there always is one
    #[arg(long, help_heading = "Network")]
    pub token: bool,
    /// Let in only who knows the secret in this file, one line of 8 to 128 characters; none: the secret of RAYWARP_TOKEN,
    /// if that is set
    #[arg(long, value_name = "FILE", help_heading = "Network")]
    pub token_file: Option<PathBuf>,
    /// Most browsers at a time
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = values::whole::<u32>(1, 1000))]
    #[arg(help_heading = "Network")]
    pub viewers: u32,

    /// Read the scene again when its file changes
    #[arg(long, help_heading = "Scene")]
    pub watch: bool,
    /// Take the scene's warnings as errors
    #[arg(long, help_heading = "Scene")]
    pub strict: bool,

    #[command(flatten)]
    pub live: LiveOptions,
}

/// Options of `info`.
#[derive(Debug, Args)]
pub struct InfoOptions {
    /// Scene file; none: the built-in scene
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Take the scene's warnings as errors
    #[arg(long)]
    pub strict: bool,
}

/// Options of `completions`.
#[derive(Debug, Args)]
pub struct CompletionsOptions {
    /// The shell
    pub shell: clap_complete::Shell,
}

/// Options of `man`.
#[derive(Debug, Args)]
pub struct ManOptions {
    /// Write raywarp.1, raywarp-render.1 and so on there
    #[arg(value_hint = ValueHint::DirPath)]
    pub directory: Option<PathBuf>,
}

/// From where to look: options of every command that makes pictures.
#[derive(Debug, Args)]
pub struct CameraOptions {
    /// A camera of the scene, by its name or its number from 0; none: the first, or one that frames everything
    #[arg(long, value_name = "NAME|INDEX", help_heading = "Camera")]
    pub camera: Option<String>,
    /// Put the camera there
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::vector)]
    #[arg(help_heading = "Camera")]
    pub eye: Option<[f32; 3]>,
    /// Look at this point
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::vector)]
    #[arg(help_heading = "Camera")]
    pub target: Option<[f32; 3]>,
    /// What is up in the picture: a vector or an axis, such as +Z
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::direction)]
    #[arg(help_heading = "Camera")]
    pub up: Option<[f32; 3]>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::field_of_view, help_heading = "Camera")]
    pub fov: Option<f64>,
    /// Parallel rays, for a picture of this height in scene units
    #[arg(long, value_name = "HEIGHT", value_parser = values::height, conflicts_with = "fov", help_heading = "Camera")]
    pub ortho: Option<f32>,
}

impl CameraOptions {
    /// The same in the library's words.
    pub fn viewpoint(&self) -> Viewpoint {
        let (eye, target, up, fov) = (self.eye, self.target, self.up, self.fov);
        Viewpoint { camera: self.camera.clone(), eye, target, up, fov, height: self.ortho }
    }
}

/// How light goes and how it is shown: options of every command that makes pictures.
#[derive(Debug, Args)]
pub struct ShadingOptions {
    /// Mirrored and refracted rays in a row, 0 to 16 [default: the scene file's, else 5]
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(0, MAX_DEPTH.into()))]
    #[arg(help_heading = "Picture")]
    pub max_depth: Option<u32>,
    /// Let every light reach everything
    #[arg(long, overrides_with = "shadows", help_heading = "Picture")]
    pub no_shadows: bool,
    /// Let lights cast shadows, as they do unless the scene file says otherwise
    #[arg(long, overrides_with = "no_shadows", help_heading = "Picture")]
    pub shadows: bool,
    /// Start of the random numbers that place the samples [default: the scene file's, else 0]
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(0, u32::MAX.into()), help_heading = "Picture")]
    pub seed: Option<u32>,
    /// Brighten by EV stops, in PNG only: EXR holds the radiance itself [default: the scene file's, else 0]
    #[arg(long, value_name = "EV", allow_hyphen_values = true, value_parser = values::exposure)]
    #[arg(help_heading = "Picture")]
    pub exposure: Option<f32>,
    /// What PNG does with radiance above 1: clamp, filmic [default: the scene file's, else clamp]
    #[arg(long, value_name = "CURVE", help_heading = "Picture")]
    #[arg(value_parser = values::words::<ToneMap>(ToneMap::ALL.map(ToneMap::name)), hide_possible_values = true)]
    pub tone_map: Option<ToneMap>,
}

impl ShadingOptions {
    /// What was asked for.
    pub fn overrides(&self) -> RenderDefaults {
        RenderDefaults {
            max_depth: self.max_depth,
            shadows: if self.no_shadows { Some(false) } else { self.shadows.then_some(true) },
            seed: self.seed,
            exposure: self.exposure,
            tone_map: self.tone_map,
            ..RenderDefaults::default()
        }
    }
}

/// Where to trace, and through what: options of every command that traces a scene.
#[derive(Debug, Args)]
pub struct MachineOptions {
    /// Where to trace: auto (a GPU if there is one), cpu, cuda, cuda:N
    #[arg(long, value_name = "DEVICE", default_value_t, help_heading = "Machine")]
    #[arg(value_parser = values::words::<DeviceChoice>(DEVICES), hide_possible_values = true)]
    pub device: DeviceChoice,
    /// How to find hits: brute (every triangle), kd (the paper's k-d tree), or a hierarchy of boxes: bvh2, bvh2c, bvh, bvh8f
    /// (for CPUs) [default: the scene file's, else the fastest on the device]
    #[arg(long, value_name = "KIND", help_heading = "Machine")]
    #[arg(value_parser = values::words::<AccelKind>(AccelKind::ALL.map(AccelKind::name)), hide_possible_values = true)]
    pub accel: Option<AccelKind>,
    /// How good a hierarchy of boxes should be: fast (to build), medium, high (to trace) [default: the scene file's,
    /// else medium]
    #[arg(long, value_name = "QUALITY", help_heading = "Machine")]
    #[arg(value_parser = values::words::<Quality>(Quality::ALL.map(Quality::name)), hide_possible_values = true)]
    pub tree: Option<Quality>,
    /// Build the tree anew instead of looking for it in the user's cache, or in the folder of RAYWARP_CACHE
    #[arg(long, help_heading = "Machine")]
    pub no_cache: bool,
    /// Threads of the CPU; none: all
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1, 4096), help_heading = "Machine")]
    pub threads: Option<u32>,
}

impl MachineOptions {
    /// What was asked for.
    pub fn overrides(&self) -> RenderDefaults {
        RenderDefaults { accel: self.accel, tree: self.tree, ..RenderDefaults::default() }
    }

    /// What to build of a scene on a device.
    pub fn build(&self, scene: &Scene, device: &Device) -> Build {
        Build::wished(&self.overrides().or(&scene.render), device, !self.no_cache)
    }
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};
    use raywarp::scene::{degrees, Camera, Projection};

    #[test]
    fn the_definitions_are_consistent() {
        super::Options::command().debug_assert();
    }

    #[test]
    fn nothing_is_asked_for_unless_it_is() {
        assert_eq!(super::RenderOptions::built_in().overrides(), raywarp::scene::RenderDefaults::default());
    }

    #[test]
    fn defaults_in_the_help_are_those_of_the_library() {
        use raywarp::{image::Development, render::RenderOptions, scene::RenderDefaults};
        let (usual, development) = (RenderOptions::default(), Development::default());
        let [width, height] = usual.size;
        let stated = [
            ("size", format!("{width}x{height}")),
            ("spp", usual.spp.to_string()),
            ("max_depth", usual.max_depth.to_string()),
            ("seed", usual.seed.to_string()),
            ("exposure", development.exposure.to_string()),
            ("tone_map", development.tone_map.to_string()),
            ("tree", raywarp::accel::Quality::default().to_string()),
        ];
        let command = super::RenderOptions::command();
        for (option, default) in stated {
            let argument = command.get_arguments().find(|argument| argument.get_id() == option).unwrap();
            let help = argument.get_help().unwrap().to_string();
            assert!(help.ends_with(&format!("[default: the scene file's, else {default}]")), "{help}");
        }
        assert!(usual.shadows && RenderOptions::from(&RenderDefaults::default()) == usual);
    }

    fn asked(words: &[&str]) -> Result<Camera, clap::Error> {
        let options = super::RenderOptions::try_parse_from([&["render"], words].concat())?;
        let projection = Projection::Perspective { fov_y: 0.5 };
        let camera = Camera { name: String::new(), eye: [0.0; 3], target: [0.0; 3], up: [0.0; 3], projection };
        Ok(options.camera.viewpoint().adjust(camera))
    }

    #[test]
    fn every_angle_can_be_asked_for() {
        for i in 1..2000 {
            let fov_y = 0.0015 * i as f32;
            let camera = asked(&["--fov", &degrees(fov_y).to_string()]).unwrap();
            assert_eq!(camera.projection, Projection::Perspective { fov_y });
        }
    }

    #[test]
    fn parallel_rays_have_a_height_and_no_angle() {
        let camera = asked(&["--eye", "-1e-9,2,3.5e20", "--ortho", "2.5"]).unwrap();
        assert_eq!((camera.eye, camera.projection), ([-1e-9, 2.0, 3.5e20], Projection::Orthographic { height: 2.5 }));
        assert!(asked(&["--ortho", "2.5", "--fov", "40"]).is_err());
        assert!(asked(&["--ortho", "0"]).is_err());
    }
}
