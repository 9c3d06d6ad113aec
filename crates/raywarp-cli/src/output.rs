//! Which files are written, and writing them.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use raywarp::image::{exr, false_color, heatmap, png, Development, Format, Layer, Layers, Picture, Provenance, Rgb8};
use raywarp::write::{self, Outputs};

use crate::failure::{ensure, Result};
use crate::interrupt::Interrupt;
use crate::messages;
use crate::options::{RenderOptions, StatsForm};
use crate::provenance::Origin;
use crate::values::Backdrop;

/// The picture of a run that names none.
const USUAL: &str = "raywarp.png";

/// Every file that a picture becomes.
#[derive(Debug)]
pub struct Plan {
    pictures: Vec<(PathBuf, Format)>,
    layers: Vec<Layer>,
    layer_pictures: Vec<(PathBuf, Layer)>,
    heatmap: Option<PathBuf>,
}

/// What the files are made of.
pub struct Results<'a> {
    picture: &'a Picture,
    layers: &'a Layers,
    development: Development,
    heatmap_max: Option<u64>,
    provenance: Provenance,
    is_transparent: bool,
    shown: OnceCell<Rgb8>,
}

impl<'a> Results<'a> {
    /// The picture; the layers, if any are asked for, with tests for a heat map; and what they were made of.
    pub fn new(picture: &'a Picture, layers: &'a Layers, origin: &Origin) -> Self {
        let Origin { heatmap_max, background, .. } = *origin;
        let development = Development::from(&origin.settings);
        let (provenance, is_transparent) = (origin.provenance(), background == Some(Backdrop::None));
        Self { picture, layers, development, heatmap_max, provenance, is_transparent, shown: OnceCell::new() }
    }

    /// The picture as a PNG shows it.
    pub fn shown(&self) -> &Rgb8 {
        self.shown.get_or_init(|| png::tone_map(self.picture, &self.development))
    }
}

impl Plan {
    /// The files that options ask for, each known to be writable and added to the outputs of the run.
    ///
    /// # Errors
    /// Where they contradict each other, one cannot be written, or one is read.
    pub fn new(options: &RenderOptions, run: &mut Outputs) -> Result<Self> {
        let usual = [PathBuf::from(USUAL)];
        let outputs = if options.output.is_empty() { &usual } else { options.output.as_slice() };
        let plan = Self::of(outputs, options.heatmap.clone(), &options.aov)?;
        plan.check(options, run)?;
        Ok(plan)
    }

    /// These pictures, a heat map, and layers within or beside the pictures.
    ///
    /// # Errors
    /// Where they contradict each other.
    pub fn of(outputs: &[PathBuf], heatmap: Option<PathBuf>, layers: &[Layer]) -> Result<Self> {
        let mut layers = layers.to_owned();
        layers.sort();
        layers.dedup();
        let mut plan = Self { pictures: Vec::new(), layers, layer_pictures: Vec::new(), heatmap };
        for path in outputs {
            plan.add(path)?;
        }
        if let Some(path) = &plan.heatmap {
            let is_png = Format::of(path)? == Format::Png;
            ensure!(is_png, "the heat map {} is a PNG: end its name in .png", path.display());
        }
        Ok(plan)
    }

    fn add(&mut self, path: &Path) -> Result<()> {
        let format = Format::of(path)?;
        if format == Format::Png && !self.layers.is_empty() {
            ensure!(
                !write::is_dash(path),
                "--aov names its files after the picture, and standard output has no name: give -o a file"
            );
            let beside = |&layer: &Layer| (path.with_extension(format!("{layer}.png")), layer);
            self.layer_pictures.extend(self.layers.iter().map(beside));
        }
        self.pictures.push((path.to_owned(), format));
        Ok(())
    }

    fn check(&self, options: &RenderOptions, run: &mut Outputs) -> Result<()> {
        self.check_standard_output(options)?;
        for path in self.paths() {
            run.add(path)?;
            write::check(path)?;
        }
        add_statistics(options, run)
    }

    /// Refuses statistics within a picture.
    pub fn check_standard_output(&self, options: &RenderOptions) -> Result<()> {
        let taken = self.paths().any(write::is_dash) && options.stats == Some(StatsForm::Json);
        ensure!(!taken, "--stats=json and a picture cannot both go to standard output: give -o a file");
        Ok(())
    }

    /// Every file.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        let pictures = self.pictures.iter().map(|picture| picture.0.as_path());
        let layers = self.layer_pictures.iter().map(|picture| picture.0.as_path());
        pictures.chain(layers).chain(self.heatmap.as_deref())
    }

    /// The picture files.
    pub fn pictures(&self) -> &[(PathBuf, Format)] {
        &self.pictures
    }

    /// The layers' own pictures.
    pub fn layer_pictures(&self) -> impl Iterator<Item = &Path> {
        self.layer_pictures.iter().map(|picture| picture.0.as_path())
    }

    /// The heat map, if one is asked for.
    pub fn heatmap(&self) -> Option<&Path> {
        self.heatmap.as_deref()
    }

    /// The layers that are asked for, each once.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Whether tests have to be counted.
    pub fn needs_tests(&self) -> bool {
        self.heatmap.is_some() || self.layers.contains(&Layer::Tests)
    }

    /// The picture files by name, with commas.
    pub fn names(&self) -> String {
        let names: Vec<_> = self.pictures.iter().map(|picture| messages::output_name(&picture.0)).collect();
        names.join(", ")
    }

    /// Writes every file. Says what the colours of layers and heat maps mean.
    pub fn write(&self, results: &Results, target: Target, quiet: bool) -> Result<()> {
        for (path, format) in &self.pictures {
            let bytes = match format {
                Format::Png if results.is_transparent => {
                    png::encode_transparent(results.picture, &results.development, Some(&results.provenance))?
                }
                Format::Png => png::encode_described(results.shown(), Some(&results.provenance))?,
                Format::Exr => {
                    let (layers, provenance) = (Some(results.layers), Some(&results.provenance));
                    exr::encode_described(results.picture, layers, &self.layers, provenance)?
                }
            };
            target.put(path, &bytes)?;
        }
        for (path, layer) in &self.layer_pictures {
            target.put_explained(path, false_color::draw(results.layers, *layer)?, results, quiet)?;
        }
        if let (Some(path), Some(tests)) = (&self.heatmap, &results.layers.tests) {
            let Picture { width, height, .. } = *results.picture;
            let (picture, scale) = heatmap::draw(width, height, tests, results.heatmap_max);
            target.put_explained(path, (picture, scale.to_string()), results, quiet)?;
        }
        Ok(())
    }
}

/// The outputs of a command that writes its results to standard output alone.
///
/// # Errors
/// None; as for [`Outputs::add`].
pub fn to_standard_output() -> Result<Outputs> {
    let mut run = Outputs::default();
    run.add(Path::new(write::STANDARD))?;
    Ok(run)
}

/// Statistics on standard output may go to a file, too.
pub fn add_statistics(options: &RenderOptions, run: &mut Outputs) -> Result<()> {
    match options.stats {
        Some(StatsForm::Json) => Ok(run.add(Path::new(write::STANDARD))?),
        _ => Ok(()),
    }
}

/// Where files go: none of them is read, and none is cut short.
#[derive(Clone, Copy)]
pub struct Target<'a> {
    /// What the run reads and writes.
    pub run: &'a Outputs,
    /// What ends it.
    pub interrupt: &'a Interrupt,
}

impl Target<'_> {
    fn put_explained(
        self,
        path: &Path,
        (picture, meaning): (Rgb8, String),
        results: &Results,
        quiet: bool,
    ) -> Result<()> {
        self.put(path, &png::encode_described(&picture, Some(&results.provenance))?)?;
        if !quiet {
            messages::line(&format!("{}: {meaning}", messages::path(path)));
        }
        Ok(())
    }

    fn put(self, path: &Path, bytes: &[u8]) -> Result<()> {
        // A pipe may wait for its reader for ever: Ctrl-C has to work there, and leaves no file.
        let _held = (!write::is_dash(path)).then(|| self.interrupt.hold());
        Ok(self.run.file(path, bytes)?)
    }
}
