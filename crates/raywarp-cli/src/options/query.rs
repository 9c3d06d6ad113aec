//! Options of `raywarp query`.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use raywarp::query::files::{Format, Mode};

use super::MachineOptions;
use crate::values;

const EXAMPLES: &str = "\
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

/// Options of `query`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
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
