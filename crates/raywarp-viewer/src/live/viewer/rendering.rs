//! Pictures: small ones while something moves, then the whole one sample by sample, and debug views.

use std::sync::Arc;
use std::time::Duration;

use raywarp::image::heatmap::PERCENT;
use raywarp::render::{Film, Quantity, RenderOptions, Tracer};
use raywarp::scene::Camera;

use super::{Lacks, Outlined, Picture, Viewer};
use crate::live::boxes;
use crate::live::live_scene::Ready;
use crate::live::outline::Outline;
use crate::live::pace::Pace;
use crate::live::view_settings::{View, MAX_LEVEL};
use crate::live::{Legend, LiveScene};
use crate::ViewerError;

/// The camera rests when nothing has moved it for so long.
const REST: Duration = Duration::from_millis(120);

/// Between two looks at whether something moves.
const PAUSE: Duration = Duration::from_millis(1);

/// Longest time in seconds, beyond that of a frame, that a picture at rest refines before it is shown: whoever begins to
/// move something waits for it.
const PATIENCE: f64 = 0.15;

/// Longest time that a held key flies at once: after a pause the camera does not leap.
const LEAP: Duration = Duration::from_millis(100);

impl Viewer {
    /// Renders for about the time of one frame; `now` counts from any fixed moment. Nothing if the last picture still
    /// holds.
    ///
    /// # Errors
    /// [`ViewerError`] where the device fails.
    pub fn frame(&mut self, live_scene: &mut LiveScene, now: Duration) -> Result<Option<Arc<Picture>>, ViewerError> {
        live_scene.poll();
        let Some(ready) = live_scene.ready() else { return Ok(None) };
        self.catch_up(live_scene, ready);
        let is_moving = self.fly(now);
        if self.lacks == Lacks::Nothing {
            return Ok(None);
        }
        let Some(camera) = self.camera().cloned() else { return Ok(None) };
        let live = is_moving && !self.view_settings.reference && self.view_settings.view == View::Picture;
        if live && self.lacks == Lacks::Samples {
            // The small picture of this camera is there, and the whole one waits until nothing moves: who asks for frames
            // as fast as they come need not do so meanwhile.
            std::thread::sleep(PAUSE);
            return Ok(None);
        }
        self.meter.begin();
        let picture = match quantity(self.view_settings.view) {
            Some(quantity) => self.paint(ready, &camera, quantity, is_moving)?,
            None if live => self.move_on(ready, &camera)?,
            None => self.refine(ready, &camera)?,
        };
        self.meter.end();
        Ok(Some(self.frames.show(picture)))
    }

    /// Lets held keys move the camera; whether it moves, or has just done so.
    fn fly(&mut self, now: Duration) -> bool {
        let dt = self.last.replace(now).map_or(Duration::ZERO, |last| now.saturating_sub(last).min(LEAP));
        let Some(control) = &mut self.control else { return false };
        let held = control.is_moving();
        if control.step(dt) {
            self.restart();
        }
        if self.lacks == Lacks::Everything && self.frames.shown().is_some() && self.moved.is_none() {
            self.moved = Some(now);
        }
        held || self.moved.is_some_and(|moved| now.saturating_sub(moved) < REST)
    }

    /// A coarse picture of what moves.
    fn move_on(&mut self, ready: &Ready, camera: &Camera) -> Result<Picture, ViewerError> {
        let tracer = &ready.tracer;
        let size = self.coarse_size(tracer);
        let mut film = self.coarse(tracer, camera, size)?;
        self.meter.fetching();
        film.tone_map_film(&self.view_settings.development(), None)?;
        self.meter.samples([1, 1], size);
        let picture = self.fetch(ready, camera, &film, false)?;
        (self.moving, self.lacks, self.legend) = (Some(film), Lacks::Samples, None);
        self.resting = self.resting.take().filter(|film| film.size() == self.size);
        self.resting_is_old = true;
        Ok(picture)
    }

    /// As many pixels as can be traced in the time of a frame.
    fn coarse_size(&mut self, tracer: &Tracer) -> [u32; 2] {
        let known = self.moving.as_ref().or(self.resting.as_ref()).map(Film::rate);
        let rate = known.unwrap_or(if tracer.device().is_cuda() { 2e8 } else { 1e6 });
        self.pace.size(self.size, rate, self.view_settings.frame_rate)
    }

    /// One sample of each of so many pixels.
    fn coarse(&mut self, tracer: &Tracer, camera: &Camera, size: [u32; 2]) -> Result<Film, ViewerError> {
        let rate = self.moving.as_ref().or(self.resting.as_ref()).map(Film::rate);
        let mut film = fresh(self.moving.take(), tracer, size, rate)?;
        let options = RenderOptions { spp: 1, ..self.view_settings.render_options(size) };
        while !self.meter.exposed(tracer.accumulate(&mut film, camera, &options, f64::INFINITY)?) {}
        Ok(film)
    }

    /// More samples of the whole picture.
    fn refine(&mut self, ready: &Ready, camera: &Camera) -> Result<Picture, ViewerError> {
        let tracer = &ready.tracer;
        let rate = self.resting.as_ref().or(self.moving.as_ref()).map(Film::rate);
        if self.lacks == Lacks::Everything {
            // The one before would show another view where there is no sample yet.
            let size = self.coarse_size(tracer);
            self.moving = if size == self.size { None } else { Some(self.coarse(tracer, camera, size)?) };
        }
        let mut film = match self.resting.take() {
            Some(film) if film.size() == self.size && self.lacks != Lacks::Everything && !self.resting_is_old => film,
            other => fresh(other, tracer, self.size, rate)?,
        };
        self.resting_is_old = false;
        let options = self.view_settings.render_options(self.size);
        let complete = match self.lacks {
            Lacks::Developing if film.samples() >= options.spp => true,
            _ => {
                let budget = Pace::budget(self.view_settings.frame_rate).max(self.meter.worth().min(PATIENCE));
                self.meter.exposed(tracer.accumulate(&mut film, camera, &options, budget)?)
            }
        };
        if film.samples() > 0 {
            self.meter.count_rays(tracer, camera, &options, film.rate())?;
        }
        self.meter.fetching();
        film.tone_map_film(&self.view_settings.development(), self.moving.as_ref())?;
        self.meter.samples([film.samples(), options.spp], self.size);
        let picture = self.fetch(ready, camera, &film, complete)?;
        self.lacks = if complete { Lacks::Nothing } else { Lacks::Samples };
        (self.resting, self.legend) = (Some(film), None);
        Ok(picture)
    }

    /// A debug view.
    fn paint(
        &mut self,
        ready: &Ready,
        camera: &Camera,
        quantity: Quantity,
        is_moving: bool,
    ) -> Result<Picture, ViewerError> {
        let tracer = &ready.tracer;
        let known = self.moving.as_ref().or(self.resting.as_ref()).map(Film::rate);
        let rate = known.filter(|_| is_moving && !self.view_settings.reference);
        let size = rate.map_or(self.size, |rate| self.pace.size(self.size, rate, self.view_settings.frame_rate));
        let kept = if size == self.size { self.resting.take() } else { self.moving.take() };
        let mut film = fresh(kept, tracer, size, rate)?;
        let drawn = tracer.draw_aov(&mut film, camera, &self.view_settings.render_options(size), quantity, None)?;
        self.meter.painted(drawn.kernel_seconds, size);
        if drawn.kernel_seconds > 0.0 {
            film.learn(f64::from(size[0]) * f64::from(size[1]) / drawn.kernel_seconds);
        }
        self.legend = legend(quantity, drawn.range, tracer.device().is_cuda());
        let settled = size == self.size;
        let picture = self.fetch(ready, camera, &film, settled)?;
        *(if settled { &mut self.resting } else { &mut self.moving }) = Some(film);
        self.lacks = if settled { Lacks::Nothing } else { Lacks::Everything };
        Ok(picture)
    }

    fn fetch(&mut self, ready: &Ready, camera: &Camera, film: &Film, settled: bool) -> Result<Picture, ViewerError> {
        self.meter.fetching();
        self.staging.fetch(ready.tracer.device(), film.screen())?;
        let mut rgba = self.frames.bytes(&self.staging);
        self.meter.fetched();
        self.draw_boxes(&mut rgba, film.size(), &ready.tracer, camera)?;
        self.draw_outline(&mut rgba, film.size(), ready, camera)?;
        Ok(Picture { size: film.size(), rgba, settled })
    }

    /// The picture on show without the outline of what is picked: the one to keep.
    pub(super) fn without_outline(&mut self, ready: &Ready) -> Result<Option<Arc<Picture>>, ViewerError> {
        let (Some(shown), Some(camera)) = (self.frames.shown(), self.camera().cloned()) else { return Ok(None) };
        if self.pick.is_none() || 4 * self.staging.len() != shown.rgba.len() {
            return Ok(Some(shown));
        }
        let mut rgba = self.frames.bytes(&self.staging);
        self.draw_boxes(&mut rgba, shown.size, &ready.tracer, &camera)?;
        Ok(Some(Arc::new(Picture { rgba, ..*shown })))
    }

    fn draw_boxes(
        &mut self,
        rgba: &mut [u8],
        size: [u32; 2],
        tracer: &Tracer,
        camera: &Camera,
    ) -> Result<(), ViewerError> {
        let Some(level) = self.view_settings.boxes else { return Ok(()) };
        let boxes = match self.boxes.take() {
            Some(boxes) => boxes,
            None => tracer.scene().structure().boxes(MAX_LEVEL)?,
        };
        boxes::draw(rgba, size, camera, &boxes, level);
        self.boxes = Some(boxes);
        Ok(())
    }

    fn draw_outline(
        &mut self,
        rgba: &mut [u8],
        size: [u32; 2],
        ready: &Ready,
        camera: &Camera,
    ) -> Result<(), ViewerError> {
        let Some(instance) = self.pick.as_ref().map(|pick| pick.instance) else {
            self.outline = None;
            return Ok(());
        };
        let what = Outlined { camera: camera.clone(), size, instance, edition: self.edition };
        let outline = match self.outline.take().filter(|(known, _)| *known == what) {
            Some((_, outline)) => outline,
            None => Outline::of(&ready.tracer, camera, size, instance)?,
        };
        outline.draw(rgba, size);
        self.outline = Some((what, outline));
        Ok(())
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
    use raywarp::image::false_color::{depth, HEAT};
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
    let costs = matches!(quantity, Quantity::Tests | Quantity::Ticks);
    let title = if costs { format!("{title}; {PERCENT} % are within the scale") } else { title.to_owned() };
    let number = |x: f32| if colors.is_empty() { String::new() } else { format!("{x}") };
    let (low, high) = (number(low), number(high));
    Some(Legend { title, low, high, colors })
}
