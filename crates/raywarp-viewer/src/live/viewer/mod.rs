//! One pair of eyes on the live scene: camera, options, picture.

mod frame_pool;
mod input;
mod rendering;
mod resets;
mod save;

use std::sync::Weak;
use std::time::Duration;

use raywarp::accel::TreeBox;
use raywarp::device::Staging;
use raywarp::render::Film;
use raywarp::scene::Camera;

use super::camera_control::CameraControl;
use super::live_scene::Ready;
use super::meter::Meter;
use super::object_drag::ObjectDrag;
use super::outline::Outline;
use super::pace::Pace;
use super::panel_rows::{self, Shown};
use super::pick::Pick;
use super::pointer::Clicks;
use super::view_settings::ViewSettings;
use super::{Legend, LiveScene, Notice, Panel, Status};

use frame_pool::FramePool;
use resets::Resets;

/// Pixels to show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Columns and rows. Fewer than the viewer's size while the camera moves: the front end scales them up.
    pub size: [u32; 2],
    /// Red, green, blue and 255 of each pixel, sRGB, top row first.
    pub rgba: Vec<u8>,
    /// Whether nothing more is coming until something happens: worth sending without loss.
    pub settled: bool,
}

/// Most pixels a side; more is not shown by any screen, and asked for by mistake.
const MOST: u32 = 1 << 14;

/// One viewer.
pub struct Viewer {
    size: [u32; 2],
    view_settings: ViewSettings,
    /// The options that nobody has changed.
    usual: ViewSettings,
    control: Option<CameraControl>,
    clicks: Clicks,
    object_drag: ObjectDrag,
    pick: Option<Pick>,
    resets: Resets,
    /// Of the live scene, as the picture shows it.
    generation: u64,
    edition: u64,
    trees: u64,
    /// Of the structure, where they are shown.
    boxes: Option<Vec<TreeBox>>,
    /// Of what is picked, with what it depends on.
    outline: Option<(Outlined, Outline)>,
    /// A coarse picture while something moves: whole, and shown where the one at rest has no sample yet.
    moving: Option<Film>,
    resting: Option<Film>,
    /// Whether the latter still has the samples of another view.
    resting_is_old: bool,
    pace: Pace,
    /// What the picture on show still lacks.
    lacks: Lacks,
    moved: Option<Duration>,
    last: Option<Duration>,
    staging: Staging<u32>,
    frames: FramePool,
    meter: Meter,
    legend: Option<Legend>,
    notice: Option<Notice>,
    /// Of the last file that was asked for.
    exported: Weak<()>,
    /// Notices of the stage that were there when something was done after them.
    read: u64,
}

/// What an outline depends on.
#[derive(Clone, Debug, PartialEq)]
struct Outlined {
    camera: Camera,
    size: [u32; 2],
    instance: usize,
    edition: u64,
}

/// How much of the picture has to be made anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Lacks {
    Nothing,
    /// More samples of the same.
    Samples,
    /// The same samples, shown otherwise.
    Developing,
    /// The same view in another size.
    Size,
    /// All of it.
    Everything,
}

impl Viewer {
    /// With a picture of so many pixels.
    pub fn new(size: [u32; 2]) -> Self {
        Self {
            size: size.map(|side| side.clamp(1, MOST)),
            view_settings: ViewSettings::default(),
            usual: ViewSettings::default(),
            control: None,
            clicks: Clicks::default(),
            object_drag: ObjectDrag::default(),
            pick: None,
            resets: Resets::default(),
            generation: 0,
            edition: 0,
            trees: 0,
            boxes: None,
            outline: None,
            moving: None,
            resting: None,
            resting_is_old: false,
            pace: Pace::default(),
            lacks: Lacks::Everything,
            moved: None,
            last: None,
            staging: Staging::default(),
            frames: FramePool::default(),
            meter: Meter::default(),
            legend: None,
            notice: None,
            exported: Weak::new(),
            read: 0,
        }
    }

    /// The options; those that a front end offers before the first frame.
    pub fn look_mut(&mut self) -> &mut ViewSettings {
        self.lacks = Lacks::Everything;
        &mut self.view_settings
    }

    /// The camera, once there is a scene.
    pub fn camera(&self) -> Option<&Camera> {
        self.control.as_ref().map(CameraControl::camera)
    }

    /// Whether the camera or an object is held: by a drag, or a key.
    pub fn is_moving(&self) -> bool {
        self.object_drag.is_moving() || self.control.as_ref().is_some_and(CameraControl::is_moving)
    }

    fn ask(&mut self, more: Lacks) {
        self.lacks = self.lacks.max(more);
    }

    /// Takes another size. What is on show stays, scaled, until there are samples of the new size.
    fn resize(&mut self, size: [u32; 2]) {
        self.size = size.map(|side| side.clamp(1, MOST));
        if !self.resting_is_old && self.lacks < Lacks::Everything {
            self.moving = self.resting.take_if(|film| film.samples() > 0).or(self.moving.take());
        }
        self.ask(Lacks::Size);
    }

    /// Something moves: a small picture first. The time is known at the next frame.
    fn restart(&mut self) {
        (self.moved, self.lacks) = (None, Lacks::Everything);
        self.meter.changed();
    }

    /// Takes over what the stage has that is new: at a new scene its camera the first time, later the view stays.
    fn catch_up(&mut self, live_scene: &LiveScene, ready: &Ready) {
        if self.edition != live_scene.edition() {
            self.edition = live_scene.edition();
            self.restart();
        }
        if self.trees != live_scene.trees() {
            (self.trees, self.boxes) = (live_scene.trees(), None);
            if self.view_settings.boxes.is_some() {
                self.ask(Lacks::Developing);
            }
        }
        if self.generation != live_scene.generation() {
            self.generation = live_scene.generation();
            self.view_settings.follow(&self.usual, &ready.usual);
            (self.usual, self.pick, self.resets) = (ready.usual.clone(), None, Resets::default());
            let (home, bounds) = (ready.home.clone(), ready.tracer.report().bounds);
            let (cameras, up) = (ready.scene.cameras.clone(), ready.scene.up.unwrap_or([0.0, 1.0, 0.0]));
            match &mut self.control {
                Some(control) => control.rebase(home, cameras, bounds, up),
                None => {
                    let control = CameraControl::new(home, cameras, bounds, up);
                    self.control = Some(if ready.aimed { control } else { control.without_targets() });
                }
            }
        }
    }

    /// Whether a call of [`frame`](Self::frame) would render: a loop may sleep otherwise.
    pub fn wants_frame(&self, live_scene: &LiveScene) -> bool {
        live_scene.is_ready()
            && (self.lacks != Lacks::Nothing
                || self.edition != live_scene.edition()
                || self.view_settings.boxes.is_some() && self.trees != live_scene.trees()
                || self.control.as_ref().is_some_and(CameraControl::is_moving))
    }

    /// What to tell beside the picture.
    pub fn status(&self, live_scene: &LiveScene) -> Status {
        let ready = live_scene.ready();
        let built = ready.map(|ready| ready.tracer.scene().structure());
        Status {
            busy: live_scene.busy(),
            notice: self
                .notice
                .clone()
                .or_else(|| live_scene.notice().filter(|_| self.read < live_scene.told()).cloned()),
            scene: live_scene.name(),
            device: live_scene.device().description(),
            accel: built
                .map_or(String::new(), |built| format!("{}, {}", built.kind.unwrap_or_default(), built.quality)),
            triangles: ready.map_or(0, |ready| ready.tracer.report().triangles as u64),
            size: self.size,
            settled: self.lacks == Lacks::Nothing,
            view: self.view_settings.view.to_string(),
            legend: self.legend.clone(),
            pick: self.pick.as_ref().map(Pick::lines).unwrap_or_default(),
            statistics: self.view_settings.statistics,
            help: self.view_settings.help,
            panel: self.view_settings.panel,
            reference: self.view_settings.reference,
            ..self.meter.status()
        }
    }

    /// The side panel as it is now.
    pub fn panel(&self, live_scene: &LiveScene) -> Panel {
        panel_rows::panel(&Shown {
            view_settings: &self.view_settings,
            usual: &self.usual,
            tree: live_scene.builds(),
            camera: self.control.as_ref(),
            edits: live_scene.ready().map(|ready| &ready.edits),
            pick: self.pick.as_ref(),
        })
    }
}
