//! One pair of eyes on the stage: camera, options, picture.

use std::time::{Duration, Instant};

use raywarp::image::{png, Development, Rgb8};
use raywarp::render::RenderOptions;
use raywarp::scene::Camera;

use super::{Event, Outcome, Panel, Stage, Status};
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

/// One viewer.
pub struct Viewer {
    size: [u32; 2],
    camera: Option<Camera>,
    changed: bool,
    shown: Option<Picture>,
    help: bool,
    frame_ms: f64,
}

impl Viewer {
    /// With a picture of so many pixels.
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, camera: None, changed: true, shown: None, help: false, frame_ms: 0.0 }
    }

    /// Takes an event; returns what the front end has to do.
    pub fn handle(&mut self, _stage: &mut Stage, event: &Event) -> Vec<Outcome> {
        match event {
            Event::Resize { width, height } => (self.size, self.changed) = ([*width, *height], true),
            Event::Key { key, down: true, .. } if key == "h" => self.help = !self.help,
            Event::Key { key, down: true, .. } if key == "F12" => return self.screenshot().into_iter().collect(),
            Event::Wheel { notches } => {
                if let Some(camera) = &mut self.camera {
                    for i in 0..3 {
                        camera.eye[i] += (camera.target[i] - camera.eye[i]) * 0.1 * notches;
                    }
                    self.changed = true;
                }
            }
            _ => {}
        }
        Vec::new()
    }

    fn screenshot(&self) -> Option<Outcome> {
        let picture = self.shown.as_ref()?;
        let pixels = picture.rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
        let [width, height] = picture.size;
        let content = png::encode(&Rgb8 { width, height, pixels }).ok()?;
        Some(Outcome::File { name: "raywarp.png".to_owned(), content, media_type: "image/png" })
    }

    /// Renders for about the time of one frame; `now` counts from any fixed moment. Nothing if the last picture still
    /// holds.
    ///
    /// # Errors
    /// [`ViewerError`] where the device fails.
    pub fn frame(&mut self, stage: &mut Stage, _now: Duration) -> Result<Option<Picture>, ViewerError> {
        stage.poll();
        let Some(ready) = stage.ready() else { return Ok(None) };
        let camera = self.camera.get_or_insert_with(|| ready.tracer.default_camera().clone());
        if !std::mem::replace(&mut self.changed, false) {
            return Ok(None);
        }
        let start = Instant::now();
        let options = RenderOptions { size: self.size, ..RenderOptions::default() };
        let rendering = ready.tracer.render(camera, &options, &mut |_| ())?;
        let shown = png::develop(&rendering.picture, &Development::default());
        let rgba = shown.pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
        let picture = Picture { size: self.size, rgba, settled: true };
        self.frame_ms = start.elapsed().as_secs_f64() * 1e3;
        self.shown = Some(picture.clone());
        Ok(Some(picture))
    }

    /// Whether a call of [`frame`](Self::frame) would render: a loop may sleep otherwise.
    pub fn wants_frame(&self, stage: &Stage) -> bool {
        stage.is_ready() && self.changed
    }

    /// What to tell beside the picture.
    pub fn status(&self, stage: &Stage) -> Status {
        let triangles = stage.ready().map_or(0, |ready| ready.tracer.report().triangles as u64);
        Status {
            busy: stage.busy(),
            notice: stage.notice().cloned(),
            scene: stage.name(),
            device: stage.device().description(),
            triangles,
            size: self.size,
            traced: self.size,
            frame_ms: self.frame_ms,
            samples: 1,
            spp: 1,
            settled: !self.changed,
            view: "picture".to_owned(),
            help: self.help,
            ..Status::default()
        }
    }

    /// The side panel as it is now.
    pub fn panel(&self, _stage: &Stage) -> Panel {
        Panel::default()
    }
}
