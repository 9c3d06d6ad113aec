//! The launches of a frame: one entry point for each structure and each wish.

use std::marker::PhantomData;

use raywarp_core::film::Pixel;
use raywarp_core::kernels::{FirstHit, FirstHits, Frame, Whitted};
use raywarp_core::ray::{HitArrays, Ray};
use raywarp_core::shade::whitted::Limits;
use raywarp_core::surface;
use raywarp_core::traversal::{NullStatistics, RecordedStatistics, Structure, Tests};
use raywarp_core::view::{View, ViewMut};
use raywarp_core::wavefront::{Shadow, Visible};
use raywarp_device::kernels::{Launchable, Timed};

use crate::accel::{Rendered, TreeBox};
use crate::device::{Device, DeviceError};
use crate::query::kernels::QueryKernels;

/// One launch of a frame: everything but the structure.
#[derive(Clone, Copy)]
pub struct Pass {
    /// What is there.
    pub scene: surface::Scene,
    /// Which pixels and samples.
    pub frame: Frame,
    /// Bounces, shadows.
    pub limits: Limits,
    /// Sums, read and written.
    pub film: ViewMut<Pixel>,
    /// Empty: nobody counts.
    pub tests: ViewMut<Tests>,
    /// Time of each pixel's thread, where tests are counted.
    pub ticks: ViewMut<u32>,
}

impl Pass {
    /// Its kernel over a structure, with what is counted of each pixel.
    pub fn whitted<S: Structure, C: RecordedStatistics>(
        &self,
        structure: S,
        counts: ViewMut<C::Record>,
    ) -> Whitted<S, C> {
        let Self { scene, frame, limits, film, ticks, .. } = *self;
        Whitted { structure, scene, frame, limits, film, counts, ticks, counter: PhantomData }
    }
}

/// A structure on a device, with the kernels of pictures too.
pub(crate) trait FrameKernels: QueryKernels {
    /// Adds the samples of a pass to the film.
    fn frame(&self, pass: &Pass) -> Box<dyn Launchable>;

    /// Finds the first hit of each pixel of a pass.
    fn first_hits(&self, pass: &Pass, first_hits: ViewMut<FirstHit>) -> Box<dyn Launchable>;

    /// See [`Visible`].
    fn visible(&self, scene: surface::Scene, rays: View<Ray>, cull: bool, hits: HitArrays) -> Box<dyn Launchable>;

    /// See [`Shadow`].
    fn shadow(&self, scene: surface::Scene, rays: View<Ray>, shares: ViewMut<f32>) -> Box<dyn Launchable>;

    /// Has the driver compile these kernels, so that no frame waits for it.
    fn load(&self, device: &Device) -> Result<(), DeviceError>;

    /// See [`Rendered::boxes`].
    fn tree_boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError>;
}

impl<R: Rendered> FrameKernels for R {
    fn frame(&self, pass: &Pass) -> Box<dyn Launchable> {
        match pass.tests.is_empty() {
            true => Box::new(pass.whitted::<_, NullStatistics>(self.long(), ViewMut::EMPTY)),
            false => Box::new(pass.whitted::<_, Tests>(self.long(), pass.tests)),
        }
    }

    fn first_hits(&self, pass: &Pass, first_hits: ViewMut<FirstHit>) -> Box<dyn Launchable> {
        Box::new(FirstHits { structure: self.long(), scene: pass.scene, frame: pass.frame, first_hits })
    }

    fn visible(&self, scene: surface::Scene, rays: View<Ray>, cull: bool, hits: HitArrays) -> Box<dyn Launchable> {
        Box::new(Visible { structure: self.long(), scene, rays, cull: cull as u32, hits })
    }

    fn shadow(&self, scene: surface::Scene, rays: View<Ray>, shares: ViewMut<f32>) -> Box<dyn Launchable> {
        Box::new(Shadow { structure: self.long(), scene, rays, shares })
    }

    fn load(&self, device: &Device) -> Result<(), DeviceError> {
        device.load::<Whitted<R::Long, NullStatistics>>()?;
        device.load::<Whitted<R::Long, Tests>>()?;
        device.load::<FirstHits<R::Long>>()
    }

    fn tree_boxes(&self, level: u32) -> Result<Vec<TreeBox>, DeviceError> {
        self.boxes(level)
    }
}

/// Adds the samples of a pass to the film: enqueued, not waited for.
pub(super) fn shade(device: &Device, structure: &dyn FrameKernels, pass: &Pass) -> Result<Timed, DeviceError> {
    run(device, pass, &*structure.frame(pass))
}

/// Finds the first hit of each pixel of a pass: enqueued, not waited for.
pub(super) fn first_hits(
    device: &Device,
    structure: &dyn FrameKernels,
    pass: &Pass,
    first_hits: ViewMut<FirstHit>,
) -> Result<Timed, DeviceError> {
    run(device, pass, &*structure.first_hits(pass, first_hits))
}

fn run(device: &Device, pass: &Pass, kernel: &dyn Launchable) -> Result<Timed, DeviceError> {
    // SAFETY: the structure's views are of buffers borrowed for this call; those of the pass belong to the frame that
    // `Tracer` holds, which are read, cleared and freed in the order of the device's own stream, as all that it launches.
    // `Flat` checked the indices of the scene, the builders those of the trees.
    unsafe { Timed::launch(device, kernel, pass.frame.extent) }
}
