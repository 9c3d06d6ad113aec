//! From a file to a scene on the device, on a thread beside the loop that draws.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::SystemTime;

use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::device::Device;
use raywarp::device_scene::{world_triangles, Levels, Structure};
use raywarp::render::{self, Tracer};
use raywarp::scene::load::{self, Attempt};
use raywarp::scene::{Background, Camera, Instance, LoadOptions, Loaded, Material, Scene};

use super::{LiveSceneOptions, Source};
use crate::live::edits::Edits;
use crate::live::view_settings::ViewSettings;
use crate::live::watch::{Watch, WatchError};
use crate::ViewerError;

/// What to read, and for what.
pub struct Order {
    pub source: Source,
    pub device: Device,
    pub options: LiveSceneOptions,
    /// What people have changed so far.
    pub edits: Option<Edits>,
    /// The structure that people have chosen.
    pub chosen: Option<Build>,
}

/// What became of it.
pub struct Prepared {
    pub result: Result<Ready, ViewerError>,
    /// Over all files that were asked for.
    pub watch: Option<Result<Watch, WatchError>>,
    /// Whether one of them has changed since reading began, and is not known to be read as it is now.
    pub changed: bool,
}

/// A scene that can be rendered.
pub struct Ready {
    pub tracer: Tracer,
    /// Geometry and images; the rest as it was when the tracer was made.
    pub scene: Arc<Scene>,
    /// As the files say, without geometry and images.
    pub read: Scene,
    /// Of the scene, for those that must not be written over.
    pub files: Vec<PathBuf>,
    pub edits: Edits,
    /// Instances as the device has them.
    pub placed: Vec<Instance>,
    /// The first view, and the cameras of the scene.
    pub home: Camera,
    /// Whether those have targets: the ones of glTF have a direction alone.
    pub aimed: bool,
    /// Options that people have not changed.
    pub usual: ViewSettings,
    /// The structure that files and options ask for.
    pub first: Build,
    /// The one that the files alone ask for.
    pub natural: Build,
    /// What people should know of the files, a sentence each.
    pub warnings: Vec<String>,
}

impl Order {
    pub fn prepare(self) -> Prepared {
        let begun = SystemTime::now();
        let attempt = match &self.source.path {
            Some(path) => load::attempt(path, &LoadOptions { strict: self.source.strict }),
            None => Attempt { result: load::builtin(), files: Vec::new() },
        };
        // Before the rest, which takes long: what changes meanwhile is told.
        let watched = self.source.watch && self.source.path.is_some();
        let watch = watched.then(|| Watch::new(&attempt.files, || ()));
        let is_young = |path: &PathBuf| path.metadata().and_then(|file| file.modified()).is_ok_and(|at| at >= begun);
        let changed = watched && attempt.files.iter().any(is_young);
        let result = attempt.result.map_err(ViewerError::from).and_then(|loaded| self.set_up(loaded));
        Prepared { result, watch, changed }
    }

    fn set_up(self, loaded: Loaded) -> Result<Ready, ViewerError> {
        let Loaded { mut scene, warnings, files, .. } = loaded;
        scene.up = self.options.viewpoint.scene_up;
        scene.environment = self.options.environment.clone().or(scene.environment);
        scene.background = self.options.background.map(Background::constant).or(scene.background);
        let read = scene.outline();
        let edits = match self.edits {
            Some(mut edits) => {
                edits.rebase(&scene);
                edits
            }
            None => Edits::new(&scene),
        };
        edits.apply(&mut scene);
        let overrides = self.options.overrides.or(&read.render);
        let build = |overrides| Build::wished(overrides, &self.device, self.options.cached);
        let (first, natural) = (build(&overrides), build(&read.render));
        let good = self.chosen.unwrap_or(first);
        let count: usize =
            scene.instances.iter().map(|i| scene.meshes.get(i.mesh).map_or(0, |mesh| mesh.triangles.len())).sum();
        // What is over instances is built but once.
        let is_instanced = Levels::Auto.are_two(&scene);
        let what = if is_instanced || count < self.options.at_once { good } else { quick(good) };
        let tracer = Tracer::new(&scene, what, &self.device)?;
        let dropped = tracer.report().dropped;
        dropped.allow(self.source.strict)?;
        tracer.scene().structure().load_kernels(&self.device)?;
        let [width, height] = overrides.size().map(f64::from);
        let home = render::chosen_camera(&scene, &self.options.viewpoint, width / height)?;
        render::check_camera(&home)?;
        let viewpoint = &self.options.viewpoint;
        let framed = viewpoint.frames() || scene.cameras.is_empty();
        let aimed = framed || viewpoint.target.is_some() || !self.source.is_gltf();
        let mut warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        if dropped.count() > 0 {
            warnings.push(format!("triangles that no ray can hit, {} of them, are dropped", dropped.count()));
        }
        let (placed, usual) = (scene.instances.clone(), ViewSettings::of(&overrides));
        Ok(Ready {
            tracer,
            scene: Arc::new(scene),
            read,
            files,
            edits,
            placed,
            home,
            aimed,
            usual,
            natural,
            first,
            warnings,
        })
    }
}

/// The tree that people wait for.
fn quick(good: Build) -> Build {
    Build { quality: Quality::Fast, cached: false, ..good }
}

/// The tree that can follow what moves.
pub fn movable() -> Build {
    quick(Build::from(AccelKind::Bvh))
}

/// Another structure for a scene, with its kernels.
pub fn structure(
    scene: &Scene,
    instances: &[Instance],
    materials: &[Material],
    device: &Device,
    what: Build,
) -> Result<Structure, ViewerError> {
    let structure = Structure::build(device, what, world_triangles(scene, instances, materials)?)?;
    structure.load_kernels(device)?;
    Ok(structure)
}
