//! The scene on its device, shared by all viewers.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::sync::Arc;

use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::backend::Device;
use raywarp::render::{world_triangles, Structure, Tracer};
use raywarp::scene::{load, LoadOptions, Loaded};

use super::Notice;
use crate::ViewerError;

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
#[derive(Clone, Copy, Debug)]
pub struct StageOptions {
    /// Structure; none: the fastest on the device.
    pub accel: Option<AccelKind>,
    /// Quality of the tree that is swapped in when it is ready.
    pub quality: Quality,
    /// Whether trees are kept on disk.
    pub cached: bool,
    /// Scenes of fewer triangles get that tree at once: it is there before anybody notices.
    pub at_once: usize,
}

impl Default for StageOptions {
    fn default() -> Self {
        Self { accel: None, quality: Quality::default(), cached: false, at_once: 100_000 }
    }
}

/// The scene, from the first byte read.
///
/// What takes long runs on threads of its own: reading, the tree that is quick to build, then the good one. Each is taken
/// over by [`poll`](Self::poll) between two frames. All structures give the same bits, so a picture under way goes on
/// when the tree under it changes.
pub struct Stage {
    source: Source,
    device: Device,
    options: StageOptions,
    ready: Option<Ready>,
    reading: Option<Receiver<Result<Ready, ViewerError>>>,
    building: Option<Receiver<Result<Structure, ViewerError>>>,
    notice: Option<Notice>,
    /// Grows with every scene that is taken over.
    generation: u64,
}

/// A scene that can be rendered.
pub(super) struct Ready {
    pub loaded: Arc<Loaded>,
    pub tracer: Tracer,
}

impl Stage {
    /// Starts to read a scene, and returns at once.
    pub fn open(source: Source, device: Device, options: StageOptions) -> Self {
        let mut stage =
            Self { source, device, options, ready: None, reading: None, building: None, notice: None, generation: 0 };
        stage.reload();
        stage
    }

    /// Reads the scene again; the one before stays until the new one is ready, and for good where that fails.
    pub fn reload(&mut self) {
        let (source, device, at_once) = (self.source.clone(), self.device.clone(), self.options.at_once);
        let (quick, good) = (self.quick(), self.good());
        let which = move |triangles| if triangles < at_once { good } else { quick };
        self.reading = Some(beside(move || prepare(&source, &device, which)));
    }

    /// The tree that people wait for.
    fn quick(&self) -> Build {
        Build { quality: Quality::Fast, cached: false, ..self.good() }
    }

    /// The tree that is worth its time.
    fn good(&self) -> Build {
        // A bvh2 traces pictures on a GPU as fast as what is fastest for all kinds of rays, and can follow what moves.
        let fastest = || if self.device.is_cuda() { AccelKind::Bvh2 } else { AccelKind::fastest_on(&self.device) };
        let kind = self.options.accel.unwrap_or_else(fastest);
        Build { kind, quality: self.options.quality, cached: self.options.cached }
    }

    /// Takes what has become ready. Cheap; to be called before each frame.
    pub fn poll(&mut self) {
        if let Some(result) = received(&mut self.reading) {
            match result {
                Ok(ready) => self.take(ready),
                Err(error) => self.fail(error),
            }
        }
        if let Some(result) = received(&mut self.building) {
            match (result, &mut self.ready) {
                (Ok(structure), Some(ready)) => drop(ready.tracer.replace(structure)),
                (Err(error), _) => self.fail(error),
                (Ok(_), None) => {}
            }
        }
    }

    fn take(&mut self, ready: Ready) {
        self.notice = ready.loaded.warnings.first().map(|first| {
            let more = ready.loaded.warnings.len() - 1;
            let rest = if more == 0 { String::new() } else { format!(" (and {more} more warnings)") };
            Notice { text: format!("{first}{rest}"), error: false }
        });
        self.generation += 1;
        let (good, built) = (self.good(), ready.tracer.structure());
        let is_good = built.kind == good.kind && built.quality == good.quality;
        if !is_good {
            let (loaded, device) = (ready.loaded.clone(), self.device.clone());
            self.building = Some(beside(move || build(&loaded, &device, good)));
        }
        self.ready = Some(ready);
    }

    fn fail(&mut self, error: ViewerError) {
        self.notice = Some(Notice { text: error.to_string(), error: true });
    }

    /// Whether there is a scene to render.
    pub fn is_ready(&self) -> bool {
        self.ready.is_some()
    }

    /// What runs beside.
    pub fn busy(&self) -> Option<String> {
        match (&self.reading, &self.building) {
            (Some(_), _) => Some(format!("reading {}", self.source.name())),
            (None, Some(_)) => Some("building a better tree".to_owned()),
            (None, None) => None,
        }
    }

    pub(super) fn ready(&self) -> Option<&Ready> {
        self.ready.as_ref()
    }

    pub(super) fn generation(&self) -> u64 {
        self.generation
    }

    /// The scene's name.
    pub fn name(&self) -> String {
        self.source.name()
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// What went wrong last.
    pub fn notice(&self) -> Option<&Notice> {
        self.notice.as_ref()
    }
}

/// What a thread has sent; nothing while it runs. One that ended without a word is forgotten.
fn received<T>(from: &mut Option<Receiver<T>>) -> Option<T> {
    match from.as_ref()?.try_recv() {
        Ok(result) => {
            *from = None;
            Some(result)
        }
        Err(TryRecvError::Empty) => None,
        Err(TryRecvError::Disconnected) => {
            *from = None;
            None
        }
    }
}

/// Runs what takes long on threads of its own: among those that trace frames it would hold a frame up.
fn beside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, ViewerError> + Send + 'static,
) -> Receiver<Result<T, ViewerError>> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let threads = (rayon::current_num_threads() / 2).max(1);
        let result = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => pool.install(work),
            // Without threads of its own it still gets done.
            Err(_) => work(),
        };
        // Whoever asked may be gone.
        let _ = sender.send(result);
    });
    receiver
}

fn prepare(source: &Source, device: &Device, which: impl Fn(usize) -> Build) -> Result<Ready, ViewerError> {
    let loaded = match &source.path {
        Some(path) => load::load(path, &LoadOptions { strict: source.strict })?,
        None => load::builtin()?,
    };
    let triangles = |i: &raywarp::scene::Instance| loaded.scene.meshes.get(i.mesh).map_or(0, |m| m.triangles.len());
    let count: usize = loaded.scene.instances.iter().map(triangles).sum();
    let tracer = Tracer::new(&loaded.scene, which(count), device)?;
    tracer.structure().load_kernels(device)?;
    Ok(Ready { loaded: Arc::new(loaded), tracer })
}

fn build(loaded: &Loaded, device: &Device, good: Build) -> Result<Structure, ViewerError> {
    let scene = &loaded.scene;
    let triangles = world_triangles(scene, &scene.instances, &scene.materials)?;
    let structure = Structure::build(device, good, triangles)?;
    structure.load_kernels(device)?;
    Ok(structure)
}
