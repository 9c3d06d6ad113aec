//! A viewer whose pointer follows a script.

use std::sync::Arc;
use std::time::{Duration, Instant};

use raywarp::scene::{Camera, Viewpoint};
use raywarp_viewer::live::{Button, Event, LiveScene, Modifiers, Picture, Status, Viewer};

use super::case::Case;

use crate::failure::{ensure, fail, Result};

/// How far the pointer goes for a whole turn of the camera, in heights of the picture.
const TURN: f64 = 2.0;
/// A step of a drag, in turns: enough not to be a click, and not so much that a slow machine sees a few views only.
const STEP: [f64; 2] = [1.0 / 300.0, 1.0 / 17.0];
/// Widths of the narrowest picture's height: the pointer does not go farther than a hundred widths.
const NARROWEST: u64 = 40;
/// Without any picture for so long, none is coming.
const PATIENCE: Duration = Duration::from_secs(20);

/// A viewer whose camera is dragged about its target.
pub struct ScriptedPointer<'a> {
    live_scene: &'a mut LiveScene,
    viewer: Viewer,
    /// The picture before anything moved.
    pub rest: Arc<Picture>,
    size: [u32; 2],
    /// Since the button went down, in turns.
    turned: f64,
    start: Instant,
}

/// A whole picture of a camera that had just moved, and what it cost, in milliseconds.
pub struct Frame {
    pub picture: Arc<Picture>,
    /// From the event to the pixels.
    pub ms: f64,
    /// Of those, in kernels that trace, and from samples to pixels in the host's memory.
    pub trace_ms: f64,
    pub fetch_ms: f64,
    /// Pixels traced over pixels shown.
    pub traced: f64,
}

impl<'a> ScriptedPointer<'a> {
    /// With the picture at rest there and the button down.
    ///
    /// # Errors
    /// The view cannot be rendered from, the size is beyond the viewer's or too narrow, or the device fails.
    pub fn new(live_scene: &'a mut LiveScene, size: [u32; 2], case: Case, view: &Viewpoint) -> Result<Self> {
        let [width, height] = size;
        ensure!(
            u64::from(height) <= NARROWEST * u64::from(width),
            "a picture of {width}x{height} is too narrow to drag the camera around; choose a wider --size"
        );
        let mut viewer = Viewer::new(size);
        *viewer.look_mut() = case.view_settings();
        let mut pointer = Self { live_scene, viewer, rest: Arc::default(), size, turned: 0.0, start: Instant::now() };
        let [most_wide, most_high] = pointer.status().size;
        ensure!(
            [most_wide, most_high] == size,
            "a picture of {width}x{height} is more than the viewer shows: at most {most_wide}x{most_high} of it; choose a \
             smaller --size"
        );
        pointer.settle()?;
        // What cannot be rendered from, the viewer replaces.
        let asked = |camera: &Camera| view.adjust(camera.clone()) == *camera;
        ensure!(
            pointer.viewer.camera().is_some_and(asked),
            "the camera needs finite coordinates, an eye apart from its target, and a field of view of more than 0 and \
             less than 180 degrees"
        );
        if let Some(notice) = pointer.status().notice.filter(|notice| notice.error) {
            fail!("{}", notice.text);
        }
        pointer.point();
        pointer.press(true);
        Ok(pointer)
    }

    /// What the viewer tells.
    pub fn status(&self) -> Status {
        self.viewer.status(self.live_scene)
    }

    /// Drags on, and renders until the picture is whole.
    ///
    /// # Errors
    /// The device fails, or there is no picture.
    pub fn next(&mut self, turns: f64) -> Result<Frame> {
        let begun = Instant::now();
        self.drag(turns.clamp(STEP[0], STEP[1]));
        let (mut trace_ms, mut fetch_ms) = (0.0, 0.0);
        loop {
            let picture = self.render()?;
            let ms = begun.elapsed().as_secs_f64() * 1e3;
            let status = self.status();
            (trace_ms, fetch_ms) = (trace_ms + status.kernel_ms, fetch_ms + status.fetch_ms);
            if status.samples >= status.spp {
                return Ok(Frame {
                    picture,
                    ms,
                    trace_ms,
                    fetch_ms,
                    traced: pixels(status.traced) / pixels(self.size),
                });
            }
        }
    }

    /// Renders until nothing more is coming.
    fn settle(&mut self) -> Result<()> {
        while self.viewer.wants_frame(self.live_scene) {
            self.rest = self.render()?;
        }
        Ok(())
    }

    /// The next picture, whole or not.
    fn render(&mut self) -> Result<Arc<Picture>> {
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE {
            if let Some(picture) = self.viewer.frame(self.live_scene, self.start.elapsed())? {
                return Ok(picture);
            }
        }
        fail!("the viewer made no picture for {} s, though it was to; report it", PATIENCE.as_secs())
    }

    /// Moves the pointer to the right. After a whole turn it begins again at the left.
    fn drag(&mut self, turns: f64) {
        if self.turned > 1.0 {
            self.press(false);
            self.turned = 0.0;
            self.point();
            self.press(true);
        }
        self.turned += turns;
        self.point();
    }

    fn point(&mut self) {
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1]);
        self.send(&Event::Pointer { x: (self.turned * TURN / aspect) as f32, y: 0.5 });
    }

    fn press(&mut self, down: bool) {
        self.send(&Event::Button { button: Button::Left, down, modifiers: Modifiers::default() });
    }

    fn send(&mut self, event: &Event) {
        // A drag asks nothing of a front end.
        let _ = self.viewer.handle(self.live_scene, event);
    }
}

fn pixels(size: [u32; 2]) -> f64 {
    f64::from(size[0]) * f64::from(size[1])
}
