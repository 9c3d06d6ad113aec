//! Which scenes to measure: files of the command line, or a suite with names and cameras.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueHint};
use raywarp::scene::{LoadError, Viewpoint};
use serde::Deserialize;

use crate::values;

/// Which scenes to measure.
#[derive(Debug, Args)]
pub struct SubjectOptions {
    /// Scene files; none: the built-in scene, which is the paper's
    #[arg(value_hint = ValueHint::FilePath)]
    pub scenes: Vec<PathBuf>,
    /// Name of the scene in the results; none: its file's
    #[arg(long, value_name = "NAME", help_heading = "Scene")]
    pub name: Option<String>,
    /// Put the camera there
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::vector)]
    #[arg(help_heading = "Scene")]
    pub eye: Option<[f32; 3]>,
    /// Look at this point
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::vector)]
    #[arg(help_heading = "Scene")]
    pub target: Option<[f32; 3]>,
    /// What is up in the picture: a vector or an axis, such as +Z
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, value_parser = values::direction)]
    #[arg(help_heading = "Scene")]
    pub up: Option<[f32; 3]>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::field_of_view, help_heading = "Scene")]
    pub fov: Option<f64>,
    /// Scenes with names and cameras, of a TOML file; those without their model are left out
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "name", "eye", "target", "up", "fov"])]
    #[arg(help_heading = "Scene")]
    #[arg(value_hint = ValueHint::FilePath)]
    pub suite: Option<PathBuf>,
    /// Where the models of the suite are; none: beside the suite
    #[arg(long, value_name = "DIR", requires = "suite", help_heading = "Scene")]
    #[arg(value_hint = ValueHint::DirPath)]
    pub models: Option<PathBuf>,
    /// Scenes of the suite, with commas; none: all
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "suite", help_heading = "Scene")]
    pub only: Vec<String>,
}

impl SubjectOptions {
    /// What is to be different about the camera.
    pub fn view(&self) -> Viewpoint {
        let (eye, target, up, fov) = (self.eye, self.target, self.up, self.fov);
        Viewpoint { eye, target, up, fov, ..Viewpoint::default() }
    }
}

/// Name of the scene without a file.
pub const BUILT_IN: &str = "built-in";

/// A scene to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// In the results.
    pub name: String,
    /// None: the built-in scene.
    pub file: Option<PathBuf>,
    /// What is different about its camera.
    pub view: Viewpoint,
    /// Whether it may be left out if the file is not there.
    pub optional: bool,
}

impl Subject {
    /// Why it is left out, if it is.
    pub fn absent(&self) -> Option<String> {
        let file = self.file.as_deref().filter(|file| self.optional && !file.exists())?;
        Some(format!("left out, as there is no {}", file.display()))
    }
}

/// A file of scenes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Suite {
    scenes: Vec<Entry>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    /// Relative to the folder of models; none: the built-in scene.
    file: Option<PathBuf>,
    eye: Option<[f32; 3]>,
    target: Option<[f32; 3]>,
    up: Option<[f32; 3]>,
    fov: Option<f64>,
}

/// What the options name, in their order.
///
/// # Errors
/// A suite that cannot be read, a scene that it does not have, one camera for several scenes.
pub fn subjects(options: &SubjectOptions) -> anyhow::Result<Vec<Subject>> {
    match &options.suite {
        Some(suite) => of_suite(suite, options),
        None => of_files(options),
    }
}

fn of_files(options: &SubjectOptions) -> anyhow::Result<Vec<Subject>> {
    let view = options.view();
    let particular = options.name.is_some() || view != Viewpoint::default();
    anyhow::ensure!(
        options.scenes.len() < 2 || !particular,
        "--name, --eye, --target, --up and --fov are for one scene, and there are {}; measure them one by one, or write \
         a suite (see --suite)",
        options.scenes.len()
    );
    let subject = |file: Option<&PathBuf>| {
        let stem = file.map_or(BUILT_IN.into(), |file| file.file_stem().unwrap_or_default().to_string_lossy());
        let name = options.name.clone().unwrap_or(stem.into_owned());
        Subject { name, file: file.cloned(), view: view.clone(), optional: false }
    };
    Ok(match options.scenes.is_empty() {
        true => vec![subject(None)],
        false => options.scenes.iter().map(|file| subject(Some(file))).collect(),
    })
}

fn of_suite(path: &Path, options: &SubjectOptions) -> anyhow::Result<Vec<Subject>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read the suite {}", path.display()))?;
    let help = "docs/bench/suite.toml is an example.";
    let suite: Suite = toml::from_str(&text).map_err(|error| LoadError::of_toml(path, &text, &error, help))?;
    let beside = path.parent().unwrap_or(Path::new(""));
    let models = options.models.as_deref().unwrap_or(beside);
    for name in &options.only {
        let known = || suite.scenes.iter().map(|entry| entry.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = suite.scenes.iter().any(|entry| entry.name == *name);
        anyhow::ensure!(found, "the suite {} has no scene '{name}'; it has {}", path.display(), known());
    }
    let wanted = |entry: &Entry| options.only.is_empty() || options.only.contains(&entry.name);
    suite.scenes.into_iter().filter(wanted).map(|entry| entry.subject(models)).collect()
}

impl Entry {
    fn subject(self, models: &Path) -> anyhow::Result<Subject> {
        if let Some(fov) = self.fov {
            let checked = values::field_of_view(&fov.to_string());
            checked.map_err(|reason| anyhow::anyhow!("the fov of '{}' is {fov}: {reason}", self.name))?;
        }
        let (eye, target, up, fov) = (self.eye, self.target, self.up, self.fov);
        let view = Viewpoint { eye, target, up, fov, ..Viewpoint::default() };
        Ok(Subject { name: self.name, file: self.file.map(|file| models.join(file)), view, optional: true })
    }
}
