//! The launches of path tracing: for each sample of a band its stages, one after the other on the device's own stream.

use raywarp_core::kernels::Frame;
use raywarp_core::lights::World;
use raywarp_core::persistent::Persistent;
use raywarp_core::ray::{HitArrays, MeshHit, Ray};
use raywarp_core::traversal::query::{AnyHit, ClosestHit};
use raywarp_core::view::{View, ViewMut};
use raywarp_core::wavefront::add_light::Direct;
use raywarp_core::wavefront::{AddLight, AddToFilm, CameraRays, Path, Shade};
use raywarp_device::kernels::{Launchable, Views};

use crate::device::{Buffer, Device, DeviceError};
use crate::query::persistent;
use crate::render::passes::{FrameKernels, Pass};

/// Most paths under way at once: enough to fill a large GPU, and on a CPU little enough to stay in its caches.
const MOST_ON_GPU: u32 = 1 << 21;
const MOST_ON_CPU: u32 = 1 << 14;

/// Bytes of a path under way, in all arrays of [`Paths`].
const SLOT: u64 = (2 * size_of::<Ray>()
    + size_of::<Path>()
    + size_of::<MeshHit>()
    + size_of::<Direct>()
    + 2 * size_of::<u32>()
    + size_of::<f32>()) as u64;

/// What stands in the way of rays, beside closed triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Openings {
    /// Some surfaces have holes, or cover part.
    pub holes: bool,
    /// Some are not seen from behind.
    pub sides: bool,
}

/// Paths under way.
pub struct Paths {
    slots: u32,
    rays: Buffer<Ray>,
    paths: Buffer<Path>,
    hits: Buffer<MeshHit>,
    instances: Buffer<u32>,
    shadow_rays: Buffer<Ray>,
    direct: Buffer<Direct>,
    occluded: Buffer<u32>,
    shares: Buffer<f32>,
    /// Of persistent threads: those for the closest hit, and those for any.
    numbers: [Buffer<u32>; 2],
}

impl Paths {
    /// Room for those of a part of a picture of so many columns and rows.
    pub fn new(device: &Device, [width, height]: [u32; 2]) -> Result<Self, DeviceError> {
        let slots = rows_at_once(device, width).min(height) * width;
        let len = slots as usize;
        device.reserve(len as u64 * SLOT, "the paths of the picture")?;
        let numbers = || device.zeroed(Persistent::<ClosestHit>::NUMBERS);
        Ok(Self {
            slots,
            rays: device.zeroed(len)?,
            paths: device.zeroed(len)?,
            hits: device.zeroed(len)?,
            instances: device.zeroed(len)?,
            shadow_rays: device.zeroed(len)?,
            direct: device.zeroed(len)?,
            occluded: device.zeroed(len)?,
            shares: device.zeroed(len)?,
            numbers: [numbers()?, numbers()?],
        })
    }

    /// Whether those of such a part fit.
    pub fn fit(&self, device: &Device, [width, height]: [u32; 2]) -> bool {
        rows_at_once(device, width).min(height) * width <= self.slots
    }
}

/// Pixels that a launch should have at least, where that is more than a pace asks for: a sample at a time of few would leave a
/// GPU idle.
pub fn pixels_to_fill(device: &Device) -> Option<u32> {
    device.is_cuda().then_some(MOST_ON_GPU)
}

/// Rows of so many columns.
fn rows_at_once(device: &Device, width: u32) -> u32 {
    let most = if device.is_cuda() { MOST_ON_GPU } else { MOST_ON_CPU };
    (most / width).max(1)
}

/// A band of a picture, with all that its launches need.
pub struct Stages<'a> {
    pub device: &'a Device,
    pub structure: &'a dyn FrameKernels,
    pub world: World,
    pub openings: Openings,
    /// Bits of [`strategy`](raywarp_core::wavefront::shade::strategy).
    pub strategies: u32,
    pub paths: &'a mut Paths,
}

impl Stages<'_> {
    /// Takes all samples of a pass: enqueued, not waited for.
    ///
    /// # Safety
    /// As for [`Device::launch`], until all of it has been waited for.
    pub unsafe fn enqueue(&mut self, pass: &Pass) -> Result<(), DeviceError> {
        let Frame { origin: [left, top], extent: [width, height], samples: [first, end, count], .. } = pass.frame;
        let rows = rows_at_once(self.device, width);
        for row in (0..height).step_by(rows as usize) {
            for sample in first..end {
                let frame = Frame {
                    origin: [left, top + row],
                    extent: [width, rows.min(height - row)],
                    samples: [sample, sample + 1, count],
                    ..pass.frame
                };
                // SAFETY: the caller's promise.
                unsafe { self.sample(pass, frame) }?;
            }
        }
        Ok(())
    }

    /// One sample of each pixel.
    ///
    /// # Safety
    /// As for [`Device::launch`].
    unsafe fn sample(&mut self, pass: &Pass, frame: Frame) -> Result<(), DeviceError> {
        let slots = frame.extent[0] * frame.extent[1];
        let (rays, paths) = (self.paths.rays.view_mut().first(slots), self.paths.paths.view_mut().first(slots));
        // SAFETY: the buffers live as long as the tracer, which frees them in the order of the stream.
        unsafe {
            self.run(&CameraRays { frame, rays, paths }, slots)?;
            let last = pass.limits.depth + 1;
            for depth in 0..=last {
                self.find(depth, slots)?;
                let shade = self.shading(pass, frame, depth, last);
                self.run(&shade, slots)?;
                if depth < last {
                    self.add_light(slots)?;
                }
            }
            let paths = self.paths.paths.view().first(slots);
            self.run(&AddToFilm { frame, paths, film: pass.film }, slots)
        }
    }

    fn shading(&mut self, pass: &Pass, frame: Frame, depth: u32, last: u32) -> Shade {
        let paths = &mut *self.paths;
        Shade {
            world: self.world,
            frame,
            depth,
            last,
            shadows: pass.limits.shadows,
            strategies: self.strategies,
            hits: paths.hits.view(),
            instances: paths.instances.view(),
            rays: paths.rays.view_mut(),
            paths: paths.paths.view_mut(),
            shadow_rays: paths.shadow_rays.view_mut(),
            direct: paths.direct.view_mut(),
        }
    }

    /// What each path meets next.
    unsafe fn find(&mut self, depth: u32, slots: u32) -> Result<(), DeviceError> {
        let rays = self.paths.rays.view().first(slots);
        let hits = HitArrays { hits: self.paths.hits.view_mut(), instances: self.paths.instances.view_mut() };
        let culls = depth == 0 && self.openings.sides;
        // SAFETY: the caller's promise.
        unsafe {
            if self.openings.holes || culls {
                return self.run(&*self.structure.visible(self.world.scene, rays, culls, hits), slots);
            }
            match self.structure.quantized().filter(|_| depth > 0 && self.device.is_cuda()) {
                Some(tree) => {
                    let numbers = &mut self.paths.numbers[0];
                    let (kernel, threads) = persistent::<ClosestHit>(self.device, tree, rays, hits, numbers)?;
                    self.run(&kernel, threads)
                }
                None => self.run(&*self.structure.closest(rays, hits), slots),
            }
        }
    }

    /// What of the light that each path looked for arrives.
    unsafe fn add_light(&mut self, slots: u32) -> Result<(), DeviceError> {
        let rays = self.paths.shadow_rays.view().first(slots);
        let mut answers = (View::EMPTY, View::EMPTY);
        // SAFETY: the caller's promise.
        unsafe {
            if self.openings.holes {
                let shares = self.paths.shares.view_mut();
                self.run(&*self.structure.shadow(self.world.scene, rays, shares), slots)?;
                answers.1 = self.paths.shares.view();
            } else {
                let occluded = self.paths.occluded.view_mut();
                self.occlusion(rays, occluded, slots)?;
                answers.0 = self.paths.occluded.view();
            }
            let (occluded, shares) = answers;
            let direct = self.paths.direct.view().first(slots);
            let paths = self.paths.paths.view_mut();
            self.run(&AddLight { direct, occluded, shares, paths }, slots)
        }
    }

    unsafe fn occlusion(&mut self, rays: View<Ray>, occluded: ViewMut<u32>, slots: u32) -> Result<(), DeviceError> {
        // SAFETY: the caller's promise.
        unsafe {
            match self.structure.quantized().filter(|_| self.device.is_cuda()) {
                Some(tree) => {
                    let numbers = &mut self.paths.numbers[1];
                    let (kernel, threads) = persistent::<AnyHit>(self.device, tree, rays, occluded, numbers)?;
                    self.run(&kernel, threads)
                }
                None => self.run(&*self.structure.occluded(rays, occluded), slots),
            }
        }
    }

    unsafe fn run(&self, kernel: &dyn Launchable, threads: u32) -> Result<(), DeviceError> {
        // SAFETY: the caller's promise.
        unsafe { kernel.launch(self.device, [threads, 1]) }
    }
}
