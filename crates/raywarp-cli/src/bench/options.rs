//! Options of `bench`.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use raywarp::accel::Quality;
use raywarp::device::DeviceChoice;
use raywarp::query::RayKind;

use super::suite::SubjectOptions;
use crate::failure::{ensure, Result};
use crate::options::DEVICES;
use crate::values;

const EXAMPLES: &str = "\
Examples:
  raywarp bench                                           the built-in scene, every kind of ray
  raywarp bench model.obj --rays primary,diffuse --layout kd,bvh --tree fast,high
  raywarp bench model.ply --device cpu --peers            beside Embree and Warp, one thread each
  raywarp bench --suite docs/bench/suite.toml --models DIR --json
  raywarp bench --frames                                  whole pictures, by every structure
  raywarp bench --trees model.glb --tree fast,medium      how soon a tree is there
  raywarp bench --live model.glb --size 1920x1080         the viewer, while somebody turns the scene

docs/bench/README.md says what the rays and the columns are.";

/// Sizes, if the options do not say.
const FULL_HD: [u32; 2] = [1920, 1080];
const ULTRA_HD: [u32; 2] = [3840, 2160];

/// Options of `bench`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct BenchOptions {
    /// Which scenes.
    #[command(flatten)]
    pub subjects: SubjectOptions,

    /// Time whole pictures, without and with shadows and bounces, instead of rays
    #[arg(long, conflicts_with_all = [
        "rays", "tree", "min_rays", "warmup", "name", "eye", "target", "up", "fov", "suite", "counts", "peers",
    ])]
    #[arg(help_heading = "What to measure")]
    pub frames: bool,
    /// Time the building of trees instead of rays, of each quality that --tree names: fast ones by the device, from
    /// triangles that it has, others by the host, once, with the copy to the device
    #[arg(long, conflicts_with_all = [
        "frames", "live", "rays", "layout", "min_rays", "eye", "target", "up", "fov", "size", "counts", "peers",
    ])]
    #[arg(help_heading = "What to measure")]
    pub trees: bool,
    /// Time the viewer instead of rays, without a window, while a drag turns the camera: at full size as fast as it can
    /// ('full'), and with the size that 60 frames a second allow ('held'); and what encoding for a browser takes
    #[arg(long, conflicts_with_all = ["frames", "rays", "repeats", "min_rays", "counts", "peers"])]
    #[arg(help_heading = "What to measure")]
    pub live: bool,
    /// Kinds of rays, with commas: primary, shadow, ao (ambient occlusion), reflected, diffuse, random; none: all
    #[arg(long, value_name = "LIST", value_delimiter = ',', help_heading = "What to measure")]
    #[arg(value_parser = values::words::<RayKind>(RayKind::ALL.map(RayKind::name)), hide_possible_values = true)]
    pub rays: Vec<RayKind>,
    /// Structures, with commas: brute, kd, bvh2, bvh, bvh8f (CPUs); none: the fastest on the device, with --frames
    /// brute, kd and that (brute takes hours on a CPU), with --live the viewer's own
    #[arg(long, visible_alias = "accel", value_name = "LIST", value_delimiter = ',')]
    #[arg(help_heading = "What to measure")]
    pub layout: Vec<String>,
    /// Qualities of the trees, with commas: fast, medium, high
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "medium")]
    #[arg(help_heading = "What to measure")]
    #[arg(value_parser = values::words::<Quality>(Quality::ALL.map(Quality::name)), hide_possible_values = true)]
    pub tree: Vec<Quality>,
    /// Count nodes and triangles a ray as well, on the CPU
    #[arg(long, help_heading = "What to measure")]
    pub counts: bool,
    /// Give the same rays to other ray tracers, and compare times and hits: embree (Python package embreex), warp
    /// (warp-lang); without a list both
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 0.., require_equals = true)]
    #[arg(default_missing_values = ["embree", "warp"], value_parser = ["embree", "warp"], hide_possible_values = true)]
    #[arg(help_heading = "What to measure")]
    pub peers: Vec<String>,
    /// The Python that has the packages
    #[arg(long, value_name = "PATH", default_value = "python3", requires = "peers", help_heading = "What to measure")]
    #[arg(value_hint = ValueHint::ExecutablePath)]
    pub python: PathBuf,

    /// Timed repeats; none: 20, with --frames 9
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1, 1000))]
    #[arg(help_heading = "How often")]
    pub repeats: Option<u32>,
    /// Repeats before those, not timed; with --live pictures, and more if a quarter of --seconds has room for them
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = values::whole::<u32>(0, 1000))]
    #[arg(help_heading = "How often")]
    pub warmup: u32,
    /// Seconds of --live that are timed, for each scene, size and case; longer where they hold fewer than three pictures
    #[arg(long, value_name = "SECONDS", default_value_t = 3.0, value_parser = values::seconds, requires = "live")]
    #[arg(help_heading = "How often")]
    pub seconds: f64,
    /// Size of the picture in pixels; with --live one or several, with commas; none: 1920x1080, with --live 3840x2160 too
    #[arg(long, value_name = "WxH", value_delimiter = ',', value_parser = values::size, help_heading = "How often")]
    pub size: Vec<[u32; 2]>,
    /// Rays of a kind at least, so that they fill a GPU: several from each hit; and as many random rays
    #[arg(long, value_name = "N", default_value_t = 2_000_000)]
    #[arg(value_parser = values::whole::<u32>(1, 1_000_000_000), help_heading = "How often")]
    pub min_rays: u32,

    /// Where to trace: auto (a GPU if there is one), cpu, cuda, cuda:N
    #[arg(long, value_name = "DEVICE", default_value_t, help_heading = "Machine")]
    #[arg(value_parser = values::words::<DeviceChoice>(DEVICES), hide_possible_values = true)]
    pub device: DeviceChoice,
    /// Threads of the CPU; none: all, beside peers one
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1, 4096), help_heading = "Machine")]
    pub threads: Option<u32>,
    /// Print one JSON object
    #[arg(long, help_heading = "Machine")]
    pub json: bool,
}

impl BenchOptions {
    /// The size where there is one.
    ///
    /// # Errors
    /// Where there are several.
    pub fn one_size(&self) -> Result<[u32; 2]> {
        ensure!(self.size.len() < 2, "only --live takes several sizes, and --size has {}", self.size.len());
        Ok(self.size.first().copied().unwrap_or(FULL_HD))
    }

    /// Those of `--live`.
    pub fn sizes(&self) -> Vec<[u32; 2]> {
        if self.size.is_empty() {
            vec![FULL_HD, ULTRA_HD]
        } else {
            self.size.clone()
        }
    }
}
