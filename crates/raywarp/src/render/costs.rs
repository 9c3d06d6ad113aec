//! What each pixel of a picture costs: for whoever studies how the work is spread.

use raywarp_core::film::Pixel;
use raywarp_core::kernels::Frame;
use raywarp_core::shade::whitted::Limits;
use raywarp_core::traversal::Tests;
use raywarp_core::view::ViewMut;
use raywarp_device::kernels::Views;

use super::options::Window;
use super::passes::{self, Pass};
use super::{camera, RenderError, RenderOptions, Tracer};
use crate::device::Buffer;
use crate::scene::Camera;

/// Of each pixel, row by row.
#[derive(Clone, Debug)]
pub struct PixelCosts {
    /// Nodes, triangles and rays.
    pub tests: Vec<Tests>,
    /// Time of its thread: cycles of the multiprocessor on a GPU, nanoseconds on a CPU. What wraps beyond 2^32 is lost.
    pub ticks: Vec<u32>,
}

/// The lights of a picture on its device.
type Lights = Buffer<raywarp_core::light::Light>;

impl Tracer {
    /// Counts and times the thread of every pixel, for one sample. Counting makes a thread slower, all of them alike.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn costs(&self, camera: &Camera, options: &RenderOptions) -> Result<PixelCosts, RenderError> {
        let window = options.check()?;
        let mut film = self.device.zeroed::<Pixel>(window.pixels())?;
        let mut tests = self.device.zeroed::<Tests>(window.pixels())?;
        let mut ticks = self.device.zeroed::<u32>(window.pixels())?;
        let lights = self.scene.appearance()?.lighting.upload(&self.device, camera)?;
        let pass = Pass {
            film: film.view_mut(),
            tests: tests.view_mut(),
            ticks: ticks.view_mut(),
            ..self.whole(camera, options, window, &lights)?
        };
        passes::shade(&self.device, self.kernels(), &pass)?;
        Ok(PixelCosts { tests: tests.download()?, ticks: ticks.download()? })
    }

    /// For kernels that are launched by hand: hands over what one is given that takes the first sample of a whole picture, of
    /// which nothing is kept. The views are good while `measure` runs.
    ///
    /// # Errors
    /// As for [`render`](Self::render), and those of `measure`.
    pub fn first_sample<T>(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        measure: impl FnOnce(&Pass) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let window = options.check()?;
        let lights = self.scene.appearance()?.lighting.upload(&self.device, camera)?;
        measure(&self.whole(camera, options, window, &lights)?)
    }

    /// The first sample of a whole picture in one launch, of which nothing is kept.
    pub(super) fn whole(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        window: Window,
        lights: &Lights,
    ) -> Result<Pass, RenderError> {
        Ok(Pass {
            scene: self.scene.appearance()?.view(lights),
            frame: Frame {
                camera: camera::kernel_camera(camera, options.size)?,
                origin: window.origin,
                extent: window.extent,
                film: [window.origin[0], window.origin[1], window.extent[0]],
                samples: [0, 1, 1],
                seed: options.seed,
            },
            limits: Limits { depth: options.max_depth, shadows: options.shadows as u32 },
            film: ViewMut::EMPTY,
            tests: ViewMut::EMPTY,
            ticks: ViewMut::EMPTY,
        })
    }
}
