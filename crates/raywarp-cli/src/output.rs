//! Which files are written, and writing them.

use std::cell::OnceCell;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use raywarp::image::{exr, false_color, heatmap, png, Development, Format, Layer, Layers, Picture, Rgb8};
use raywarp::write;

use crate::interrupt::Interrupt;
use crate::options::{RenderOptions, StatsForm};
use crate::say;

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
    shown: OnceCell<Rgb8>,
}

impl<'a> Results<'a> {
    /// The picture; the layers, if any are asked for, with tests for a heat map; how PNG shows radiance; and the top of
    /// the heat map's scale.
    pub fn new(picture: &'a Picture, layers: &'a Layers, development: Development, heatmap_max: Option<u64>) -> Self {
        Self { picture, layers, development, heatmap_max, shown: OnceCell::new() }
    }

    /// The picture as a PNG shows it.
    pub fn shown(&self) -> &Rgb8 {
        self.shown.get_or_init(|| png::develop(self.picture, &self.development))
    }
}

impl Plan {
    /// The files that options ask for, each known to be writable.
    ///
    /// # Errors
    /// Where they contradict each other or one cannot be written.
    pub fn new(options: &RenderOptions) -> anyhow::Result<Self> {
        let usual = [PathBuf::from(USUAL)];
        let outputs = if options.output.is_empty() { &usual } else { options.output.as_slice() };
        let plan = Self::of(outputs, options.heatmap.clone(), &options.aov)?;
        plan.check(options)?;
        Ok(plan)
    }

    /// These pictures, a heat map, and layers within or beside the pictures.
    ///
    /// # Errors
    /// Where they contradict each other.
    pub fn of(outputs: &[PathBuf], heatmap: Option<PathBuf>, layers: &[Layer]) -> anyhow::Result<Self> {
        let mut layers = layers.to_owned();
        layers.sort();
        layers.dedup();
        let mut plan = Self { pictures: Vec::new(), layers, layer_pictures: Vec::new(), heatmap };
        for path in outputs {
            plan.add(path)?;
        }
        if let Some(path) = &plan.heatmap {
            let is_png = Format::of(path)? == Format::Png;
            anyhow::ensure!(is_png, "the heat map {} is a PNG: end its name in .png", path.display());
        }
        Ok(plan)
    }

    fn add(&mut self, path: &Path) -> anyhow::Result<()> {
        let format = Format::of(path)?;
        if format == Format::Png && !self.layers.is_empty() {
            anyhow::ensure!(
                !write::is_dash(path),
                "--aov names its files after the picture, and standard output has no name: give -o a file"
            );
            let beside = |&layer: &Layer| (path.with_extension(format!("{layer}.png")), layer);
            self.layer_pictures.extend(self.layers.iter().map(beside));
        }
        self.pictures.push((path.to_owned(), format));
        Ok(())
    }

    fn check(&self, options: &RenderOptions) -> anyhow::Result<()> {
        let mut seen = HashSet::new();
        for path in self.paths() {
            anyhow::ensure!(seen.insert(path), "two outputs have the same name, {}: give each its own", path.display());
            write::check(path)?;
        }
        self.check_standard_output(options)
    }

    /// Refuses statistics within a picture.
    pub fn check_standard_output(&self, options: &RenderOptions) -> anyhow::Result<()> {
        let taken = self.paths().any(write::is_dash) && options.stats == Some(StatsForm::Json);
        anyhow::ensure!(!taken, "--stats=json and a picture cannot both go to standard output: give -o a file");
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
        let name = |path: &Path| match write::is_dash(path) {
            true => "standard output".to_owned(),
            false => path.display().to_string(),
        };
        let names: Vec<_> = self.pictures.iter().map(|picture| name(&picture.0)).collect();
        names.join(", ")
    }

    /// Writes every file. Says what the colours of layers and heat maps mean.
    pub fn write(&self, results: &Results, interrupt: &Interrupt, quiet: bool) -> anyhow::Result<()> {
        for (path, format) in &self.pictures {
            let bytes = match format {
                Format::Png => png::encode(results.shown())?,
                Format::Exr => exr::encode(results.picture, Some(results.layers), &self.layers)?,
            };
            put(path, &bytes, interrupt)?;
        }
        for (path, layer) in &self.layer_pictures {
            put_explained(path, false_color::draw(results.layers, *layer)?, interrupt, quiet)?;
        }
        if let (Some(path), Some(tests)) = (&self.heatmap, &results.layers.tests) {
            let Picture { width, height, .. } = *results.picture;
            let (picture, scale) = heatmap::draw(width, height, tests, results.heatmap_max);
            put_explained(path, (picture, scale.to_string()), interrupt, quiet)?;
        }
        Ok(())
    }
}

fn put_explained(
    path: &Path,
    (picture, meaning): (Rgb8, String),
    interrupt: &Interrupt,
    quiet: bool,
) -> anyhow::Result<()> {
    put(path, &png::encode(&picture)?, interrupt)?;
    if !quiet {
        say::line(&format!("{}: {meaning}", path.display()));
    }
    Ok(())
}

fn put(path: &Path, bytes: &[u8], interrupt: &Interrupt) -> anyhow::Result<()> {
    // A pipe may wait for its reader for ever: Ctrl-C has to work there, and leaves no file.
    let _held = (!write::is_dash(path)).then(|| interrupt.hold());
    Ok(write::file(path, bytes)?)
}
