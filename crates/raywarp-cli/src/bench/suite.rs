//! Which scenes to measure: files of the command line, or a suite with names and cameras.

use std::path::{Path, PathBuf};

use anyhow::Context;
use raywarp::scene::Viewpoint;
use serde::Deserialize;

use super::options::BenchOptions;
use crate::values;

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
    /// Relative to the folder of models.
    file: PathBuf,
    eye: Option<[f32; 3]>,
    target: Option<[f32; 3]>,
    up: Option<[f32; 3]>,
    fov: Option<f64>,
}

/// What the options name, in their order.
///
/// # Errors
/// A suite that cannot be read, a scene that it does not have, one camera for several scenes.
pub fn subjects(options: &BenchOptions) -> anyhow::Result<Vec<Subject>> {
    match &options.suite {
        Some(suite) => of_suite(suite, options),
        None => of_files(options),
    }
}

fn of_files(options: &BenchOptions) -> anyhow::Result<Vec<Subject>> {
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

fn of_suite(path: &Path, options: &BenchOptions) -> anyhow::Result<Vec<Subject>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read the suite {}", path.display()))?;
    let suite: Suite = toml::from_str(&text).with_context(|| format!("{} is no suite of scenes", path.display()))?;
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
        Ok(Subject { name: self.name, file: Some(models.join(self.file)), view, optional: true })
    }
}
