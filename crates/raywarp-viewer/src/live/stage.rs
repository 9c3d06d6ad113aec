//! The scene on its device, shared by all viewers.

use std::path::PathBuf;
use std::sync::mpsc;

use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::backend::Device;
use raywarp::render::Tracer;
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
#[derive(Clone, Copy, Debug, Default)]
pub struct StageOptions {
    /// Structure; none: the fastest on the device.
    pub accel: Option<AccelKind>,
    /// Quality of the tree that is swapped in when it is ready.
    pub quality: Quality,
    /// Whether trees are kept on disk.
    pub cached: bool,
}

/// The scene, from the first byte read.
pub struct Stage {
    source: Source,
    device: Device,
    ready: Option<Ready>,
    coming: Option<mpsc::Receiver<Result<Ready, ViewerError>>>,
    notice: Option<Notice>,
}

/// A scene that can be rendered.
pub(super) struct Ready {
    pub loaded: Loaded,
    pub tracer: Tracer,
}

impl Stage {
    /// Starts to read a scene, and returns at once.
    pub fn open(source: Source, device: Device, options: StageOptions) -> Self {
        let (sender, coming) = mpsc::channel();
        let (from, on) = (source.clone(), device.clone());
        std::thread::spawn(move || {
            let _ = sender.send(prepare(&from, &on, options));
        });
        Self { source, device, ready: None, coming: Some(coming), notice: None }
    }

    /// Takes what has become ready. Cheap; to be called before each frame.
    pub fn poll(&mut self) {
        let Some(result) = self.coming.as_ref().and_then(|coming| coming.try_recv().ok()) else { return };
        self.coming = None;
        match result {
            Ok(ready) => self.ready = Some(ready),
            Err(error) => self.notice = Some(Notice { text: error.to_string(), error: true }),
        }
    }

    /// Whether there is a scene to render.
    pub fn is_ready(&self) -> bool {
        self.ready.is_some()
    }

    /// What runs beside.
    pub fn busy(&self) -> Option<String> {
        self.coming.as_ref().map(|_| format!("reading {}", self.source.name()))
    }

    pub(super) fn ready(&self) -> Option<&Ready> {
        self.ready.as_ref()
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

fn prepare(source: &Source, device: &Device, options: StageOptions) -> Result<Ready, ViewerError> {
    let loaded = match &source.path {
        Some(path) => load::load(path, &LoadOptions { strict: source.strict, ..LoadOptions::default() })?,
        None => load::builtin()?,
    };
    let kind = options.accel.unwrap_or_else(|| AccelKind::fastest_on(device));
    let what = Build { kind, quality: options.quality, cached: options.cached };
    let tracer = Tracer::new(&loaded.scene, what, device)?;
    Ok(Ready { loaded, tracer })
}
