//! From a scene on its device to a picture.

mod band_queue;
mod bands;
pub(crate) mod camera;
mod costs;
mod cut_out;
mod error;
mod film;
mod framing;
mod options;
pub(crate) mod passes;
pub(crate) mod path;

use std::sync::Arc;

use raywarp_core::film::Pixel;
use raywarp_core::kernels::{FirstHit, Frame};
use raywarp_core::shade::whitted::Limits;
use raywarp_core::traversal::Tests;
use raywarp_core::view::ViewMut;
use raywarp_core::wavefront::shade::strategy;
use raywarp_device::kernels::{Timed, Views};

use crate::accel::Build;
use crate::device::{Buffer, Device};
use crate::device_scene::{DeviceScene, Report, SceneError};
use crate::image::Picture;
use crate::scene::{Camera, Scene, Viewpoint};
use band_queue::BandQueue;
use bands::Bands;
pub(crate) use framing::turn_to;
use options::Window;

pub use camera::{axes, ray};
pub use costs::PixelCosts;
pub use error::RenderError;
pub use film::{Exposure, Film, Painted, Quantity};
pub use framing::{chosen_camera, framing};
pub use options::{Integrator, RenderOptions, MAX_DEPTH, MAX_SIDE, MAX_SPP};
#[doc(hidden)]
pub use passes::Pass;

/// Takes pictures of a scene on a device, from any camera.
pub struct Tracer {
    scene: Arc<DeviceScene>,
    /// The scene's, with the shape of the blocks that are launched.
    device: Device,
    camera: Camera,
    /// How paths find light: bits of [`strategy`].
    strategies: u32,
}

/// The scene's first camera, or one that frames all of it from the front, right and above in a picture of the size that the
/// scene asks for.
pub fn default_camera(scene: &Scene) -> Camera {
    let [width, height] = scene.render.size().map(f64::from);
    scene.cameras.first().cloned().unwrap_or_else(|| framing::framed(scene, &Viewpoint::default(), width / height))
}

/// Finds out whether pictures can be taken with a camera.
///
/// # Errors
/// [`RenderError::Camera`] says why not.
pub fn check_camera(camera: &Camera) -> Result<(), RenderError> {
    camera::kernel_camera(camera, [1, 1]).map(drop)
}

/// How far a rendering is, in samples of all pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Samples taken.
    pub done: u64,
    /// Samples to take.
    pub total: u64,
}

/// A finished picture and what it cost.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Mean radiance of each pixel.
    pub picture: Picture,
    /// Tests of each pixel, where they were asked for.
    pub tests: Option<Vec<Tests>>,
    /// Seconds that the kernels ran on the device.
    pub kernel_seconds: f64,
    /// Kernels launched.
    pub launches: u32,
    /// Rays of all kinds, where tests were asked for.
    pub rays: Option<u64>,
    /// Pixels that came out infinite or NaN; they are black in the picture.
    pub non_finite: u64,
}

impl Tracer {
    /// Brings a scene to a device.
    ///
    /// # Errors
    /// [`RenderError`] where the scene is too large for the structure or for the device's memory.
    pub fn new(scene: &Scene, accel: impl Into<Build>, device: &Device) -> Result<Self, RenderError> {
        Self::of_scene(Arc::new(DeviceScene::new(scene, accel, device)?))
    }

    /// Of a scene that is on its device, and may be shared.
    ///
    /// # Errors
    /// [`SceneError::GeometryAlone`] for one that is for queries alone.
    pub fn of_scene(scene: Arc<DeviceScene>) -> Result<Self, RenderError> {
        let (device, camera) = (scene.device().clone(), scene.appearance()?.camera.clone());
        Ok(Self { scene, device, camera, strategies: strategy::BOTH })
    }

    /// The scene, for others to hold.
    pub fn scene(&self) -> &Arc<DeviceScene> {
        &self.scene
    }

    /// The scene, to be changed.
    ///
    /// # Errors
    /// [`SceneError::Shared`] where others hold it.
    pub fn scene_mut(&mut self) -> Result<&mut DeviceScene, SceneError> {
        DeviceScene::exclusive(&mut self.scene)
    }

    /// What became of the scene.
    pub fn report(&self) -> &Report {
        self.scene.report()
    }

    /// What an integrator adds to the lights by its own choice or leaves out, each a sentence without the full stop.
    pub fn notes_of(&self, integrator: Integrator) -> Vec<String> {
        self.scene.appearance().map_or(Vec::new(), |appearance| appearance.lighting.notes(integrator))
    }

    /// Where it traces.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Launches in blocks of so many columns and rows from now on, or of the usual shape.
    ///
    /// # Errors
    /// As for [`Device::with_block`](crate::device::Device::with_block).
    pub fn set_block(&mut self, block: Option<[u32; 2]>) -> Result<(), RenderError> {
        self.device = self.device.with_block(block)?;
        Ok(())
    }

    /// The scene's first camera, or one that frames it: [`default_camera`].
    pub fn default_camera(&self) -> &Camera {
        &self.camera
    }

    /// Renders a picture and calls `progress` after each launch, which aims at 0.08 s. The same scene, camera, options and seed give
    /// the same picture on every device.
    ///
    /// # Errors
    /// [`RenderError`] for impossible options, a camera without a direction, or a device that fails.
    pub fn render(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Rendering, RenderError> {
        let window = options.check()?;
        let pixels = window.pixels();
        let counted = if options.count_tests { pixels } else { 0 };
        let bytes = pixels * std::mem::size_of::<Pixel>() + counted * std::mem::size_of::<Tests>();
        self.device.reserve(bytes as u64, "the picture")?;
        let mut film = self.device.zeroed::<Pixel>(pixels)?;
        let mut tests = self.device.zeroed::<Tests>(counted)?;

        // Bands of rows, each large enough to fill the device and small enough to report on.
        let appearance = self.scene.appearance()?;
        let lights = appearance.lighting.upload(&self.device, camera)?;
        let scene = appearance.view(&lights);
        let camera = camera::kernel_camera(camera, options.size)?;
        let is_gpu = self.device.is_cuda();
        let wide = path::pixels_to_fill(&self.device).filter(|_| options.integrator == Integrator::Path);
        let bands = match wide {
            Some(pixels) => Bands::wide(window, options.spp, is_gpu, pixels),
            None => Bands::new(window, options.spp, is_gpu),
        };
        let mut queue = BandQueue::new(bands, is_gpu, progress);
        while let Some(band) = queue.next()? {
            let frame = Frame {
                camera,
                origin: band.origin,
                extent: band.extent,
                film: [window.origin[0], window.origin[1], window.extent[0]],
                samples: [band.samples[0], band.samples[1], options.spp],
                seed: options.seed,
            };
            let limits = Limits { depth: options.max_depth, shadows: options.shadows as u32 };
            let pass = passes::Pass {
                scene,
                frame,
                limits,
                film: film.view_mut(),
                tests: tests.view_mut(),
                ticks: ViewMut::EMPTY,
            };
            queue.push(band, self.take_samples(options.integrator, &pass)?);
        }
        finish(options, film, tests, queue.kernel_seconds, queue.launches, window)
    }

    /// Adds the samples of a pass to the film: enqueued, not waited for.
    fn take_samples(&self, integrator: Integrator, pass: &passes::Pass) -> Result<Timed, RenderError> {
        match integrator {
            Integrator::Whitted => Ok(passes::shade(&self.device, self.kernels(), pass)?),
            Integrator::Path => self.trace_paths(pass),
        }
    }

    /// What the ray through the centre of each pixel meets first, row by row.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn layers(&self, camera: &Camera, options: &RenderOptions) -> Result<Vec<FirstHit>, RenderError> {
        let window = options.check()?;
        self.device.reserve((window.pixels() * std::mem::size_of::<FirstHit>()) as u64, "the layers of the picture")?;
        let mut first_hits = self.device.zeroed::<FirstHit>(window.pixels())?;
        let lights = self.scene.appearance()?.lighting.upload(&self.device, camera)?;
        let pass = self.whole(camera, options, window, &lights)?;
        passes::first_hits(&self.device, self.kernels(), &pass, first_hits.view_mut())?;
        Ok(first_hits.download()?)
    }

    fn kernels(&self) -> &dyn passes::FrameKernels {
        &*self.scene.structure().resident
    }
}

/// Sums to means, and the bill.
fn finish(
    options: &RenderOptions,
    film: Buffer<Pixel>,
    tests: Buffer<Tests>,
    kernel_seconds: f64,
    launches: u32,
    window: Window,
) -> Result<Rendering, RenderError> {
    let ([width, height], samples) = (window.extent, options.spp as f32);
    let mut non_finite = 0;
    let pixels = film.download()?.iter().map(|pixel| mean(pixel, samples, &mut non_finite)).collect();
    let tests = if options.count_tests { Some(tests.download()?) } else { None };
    let rays = tests.as_ref().map(|tests| tests.iter().map(|t| t.rays as u64).sum());
    let picture = Picture { width, height, origin: window.origin, whole: options.size, pixels };
    Ok(Rendering { picture, tests, kernel_seconds, launches, rays, non_finite })
}

fn mean(pixel: &Pixel, samples: f32, non_finite: &mut u64) -> [f32; 4] {
    let mean = pixel.mean(samples);
    *non_finite += mean.is_none() as u64;
    let [r, g, b] = mean.map_or([0.0; 3], |mean| mean.to_array());
    [r, g, b, pixel.hits / samples]
}
