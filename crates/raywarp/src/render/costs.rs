//! What each pixel of a picture costs: for whoever studies how the work is spread.

use raywarp_kernels::film::Pixel;
use raywarp_kernels::kernels::Frame;
use raywarp_kernels::shade::whitted::Limits;
use raywarp_kernels::traverse::{Counter, StageTimes, Tests};
use raywarp_kernels::view::ViewMut;

use super::options::Window;
use super::{camera, passes, RenderError, RenderOptions, Tracer};
use crate::backend::Buffer;
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
type Lights = Buffer<raywarp_kernels::light::Light>;

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
        let lights = self.lighting.upload(&self.device, camera)?;
        let pass = passes::Pass {
            film: film.view_mut(),
            tests: tests.view_mut(),
            ticks: ticks.view_mut(),
            ..self.whole(camera, options, window, &lights)?
        };
        passes::shade(&self.device, &self.structure.resident, &pass)?;
        Ok(PixelCosts { tests: tests.download()?, ticks: ticks.download()? })
    }

    /// How long the threads of all pixels were in each stage, added up: making camera rays, looking for hits, everything
    /// else. In units of [`PixelCosts::ticks`]; a thread that waits for others of its warp is in the stage where it waits.
    /// The kernel with clocks is a little slower than the one without. None for structures other than `brute`, `kd`, `kdsah`
    /// and `bvh2`.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn stage_times(&self, camera: &Camera, options: &RenderOptions) -> Result<Option<[u64; 3]>, RenderError> {
        let window = options.check()?;
        let mut film = self.device.zeroed::<Pixel>(window.pixels())?;
        let mut times = self.device.zeroed::<StageTimes>(window.pixels())?;
        let lights = self.lighting.upload(&self.device, camera)?;
        let pass = passes::Pass { film: film.view_mut(), ..self.whole(camera, options, window, &lights)? };
        let done = passes::clock(&self.device, &self.structure.resident, &pass, times.view_mut())?;
        if done.is_none() {
            return Ok(None);
        }
        let add = |sum: [u64; 3], time: StageTimes| {
            let spent = [time.generation, time.intersection, time.shading];
            [0, 1, 2].map(|i| sum[i] + u64::from(spent[i]))
        };
        Ok(Some(times.download()?.into_iter().fold([0; 3], add)))
    }

    /// Traces single pixels as [`render`](Self::render) would with one sample, with a counter for each. None but for a
    /// `bvh2` on the CPU.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn follow<C: Counter>(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        pixels: &[[u32; 2]],
    ) -> Result<Option<Vec<C>>, RenderError> {
        let window = options.check()?;
        let lights = self.lighting.upload(&self.device, camera)?;
        let pass = self.whole(camera, options, window, &lights)?;
        Ok(passes::follow(&self.device, &self.structure.resident, &pass, pixels))
    }

    /// The first sample of a whole picture in one launch, of which nothing is kept.
    pub(super) fn whole(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        window: Window,
        lights: &Lights,
    ) -> Result<passes::Pass, RenderError> {
        Ok(passes::Pass {
            scene: self.scene.view(lights, &self.lighting),
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
