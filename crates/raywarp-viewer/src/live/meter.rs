//! What frames cost.

use std::time::{Duration, Instant};

use raywarp::render::{Exposure, Integrator, RenderOptions, Tracer};
use raywarp::scene::Camera;

use super::Status;
use crate::ViewerError;

/// Pixels of the picture whose rays are counted: enough for a mean, few enough not to be noticed.
const COUNTED: [f64; 2] = [64.0, 20_000.0];

/// Seconds that this may take.
const COUNTING: f64 = 0.005;

/// Between two counts.
const PAUSE: Duration = Duration::from_secs(1);

/// Numbers of the last frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Meter {
    start: Option<Instant>,
    /// Milliseconds of the last frame.
    frame_ms: f64,
    kernel_seconds: f64,
    /// Since when samples become pixels, and how long they have.
    fetching: Option<Instant>,
    fetch_seconds: f64,
    /// The same of the frame before.
    fetch_seconds_before: f64,
    pixel_samples: u64,
    samples: [u32; 2],
    traced: [u32; 2],
    /// Rays of all kinds for each camera ray.
    rays: Option<f64>,
    /// When they were counted, and whether the view is another since.
    counted: Option<Instant>,
    view_changed: bool,
}

impl Meter {
    /// A frame begins.
    pub fn begin(&mut self) {
        (self.start, self.kernel_seconds, self.pixel_samples) = (Some(Instant::now()), 0.0, 0);
        self.fetch_seconds_before = self.fetch_seconds;
        (self.fetching, self.fetch_seconds) = (None, 0.0);
    }

    /// It is done.
    pub fn end(&mut self) {
        if let Some(start) = self.start.take() {
            self.frame_ms = start.elapsed().as_secs_f64() * 1e3;
        }
    }

    /// Adds an exposure to the bill; whether its film is complete.
    pub fn exposed(&mut self, exposure: Exposure) -> bool {
        self.kernel_seconds += exposure.kernel_seconds;
        self.pixel_samples += exposure.pixel_samples;
        exposure.complete
    }

    /// Seconds of tracing that are worth another developing: most of the time should be the former's.
    pub fn worth(&self) -> f64 {
        2.0 * self.fetch_seconds_before
    }

    /// From here on samples are developed and copied to the host. Said twice, the first counts.
    pub fn fetching(&mut self) {
        self.fetching.get_or_insert_with(Instant::now);
    }

    /// The pixels are there.
    pub fn fetched(&mut self) {
        if let Some(start) = self.fetching.take() {
            self.fetch_seconds += start.elapsed().as_secs_f64();
        }
    }

    /// A debug view was painted.
    pub fn painted(&mut self, kernel_seconds: f64, size: [u32; 2]) {
        (self.kernel_seconds, self.traced, self.samples) = (kernel_seconds, size, [1, 1]);
    }

    /// How far a picture of so many pixels is.
    pub fn samples(&mut self, samples: [u32; 2], traced: [u32; 2]) {
        (self.samples, self.traced) = (samples, traced);
    }

    /// Another view, with other rays.
    pub fn changed(&mut self) {
        self.view_changed = true;
    }

    /// Counts the rays of a small picture, if those are not known of this view and can be counted; `rate` is in pixel samples a second.
    pub fn count_rays(
        &mut self,
        tracer: &Tracer,
        camera: &Camera,
        options: &RenderOptions,
        rate: f64,
    ) -> Result<(), ViewerError> {
        let lately = self.counted.is_some_and(|at| at.elapsed() < PAUSE);
        if options.integrator == Integrator::Path {
            self.rays = None;
            return Ok(());
        }
        if lately || self.rays.is_some() && !self.view_changed {
            return Ok(());
        }
        (self.counted, self.view_changed) = (Some(Instant::now()), false);
        let pixels = options.size.iter().map(|&side| f64::from(side)).product::<f64>();
        let scale = ((rate * COUNTING).clamp(COUNTED[0], COUNTED[1]) / pixels).sqrt().min(1.0);
        let size = options.size.map(|side| ((f64::from(side) * scale) as u32).max(1));
        let options = RenderOptions { size, spp: 1, count_tests: true, ..*options };
        let rays = tracer.render(camera, &options, &mut |_| ())?.rays.unwrap_or(0);
        self.rays = Some(rays as f64 / (f64::from(size[0]) * f64::from(size[1])));
        Ok(())
    }

    /// The numbers; the rest is as by default.
    pub fn status(&self) -> Status {
        let traced = self.rays.filter(|_| self.kernel_seconds > 0.0 && self.pixel_samples > 0);
        Status {
            frame_ms: self.frame_ms,
            kernel_ms: self.kernel_seconds * 1e3,
            fetch_ms: self.fetch_seconds * 1e3,
            mrays_per_s: traced.map(|rays| rays * self.pixel_samples as f64 / self.kernel_seconds * 1e-6),
            samples: self.samples[0],
            spp: self.samples[1],
            traced: self.traced,
            ..Status::default()
        }
    }
}
