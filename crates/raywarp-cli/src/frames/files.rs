//! The files of each frame: which they are, and whether they are there.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use raywarp::image::{png, probe, Format, Found, Layer, Rgb8};
use raywarp::write::{self, Outputs};

use super::names::Template;
use super::range::Range;
use crate::failure::{ensure, Context, Result};
use crate::messages;
use crate::options::RenderOptions;
use crate::output::{add_statistics, Plan};

/// Frames that nobody names.
const USUAL: &str = "raywarp-####.png";

/// Names of the files of all frames.
#[derive(Debug)]
pub struct FrameFiles {
    outputs: Vec<Template>,
    heatmap: Option<Template>,
    layers: Vec<Layer>,
    /// The outputs as they were given.
    pub names: String,
}

impl FrameFiles {
    /// What options ask for; an animation alone needs no frames.
    ///
    /// # Errors
    /// For names without a place for the number of the frame.
    pub fn new(options: &RenderOptions) -> Result<Self> {
        let outputs = match options.output.as_slice() {
            [] if options.frames.animation.is_some() => Vec::new(),
            [] => vec![PathBuf::from(USUAL)],
            given => given.to_owned(),
        };
        ensure!(
            options.aov.is_empty() || !outputs.is_empty(),
            "--aov goes into picture files or beside them, and an animation holds the picture alone: give -o too"
        );
        Ok(Self {
            names: outputs.iter().map(|path| messages::output_name(path)).collect::<Vec<_>>().join(", "),
            outputs: outputs.iter().map(|path| Template::new(path)).collect::<Result<_, _>>()?,
            heatmap: options.heatmap.as_deref().map(Template::new).transpose()?,
            layers: options.aov.clone(),
        })
    }

    /// The files of a frame.
    ///
    /// # Errors
    /// Where they contradict each other.
    pub fn plan(&self, frame: u32) -> Result<Plan> {
        let outputs: Vec<_> = self.outputs.iter().map(|name| name.path(frame)).collect();
        Plan::of(&outputs, self.heatmap.as_ref().map(|name| name.path(frame)), &self.layers)
    }

    /// Adds every file to the outputs of the run, once it is known that it has a name of its own and a directory to be
    /// written into.
    ///
    /// # Errors
    /// Where one does not, and where one is read.
    pub fn check(&self, range: Range, options: &RenderOptions, run: &mut Outputs) -> Result<()> {
        options.frames.animation.iter().try_for_each(|path| run.add(path))?;
        let mut directories = HashSet::new();
        for (index, frame) in range.frames().enumerate() {
            let plan = self.plan(frame)?;
            plan.check_standard_output(options)?;
            // Standard output takes frame after frame.
            for path in plan.paths().filter(|path| index == 0 || !write::is_dash(path)) {
                run.add(path)?;
                // One file tells whether there is a right to write into its directory.
                if directories.insert(write::directory_of(path)) {
                    write::check(path)?;
                }
            }
        }
        add_statistics(options, run)
    }
}

/// What is there of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum There {
    /// All of it, and whole.
    All,
    /// Not every file, or not the whole of each.
    Part,
    /// Files that were made of something else.
    Other,
}

/// What is there of a frame of this size and fingerprint; with `shown` one file has to show its pixels.
///
/// # Errors
/// For a picture of another size that does not say how it was made: somebody may miss it. And for one that cannot be
/// read.
pub fn there(plan: &Plan, size: [u32; 2], fingerprint: &str, shown: bool) -> Result<There> {
    let layers = plan.layer_pictures().map(|path| (path, Format::Png));
    let pictures = plan.pictures().iter().map(|(path, format)| (path.as_path(), *format)).chain(layers);
    let mut there = if shown && shown_in(plan).is_none() { There::Part } else { There::All };
    let mut files = 0;
    for (path, format) in pictures {
        files += 1;
        there = there.max(file_there(path, format, Some(size), fingerprint)?);
    }
    if let Some(path) = plan.heatmap() {
        files += 1;
        there = there.max(file_there(path, Format::Png, None, fingerprint)?);
    }
    Ok(if files == 0 { There::Part } else { there })
}

fn file_there(path: &Path, format: Format, size: Option<[u32; 2]>, fingerprint: &str) -> Result<There> {
    let found = probe(path, format).with_context(|| format!("cannot read {}", path.display()))?;
    let Some(Found { size: [width, height], fingerprint: made_of }) = found else { return Ok(There::Part) };
    if let (Some(wanted), None) = (size, &made_of) {
        ensure!(
            wanted == [width, height],
            "{} is there, of {width}x{height} pixels instead of {}x{}: render into another place, or give \
             --overwrite",
            path.display(),
            wanted[0],
            wanted[1]
        );
    }
    Ok(if made_of.as_deref() == Some(fingerprint) { There::All } else { There::Other })
}

/// The file that holds a frame's pixels.
fn shown_in(plan: &Plan) -> Option<&Path> {
    plan.pictures().iter().find(|picture| picture.1 == Format::Png).map(|picture| picture.0.as_path())
}

/// The pixels of a frame that is there.
///
/// # Errors
/// Where it has gone or is no PNG within.
pub fn read_back(plan: &Plan) -> Result<Rgb8> {
    let path = shown_in(plan).context("the frame has no PNG")?;
    png::read(path).context("give --overwrite to render it anew")
}
