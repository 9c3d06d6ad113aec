//! The scene on its device, shared by all viewers.
//!
//! What takes long runs `beside`: [`prepare`] reads the scene and builds the tree that is quick to build, then comes the
//! good one. [`LiveScene::poll`] takes over what is ready, between two frames. All structures give the same bits, so a picture
//! under way goes on when the tree under it changes. `structures` has the trees, and what moves.
//!
//! Lights, materials and places of instances change on the device as they are. Where meshes are placed by instances, a move is
//! a transform, and the tree over them is made anew; where all is in world space, boxes are refitted. There only a `bvh2` or a `bvh` can follow
//! what moves: another structure gives way to one at the first move, and comes back when all has been at rest for a while.

mod beside;
mod prepare;
mod structures;

use std::path::{Path, PathBuf};

use raywarp::accel::Build;
use raywarp::device::Device;
use raywarp::scene::{Environment, RenderDefaults, Viewpoint};

use super::edits::{Edits, Touched};
use super::watch::Watch;
use super::Notice;
use crate::ViewerError;
use beside::{take, Beside};
use prepare::{Order, Prepared};
use structures::{Building, Motion};

pub(super) use prepare::Ready;

/// Where the scene comes from.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// The file; none for the built-in scene.
    pub path: Option<PathBuf>,
    /// Whether warnings are errors.
    pub strict: bool,
    /// Whether to read it again when it changes on disk.
    pub watch: bool,
}

impl Source {
    /// Whether it is glTF, whose cameras have a direction and no target.
    pub(super) fn is_gltf(&self) -> bool {
        let extension = self.path.as_deref().and_then(Path::extension);
        extension.is_some_and(|own| ["gltf", "glb"].iter().any(|gltf| own.eq_ignore_ascii_case(gltf)))
    }

    /// For people: the file's name.
    pub fn name(&self) -> String {
        let file = self.path.as_ref().and_then(|path| path.file_name());
        file.map_or("the built-in scene".to_owned(), |name| name.to_string_lossy().into_owned())
    }
}

/// How to prepare it.
#[derive(Clone, Debug)]
pub struct LiveSceneOptions {
    /// What is asked for instead of the scene's own defaults, the structure among it.
    pub overrides: RenderDefaults,
    /// The first view.
    pub viewpoint: Viewpoint,
    /// One linear colour beyond the scene, instead of its own background.
    pub background: Option<[f32; 3]>,
    /// What lights the scene from all around in path tracing, instead of its own environment.
    pub environment: Option<Environment>,
    /// Whether trees are kept on disk.
    pub cached: bool,
    /// Scenes of fewer triangles get their good tree at once: it is there before anybody notices.
    pub at_once: usize,
}

impl Default for LiveSceneOptions {
    fn default() -> Self {
        let (overrides, viewpoint) = (RenderDefaults::default(), Viewpoint::default());
        Self { overrides, viewpoint, background: None, environment: None, cached: false, at_once: 100_000 }
    }
}

/// Changes whenever what a stage tells may have changed: two that are equal tell the same.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveSceneVersion {
    chosen: Option<Build>,
    generation: u64,
    edition: u64,
    trees: u64,
    told: u64,
    busy: Option<String>,
}

/// The scene, from the first byte read.
pub struct LiveScene {
    source: Source,
    device: Device,
    options: LiveSceneOptions,
    ready: Option<Ready>,
    reading: Option<Beside<Prepared>>,
    /// Whether to read again once that is done.
    read_again: bool,
    building: Option<Building>,
    watch: Option<Watch>,
    /// The structure that people have chosen.
    chosen: Option<Build>,
    motion: Motion,
    notice: Option<Notice>,
    /// Notices so far.
    told: u64,
    error: Option<ViewerError>,
    generation: u64,
    edition: u64,
    trees: u64,
}

impl LiveScene {
    /// Starts to read a scene, and returns at once.
    pub fn open(source: Source, device: Device, options: LiveSceneOptions) -> Self {
        let mut live_scene = Self {
            source,
            device,
            options,
            ready: None,
            reading: None,
            read_again: false,
            building: None,
            watch: None,
            chosen: None,
            motion: Motion::default(),
            notice: None,
            told: 0,
            error: None,
            generation: 0,
            edition: 0,
            trees: 0,
        };
        live_scene.reload();
        live_scene
    }

    /// Reads the scene again; the one before stays until the new one is ready, and for good where that fails. What
    /// people changed stays changed.
    pub fn reload(&mut self) {
        self.read_again = self.reading.is_some();
        if !self.read_again {
            let (source, device, options) = (self.source.clone(), self.device.clone(), self.options.clone());
            let edits = self.ready.as_ref().map(|ready| ready.edits.clone());
            let order = Order { source, device, options, edits, chosen: self.chosen };
            self.reading = Some(Beside::start(|| order.prepare()));
        }
    }

    /// Takes what has become ready. Cheap; to be called before each frame.
    pub fn poll(&mut self) {
        if self.watch.as_ref().is_some_and(Watch::poll) {
            self.reload();
        }
        let lost = || ViewerError::Lost("reading the scene");
        if let Some(done) = take(&mut self.reading, lost) {
            let lost = |error| Prepared { result: Err(error), watch: None, changed: false };
            let Prepared { result, watch, changed } = done.unwrap_or_else(lost);
            self.read_again |= changed;
            match result {
                Ok(ready) => self.take(ready, watch),
                Err(error) => {
                    self.watch_with(watch);
                    self.fail(error);
                }
            }
            if std::mem::take(&mut self.read_again) {
                self.reload();
            }
        }
        if let Err(error) = self.take_structure().and_then(|()| self.improve()) {
            self.fail(error);
        }
    }

    fn take(&mut self, ready: Ready, watch: Option<Result<Watch, super::watch::WatchError>>) {
        let warning = ready.warnings.first().map(|first| match ready.warnings.len() - 1 {
            0 => first.clone(),
            more => format!("{first} (and {more} more warnings)"),
        });
        self.notice = None;
        warning.into_iter().for_each(|text| self.tell(text, false));
        self.watch_with(watch);
        (self.building, self.motion) = (None, Motion::default());
        let before = self.ready.replace(ready);
        (self.generation, self.edition, self.trees) = (self.generation + 1, self.edition + 1, self.trees + 1);
        // What was changed while the files were read.
        let Some((edits, ready)) = before.map(|before| before.edits).zip(self.ready.as_mut()) else { return };
        if edits.changed_since(&ready.edits) {
            ready.edits.adopt(&edits);
            let elsewhere = |&i: &usize| ready.edits.scene().instances[i].transform != ready.placed[i].transform;
            let moved = (0..ready.placed.len()).filter(elsewhere).map(Touched::Instance);
            let all: Vec<Touched> = [Touched::Lights, Touched::Materials].into_iter().chain(moved).collect();
            self.bring(&all);
        }
    }

    fn watch_with(&mut self, watch: Option<Result<Watch, super::watch::WatchError>>) {
        match watch {
            Some(Ok(watch)) => self.watch = Some(watch),
            Some(Err(error)) => self.tell(error.to_string(), true),
            None => {}
        }
    }

    fn fail(&mut self, error: ViewerError) {
        self.tell(error.to_string(), true);
        self.error = Some(error);
    }

    fn tell(&mut self, text: String, error: bool) {
        (self.notice, self.told) = (Some(Notice { text, error }), self.told + 1);
    }

    /// Whether there is a scene to render.
    pub fn is_ready(&self) -> bool {
        self.ready.is_some()
    }

    /// What runs beside.
    pub fn busy(&self) -> Option<String> {
        match (&self.reading, &self.building) {
            (Some(_), _) => Some(format!("reading {}", self.source.name())),
            (None, Some(Building { shape: None, .. })) => Some("building a tree that can move".to_owned()),
            (None, Some(Building { what, .. })) => Some(format!("building {}, {}", what.kind, what.quality)),
            (None, None) => None,
        }
    }

    /// What status and panel of a viewer that has not changed itself depend on.
    pub fn version(&self) -> LiveSceneVersion {
        let (generation, edition, trees, told) = (self.generation, self.edition, self.trees, self.told);
        LiveSceneVersion { chosen: self.chosen, generation, edition, trees, told, busy: self.busy() }
    }

    /// Why there is no scene and none is coming: once.
    pub fn take_failure(&mut self) -> Option<ViewerError> {
        self.error.take_if(|_| self.ready.is_none())
    }

    /// The last thing that went wrong, if any has since this was asked: with a scene on show it is a notice too.
    pub fn take_error(&mut self) -> Option<ViewerError> {
        self.error.take()
    }

    /// The files of the scene that is shown, missing ones included.
    pub fn files(&self) -> &[PathBuf] {
        self.ready().map(|ready| ready.files.as_slice()).unwrap_or_default()
    }

    pub(super) fn ready(&self) -> Option<&Ready> {
        self.ready.as_ref()
    }

    /// What people change.
    pub(super) fn edits_mut(&mut self) -> Option<&mut Edits> {
        self.ready.as_mut().map(|ready| &mut ready.edits)
    }

    /// Grows with every scene that is taken over.
    pub(super) fn generation(&self) -> u64 {
        self.generation
    }

    /// Grows with everything that changes what is seen.
    pub(super) fn edition(&self) -> u64 {
        self.edition
    }

    /// Grows with each change of the structure, which nothing of the picture but its boxes shows.
    pub(super) fn trees(&self) -> u64 {
        self.trees
    }

    /// Where the scene comes from.
    pub(super) fn source(&self) -> &Source {
        &self.source
    }

    /// The scene's name.
    pub fn name(&self) -> String {
        self.source.name()
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Grows with each notice.
    pub(super) fn told(&self) -> u64 {
        self.told
    }

    /// What went wrong last.
    pub fn notice(&self) -> Option<&Notice> {
        self.notice.as_ref()
    }
}
