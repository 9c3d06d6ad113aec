//! One pair of eyes on the stage: camera, options, picture.

use std::time::Duration;

use raywarp::backend::Staging;
use raywarp::image::{png, Rgb8};
use raywarp::render::{Film, Quantity, RenderOptions, Tracer};
use raywarp::scene::Camera;

use super::camera_control::CameraControl;
use super::keys::{self, Action};
use super::look::{Changed, Look, View};
use super::meter::Meter;
use super::pace::Pace;
use super::{Event, Legend, Notice, Outcome, Panel, Stage, Status};
use crate::ViewerError;

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

/// The camera rests when nothing has moved it for so long.
const REST: Duration = Duration::from_millis(120);

/// Between two looks at whether something moves.
const PAUSE: Duration = Duration::from_millis(1);

/// Longest time that a held key flies at once: after a pause the camera does not leap.
const LEAP: Duration = Duration::from_millis(100);

/// Most pixels a side; more is not shown by any screen, and asked for by mistake.
const MOST: u32 = 1 << 14;

/// One viewer.
pub struct Viewer {
    size: [u32; 2],
    look: Look,
    control: Option<CameraControl>,
    /// The camera to begin with, instead of the scene's.
    first: Option<Camera>,
    generation: u64,
    /// A small picture while the camera moves, and the whole one while it rests.
    moving: Option<Film>,
    resting: Option<Film>,
    pace: Pace,
    /// What the picture on show still lacks.
    lacks: Lacks,
    moved: Option<Duration>,
    last: Option<Duration>,
    staging: Staging<u32>,
    shown: Option<Picture>,
    meter: Meter,
    legend: Option<Legend>,
    notice: Option<Notice>,
}

/// How much of the picture has to be made anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Lacks {
    Nothing,
    /// More samples of the same.
    Samples,
    /// The same samples, shown otherwise.
    Developing,
    /// All of it.
    Everything,
}

impl Viewer {
    /// With a picture of so many pixels.
    pub fn new(size: [u32; 2]) -> Self {
        Self {
            size: size.map(|side| side.clamp(1, MOST)),
            look: Look::default(),
            control: None,
            first: None,
            generation: 0,
            moving: None,
            resting: None,
            pace: Pace::default(),
            lacks: Lacks::Everything,
            moved: None,
            last: None,
            staging: Staging::default(),
            shown: None,
            meter: Meter::default(),
            legend: None,
            notice: None,
        }
    }

    /// Begins with a camera instead of the scene's own.
    pub fn look_through(&mut self, camera: Camera) {
        self.first = Some(camera);
    }

    /// The options; those that a front end offers before the first frame.
    pub fn look_mut(&mut self) -> &mut Look {
        self.lacks = Lacks::Everything;
        &mut self.look
    }

    /// The camera, once there is a scene.
    pub fn camera(&self) -> Option<&Camera> {
        self.control.as_ref().map(CameraControl::camera)
    }

    fn ask(&mut self, more: Lacks) {
        self.lacks = self.lacks.max(more);
    }

    /// Takes an event; returns what the front end has to do.
    pub fn handle(&mut self, stage: &mut Stage, event: &Event) -> Vec<Outcome> {
        if let Event::Resize { width, height } = event {
            self.size = [*width, *height].map(|side| side.clamp(1, MOST));
            self.ask(Lacks::Everything);
        }
        let action = keys::action(event);
        if let Some(action) = action {
            match self.look.act(action) {
                Changed::No => {}
                Changed::Overlay => return Vec::new(),
                Changed::Development => self.ask(Lacks::Developing),
                Changed::Picture => self.ask(Lacks::Everything),
            }
        }
        let aspect = self.size[0] as f32 / self.size[1] as f32;
        if let Some(control) = &mut self.control {
            let before = control.camera().clone();
            control.handle(event, aspect);
            if *control.camera() != before {
                // The time is known at the next frame.
                (self.moved, self.lacks) = (None, Lacks::Everything);
            }
        }
        action.map_or(Vec::new(), |action| self.act(stage, action))
    }

    /// What keys ask of others than the camera and the options.
    fn act(&mut self, stage: &mut Stage, action: Action) -> Vec<Outcome> {
        let outcome = match action {
            Action::Screenshot => self.screenshot(),
            Action::CopyCamera => self.control.as_ref().map(|control| Outcome::Copy(control.flags())),
            Action::Quit => Some(Outcome::Quit),
            Action::Reload => {
                stage.reload();
                None
            }
            _ => None,
        };
        outcome.into_iter().collect()
    }

    fn screenshot(&mut self) -> Option<Outcome> {
        let picture = self.shown.as_ref()?;
        let pixels = picture.rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
        let [width, height] = picture.size;
        match png::encode(&Rgb8 { width, height, pixels }) {
            Ok(content) => Some(Outcome::File { name: "raywarp.png".to_owned(), content, media_type: "image/png" }),
            Err(error) => {
                self.notice = Some(Notice { text: error.to_string(), error: true });
                None
            }
        }
    }

    /// Renders for about the time of one frame; `now` counts from any fixed moment. Nothing if the last picture still
    /// holds.
    ///
    /// # Errors
    /// [`ViewerError`] where the device fails.
    pub fn frame(&mut self, stage: &mut Stage, now: Duration) -> Result<Option<Picture>, ViewerError> {
        stage.poll();
        let generation = stage.generation();
        let Some(ready) = stage.ready() else { return Ok(None) };
        if self.generation != generation {
            self.generation = generation;
            self.face(&ready.tracer, &ready.loaded.scene.cameras);
        }
        let is_moving = self.fly(now);
        if self.lacks == Lacks::Nothing {
            return Ok(None);
        }
        let Some(camera) = self.camera().cloned() else { return Ok(None) };
        let live = is_moving && !self.look.reference && self.look.view == View::Picture;
        if live && self.lacks == Lacks::Samples {
            // The small picture of this camera is there, and the whole one waits until nothing moves: who asks for frames
            // as fast as they come need not do so meanwhile.
            std::thread::sleep(PAUSE);
            return Ok(None);
        }
        self.meter.begin();
        let picture = match quantity(self.look.view) {
            Some(quantity) => self.paint(&ready.tracer, &camera, quantity, is_moving)?,
            None if live => self.move_on(&ready.tracer, &camera)?,
            None => self.refine(&ready.tracer, &camera)?,
        };
        self.meter.end();
        self.shown = Some(picture.clone());
        Ok(Some(picture))
    }

    /// Takes over a scene: its camera the first time, later the view stays.
    fn face(&mut self, tracer: &Tracer, cameras: &[Camera]) {
        let (home, bounds) = (tracer.default_camera().clone(), tracer.report().bounds);
        let (cameras, up) = (cameras.to_vec(), [0.0, 1.0, 0.0]);
        match &mut self.control {
            Some(control) => control.rebase(home, cameras, bounds, up),
            None => {
                let mut control = CameraControl::new(home, cameras, bounds, up);
                if let Some(Err(text)) = self.first.take().map(|camera| control.set(camera)) {
                    self.notice = Some(Notice { text, error: true });
                }
                self.control = Some(control);
            }
        }
        self.ask(Lacks::Everything);
    }

    /// Lets held keys move the camera; whether it moves, or has just done so.
    fn fly(&mut self, now: Duration) -> bool {
        let dt = self.last.replace(now).map_or(Duration::ZERO, |last| now.saturating_sub(last).min(LEAP));
        let Some(control) = &mut self.control else { return false };
        if control.step(dt) {
            (self.moved, self.lacks) = (None, Lacks::Everything);
        }
        let held = control.is_moving();
        if self.lacks == Lacks::Everything && self.shown.is_some() && self.moved.is_none() {
            self.moved = Some(now);
        }
        held || self.moved.is_some_and(|moved| now.saturating_sub(moved) < REST)
    }

    /// One sample a pixel of as many pixels as there is time for.
    fn move_on(&mut self, tracer: &Tracer, camera: &Camera) -> Result<Picture, ViewerError> {
        let rate = self.moving.as_ref().or(self.resting.as_ref()).map(Film::rate);
        let size = match rate {
            Some(rate) => self.pace.size(self.size, rate, self.look.frame_rate),
            None => self.pace.size(self.size, if tracer.device().is_cuda() { 2e8 } else { 1e6 }, self.look.frame_rate),
        };
        let mut film = fresh(self.moving.take(), tracer, size, rate)?;
        let options = RenderOptions { spp: 1, ..self.look.render_options(size) };
        while !self.meter.exposed(tracer.expose(&mut film, camera, &options, f64::INFINITY)?) {}
        self.meter.fetching();
        film.develop(&self.look.development, None)?;
        self.meter.samples([1, 1], size);
        let picture = self.fetch(tracer, &film, false)?;
        (self.moving, self.lacks, self.legend) = (Some(film), Lacks::Samples, None);
        self.resting = self.resting.take().filter(|film| film.size() == self.size);
        if let Some(resting) = &mut self.resting {
            resting.clear()?;
        }
        Ok(picture)
    }

    /// More samples of the whole picture.
    fn refine(&mut self, tracer: &Tracer, camera: &Camera) -> Result<Picture, ViewerError> {
        let rate = self.resting.as_ref().or(self.moving.as_ref()).map(Film::rate);
        let mut film = match self.resting.take() {
            Some(film) if film.size() == self.size && self.lacks != Lacks::Everything => film,
            other => fresh(other, tracer, self.size, rate)?,
        };
        let options = self.look.render_options(self.size);
        let complete = match self.lacks {
            Lacks::Developing if film.samples() >= options.spp => true,
            _ => {
                let budget = Pace::budget(self.look.frame_rate);
                self.meter.exposed(tracer.expose(&mut film, camera, &options, budget)?)
            }
        };
        if film.samples() > 0 && !self.meter.knows_rays() {
            self.meter.count_rays(tracer, camera, &options)?;
        }
        self.meter.fetching();
        film.develop(&self.look.development, self.moving.as_ref())?;
        self.meter.samples([film.samples(), options.spp], self.size);
        let picture = self.fetch(tracer, &film, complete)?;
        self.lacks = if complete { Lacks::Nothing } else { Lacks::Samples };
        (self.resting, self.legend) = (Some(film), None);
        Ok(picture)
    }

    /// A debug view.
    fn paint(
        &mut self,
        tracer: &Tracer,
        camera: &Camera,
        quantity: Quantity,
        is_moving: bool,
    ) -> Result<Picture, ViewerError> {
        let rate = self.moving.as_ref().map(Film::rate).filter(|_| is_moving && !self.look.reference);
        let size = rate.map_or(self.size, |rate| self.pace.size(self.size, rate, self.look.frame_rate));
        let kept = if size == self.size { self.resting.take() } else { self.moving.take() };
        let mut film = fresh(kept, tracer, size, rate)?;
        let painted = tracer.paint(&mut film, camera, &self.look.render_options(size), quantity, None)?;
        self.meter.painted(painted.kernel_seconds, size);
        self.legend = legend(quantity, painted.range, tracer.device().is_cuda());
        let settled = size == self.size;
        let picture = self.fetch(tracer, &film, settled)?;
        *(if settled { &mut self.resting } else { &mut self.moving }) = Some(film);
        self.lacks = if settled { Lacks::Nothing } else { Lacks::Everything };
        Ok(picture)
    }

    fn fetch(&mut self, tracer: &Tracer, film: &Film, settled: bool) -> Result<Picture, ViewerError> {
        self.meter.fetching();
        self.staging.fetch(tracer.device(), film.screen())?;
        let rgba = self.staging.iter().flat_map(|pixel| pixel.to_le_bytes()).collect();
        self.meter.fetched();
        Ok(Picture { size: film.size(), rgba, settled })
    }

    /// Whether a call of [`frame`](Self::frame) would render: a loop may sleep otherwise.
    pub fn wants_frame(&self, stage: &Stage) -> bool {
        stage.is_ready()
            && (self.lacks != Lacks::Nothing
                || self.generation != stage.generation()
                || self.control.as_ref().is_some_and(CameraControl::is_moving))
    }

    /// What to tell beside the picture.
    pub fn status(&self, stage: &Stage) -> Status {
        let ready = stage.ready();
        let built = ready.map(|ready| ready.tracer.structure());
        Status {
            busy: stage.busy(),
            notice: self.notice.clone().or_else(|| stage.notice().cloned()),
            scene: stage.name(),
            device: stage.device().description(),
            accel: built.map_or(String::new(), |built| format!("{}, {}", built.kind, built.quality)),
            triangles: ready.map_or(0, |ready| ready.tracer.report().triangles as u64),
            size: self.size,
            settled: self.lacks == Lacks::Nothing,
            view: self.look.view.to_string(),
            legend: self.legend.clone(),
            pick: Vec::new(),
            help: self.look.help,
            panel: self.look.panel,
            reference: self.look.reference,
            ..self.meter.status()
        }
    }

    /// The side panel as it is now.
    pub fn panel(&self, _stage: &Stage) -> Panel {
        Panel::default()
    }
}

/// An empty film of a size: the one before if it has that, with what it has learnt.
fn fresh(kept: Option<Film>, tracer: &Tracer, size: [u32; 2], rate: Option<f64>) -> Result<Film, ViewerError> {
    let mut film = match kept {
        Some(mut film) if film.size() == size => {
            film.clear()?;
            film
        }
        _ => Film::new(tracer.device(), size)?,
    };
    if let Some(rate) = rate {
        film.learn(rate);
    }
    Ok(film)
}

fn quantity(view: View) -> Option<Quantity> {
    Some(match view {
        View::Picture => return None,
        View::Normals => Quantity::Normal,
        View::Depth => Quantity::Depth,
        View::Albedo => Quantity::Albedo,
        View::Primitives => Quantity::Primitive,
        View::Materials => Quantity::Material,
        View::Tests => Quantity::Tests,
        View::Load => Quantity::Ticks,
    })
}

/// What the colours of a debug view mean.
fn legend(quantity: Quantity, [low, high]: [f32; 2], is_gpu: bool) -> Option<Legend> {
    use raywarp_kernels::false_color::{depth, HEAT};
    let (title, colors) = match quantity {
        Quantity::Normal => ("shading normal: x red, y green, z blue", Vec::new()),
        Quantity::Albedo => ("diffuse colour", Vec::new()),
        Quantity::Primitive => ("a colour for each triangle", Vec::new()),
        Quantity::Material => ("a colour for each material", Vec::new()),
        Quantity::Depth => ("distance in scene units", vec![depth(0.0), depth(1.0)]),
        Quantity::Tests => ("nodes and triangles tested a pixel", HEAT.to_vec()),
        Quantity::Ticks if is_gpu => ("cycles of the pixel's thread", HEAT.to_vec()),
        Quantity::Ticks => ("nanoseconds of the pixel", HEAT.to_vec()),
    };
    let number = |x: f32| if colors.is_empty() { String::new() } else { format!("{x}") };
    let (low, high) = (number(low), number(high));
    Some(Legend { title: title.to_owned(), low, high, colors })
}
