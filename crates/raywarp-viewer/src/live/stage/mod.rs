//! The scene on its device, shared by all viewers.
//!
//! What takes long runs `beside`: [`prepare`] reads the scene and builds the tree that is quick to build, then comes the
//! good one. [`Stage::poll`] takes over what is ready, between two frames. All structures give the same bits, so a picture
//! under way goes on when the tree under it changes.
//!
//! Lights, materials and places of instances change on the device as they are; boxes are refitted. Only a `bvh2` can follow
//! what moves: another structure gives way to one at the first move, and comes back when all has been at rest for a while.

mod beside;
mod prepare;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use raywarp::accel::{AccelKind, Build};
use raywarp::backend::Device;
use raywarp::render::Structure;
use raywarp::scene::{RenderDefaults, Viewpoint};

use super::edits::{Edits, Touched};
use super::watch::Watch;
use super::Notice;
use crate::ViewerError;
use beside::{take, Beside};
use prepare::{Order, Prepared};

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
    /// For people: the file's name.
    pub fn name(&self) -> String {
        let file = self.path.as_ref().and_then(|path| path.file_name());
        file.map_or("the built-in scene".to_owned(), |name| name.to_string_lossy().into_owned())
    }
}

/// How to prepare it.
#[derive(Clone, Debug)]
pub struct StageOptions {
    /// What is asked for instead of the scene's own defaults, the structure among it.
    pub wishes: RenderDefaults,
    /// The first view.
    pub viewpoint: Viewpoint,
    /// Whether trees are kept on disk.
    pub cached: bool,
    /// Scenes of fewer triangles get their good tree at once: it is there before anybody notices.
    pub at_once: usize,
}

impl Default for StageOptions {
    fn default() -> Self {
        let (wishes, viewpoint) = (RenderDefaults::default(), Viewpoint::default());
        Self { wishes, viewpoint, cached: false, at_once: 100_000 }
    }
}

/// Nothing has moved for so long: worth a good tree.
const REST: Duration = Duration::from_millis(700);

/// The scene, from the first byte read.
pub struct Stage {
    source: Source,
    device: Device,
    options: StageOptions,
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
    failure: Option<ViewerError>,
    generation: u64,
    edition: u64,
    trees: u64,
}

/// A structure under way.
struct Building {
    work: Beside<Result<Structure, ViewerError>>,
    what: Build,
    /// Of the motion it was begun at; none for one that takes over from whatever cannot move.
    shape: Option<u64>,
    /// Of the motion it was begun at.
    flags: u64,
}

/// What has moved on the device, or should.
#[derive(Default)]
struct Motion {
    /// Grows with each change of the triangles.
    shape: u64,
    /// Instances that the device still has at their old places.
    pending: BTreeSet<usize>,
    /// Whether the structure does not know which triangles let light through.
    stale: bool,
    /// Grows each time that it does not.
    flags: u64,
    /// Whether boxes were refitted since the structure was built.
    refitted: bool,
    last: Option<Instant>,
}

impl Stage {
    /// Starts to read a scene, and returns at once.
    pub fn open(source: Source, device: Device, options: StageOptions) -> Self {
        let mut stage = Self {
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
            failure: None,
            generation: 0,
            edition: 0,
            trees: 0,
        };
        stage.reload();
        stage
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
            match done.unwrap_or_else(|error| Prepared { result: Err(error), watch: None }) {
                Prepared { result: Ok(ready), watch } => self.take(ready, watch),
                Prepared { result: Err(error), watch } => {
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
            more => format!("{first} (and {more} more warnings: `raywarp info` tells all)"),
        });
        self.notice = None;
        warning.into_iter().for_each(|text| self.tell(text, false));
        self.watch_with(watch);
        (self.building, self.motion) = (None, Motion::default());
        let before = self.ready.replace(ready);
        (self.generation, self.edition, self.trees) = (self.generation + 1, self.edition + 1, self.trees + 1);
        // What was changed while the files were read.
        let Some((mut edits, ready)) = before.map(|before| before.edits).zip(self.ready.as_mut()) else { return };
        if edits.changed_since(&ready.edits) {
            edits.rebase(&ready.scene);
            ready.edits = edits;
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
        if self.ready.is_none() {
            self.failure = Some(error);
        }
    }

    fn tell(&mut self, text: String, error: bool) {
        (self.notice, self.told) = (Some(Notice { text, error }), self.told + 1);
    }

    /// Takes over a structure that is done, if its triangles are still those of the scene.
    fn take_structure(&mut self) -> Result<(), ViewerError> {
        let Some(building) = self.building.take() else { return Ok(()) };
        let Building { work, what, shape, flags } = building;
        let mut place = Some(work);
        let Some(done) = take(&mut place, || ViewerError::Lost("building a tree")) else {
            self.building = place.map(|work| Building { work, what, shape, flags });
            return Ok(());
        };
        let Some(ready) = &mut self.ready else { return Ok(()) };
        let structure = match done.and_then(|result| result) {
            Ok(structure) => structure,
            Err(error) => {
                // Another try would end the same way: what there is has to do.
                (self.motion.refitted, self.chosen) = (false, Some(built(ready)));
                return Err(error);
            }
        };
        match shape {
            Some(shape) if shape != self.motion.shape => Ok(()),
            Some(_) => {
                drop(ready.tracer.replace(structure));
                (self.motion.refitted, self.trees) = (false, self.trees + 1);
                Ok(())
            }
            None => {
                drop(ready.tracer.replace(structure));
                self.motion.stale &= flags != self.motion.flags;
                (self.edition, self.trees) = (self.edition + 1, self.trees + 1);
                self.follow()
            }
        }
    }

    /// Begins to build a better structure, where one is wanted and nothing moves.
    fn improve(&mut self) -> Result<(), ViewerError> {
        let rests = self.motion.last.is_none_or(|last| last.elapsed() > REST);
        let settled = self.motion.pending.is_empty() && !self.motion.stale;
        let (Some(ready), Some(wanted)) = (&self.ready, self.wanted()) else { return Ok(()) };
        let as_wanted = Build { cached: wanted.cached, ..built(ready) } == wanted;
        if self.building.is_none() && rests && settled && (!as_wanted || self.motion.refitted) {
            // A tree of a scene that somebody arranges is seen once.
            let what = Build { cached: wanted.cached && self.motion.shape == 0, ..wanted };
            self.build(what, Some(self.motion.shape));
        }
        Ok(())
    }

    /// Builds a structure over the triangles as the device has them.
    fn build(&mut self, what: Build, shape: Option<u64>) {
        let Some(ready) = &self.ready else { return };
        let (scene, device) = (Arc::clone(&ready.scene), self.device.clone());
        let (instances, materials) = (ready.placed.clone(), ready.edits.scene().materials.clone());
        let work = Beside::start(move || prepare::structure(&scene, &instances, &materials, &device, what));
        self.building = Some(Building { work, what, shape, flags: self.motion.flags });
    }

    /// Brings what people changed to the device. Failures become a notice.
    pub(super) fn bring(&mut self, touched: &[Touched]) {
        if let Err(error) = self.change(touched) {
            self.fail(error);
        }
    }

    fn change(&mut self, touched: &[Touched]) -> Result<(), ViewerError> {
        let Some(ready) = &mut self.ready else { return Ok(()) };
        let edited = ready.edits.scene();
        for touched in touched {
            match *touched {
                Touched::Lights => ready.tracer.set_lights(edited),
                Touched::Materials => {
                    let known = ready.tracer.set_materials(&edited.materials, &ready.scene.images)?;
                    // Whether the built-in lights are needed depends on what glows.
                    ready.tracer.set_lights(edited);
                    self.motion.stale |= !known;
                    self.motion.flags += u64::from(!known);
                }
                Touched::Instance(index) => _ = self.motion.pending.insert(index),
            }
        }
        self.edition += u64::from(!touched.is_empty());
        self.follow()
    }

    /// Moves what should have moved, or has a structure built that can.
    fn follow(&mut self) -> Result<(), ViewerError> {
        if self.motion.pending.is_empty() && !self.motion.stale {
            return Ok(());
        }
        self.motion.shape += 1;
        self.motion.last = Some(Instant::now());
        let Some(ready) = &mut self.ready else { return Ok(()) };
        if self.motion.stale || ready.tracer.structure().kind != AccelKind::Bvh2 {
            if self.building.as_ref().is_none_or(|building| building.shape.is_some()) {
                self.build(prepare::movable(), None);
            }
            return Ok(());
        }
        let instances = &ready.edits.scene().instances;
        for index in std::mem::take(&mut self.motion.pending) {
            if !ready.tracer.move_instance(&ready.scene, instances, index)? {
                // Turned inside out: everything is made anew.
                self.reload();
                return Ok(());
            }
            ready.placed[index].clone_from(&instances[index]);
        }
        (self.motion.refitted, self.edition, self.trees) = (true, self.edition + 1, self.trees + 1);
        Ok(())
    }

    /// Asks for another structure.
    pub(super) fn choose(&mut self, what: Build) {
        (self.chosen, self.building) = (Some(what), None);
        if let Err(error) = self.follow() {
            self.fail(error);
        }
    }

    /// The structure that is wanted, once there is a scene.
    fn wanted(&self) -> Option<Build> {
        self.chosen.or(self.ready.as_ref().map(|ready| ready.first))
    }

    /// The structure that is wanted, and the one that was at first.
    pub(super) fn builds(&self) -> [Build; 2] {
        let first = self.ready.as_ref().map(|ready| ready.first).unwrap_or_default();
        [self.chosen.unwrap_or(first), first]
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

    /// Why there is no scene and none is coming: once.
    pub fn take_failure(&mut self) -> Option<ViewerError> {
        self.failure.take()
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

/// The structure that there is.
fn built(ready: &Ready) -> Build {
    let structure = ready.tracer.structure();
    Build { kind: structure.kind, quality: structure.quality, ..Build::default() }
}
