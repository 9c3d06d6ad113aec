//! Path tracing in stages, each a kernel over all paths of a launch: `camera_rays`, then for each depth `closest` or
//! [`visible`], [`shade`], `occluded` or [`shadow`] and [`add_light`], in the end [`film`].
//!
//! A slot is a pixel of the launch, with one sample under way: so a pixel's sum is its own, and in the order of samples. What a
//! sample brings depends on its pixel, its number and the seed alone, not on the launch, the structure or the machine. A path
//! that has ended leaves a ray behind that meets nothing, and goes through the remaining stages as such: nobody counts
//! the others, and the host never waits.

pub mod add_light;
pub mod camera_rays;
pub mod film;
pub mod shade;
pub mod shadow;
pub mod visible;

pub use add_light::AddLight;
pub use camera_rays::CameraRays;
pub use film::AddToFilm;
pub use shade::Shade;
pub use shadow::Shadow;
pub use visible::Visible;

use crate::kernels::Frame;
use crate::math::Vec3;
use crate::ray::Ray;
use crate::sampling::{Pair, Sampler};

/// A path under way.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// What radiance along its ray counts.
    pub throughput: Vec3,
    /// Probability per solid angle with which its ray was found; infinite for camera rays and behind smooth surfaces.
    pub density: f32,
    /// What it has brought so far.
    pub radiance: Vec3,
    /// Bit [`MET`](Self::MET), and below it one more than the index of the material that it is inside of; 0 for none.
    pub state: u32,
}

impl Path {
    /// The camera ray met something.
    pub const MET: u32 = 1 << 31;

    /// At the camera.
    #[inline(always)]
    pub fn start() -> Self {
        Self { throughput: Vec3::ONE, density: f32::INFINITY, radiance: Vec3::ZERO, state: 0 }
    }

    /// One more than the index of the material that it is inside of; 0 for none that absorbs.
    #[inline(always)]
    pub fn medium(&self) -> u32 {
        self.state & !Self::MET
    }

    /// Another medium.
    #[inline(always)]
    pub fn enter(&mut self, medium: u32) {
        self.state = self.state & Self::MET | medium;
    }
}

/// The ray of a path that has ended: it meets nothing.
pub const ENDED: Ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::ZERO, t_max: -1.0 };

/// Whether a ray is [`ENDED`].
#[inline(always)]
pub fn has_ended(ray: &Ray) -> bool {
    ray.t_max < ray.t_min
}

impl Frame {
    /// Pixel of a slot in the picture; none beyond the last.
    #[inline(always)]
    pub(crate) fn pixel_of_slot(&self, slot: u32) -> Option<[u32; 2]> {
        let [width, height] = self.extent;
        let (row, column) = (slot / width, slot % width);
        (row < height).then(|| [self.origin[0] + column, self.origin[1] + row])
    }

    /// Random numbers of the launch's first sample of a pixel.
    #[inline(always)]
    pub(crate) fn sampler(&self, pixel: [u32; 2]) -> Sampler {
        let [sample, _, count] = self.samples;
        Sampler::new(pixel, sample, count, self.seed)
    }
}

/// The random numbers of a pixel's sample at a depth.
#[derive(Clone, Copy)]
pub(crate) struct Numbers {
    /// Which light to look at.
    pub light: Pair,
    /// Where on it.
    pub place: Pair,
    /// Which way to go on.
    pub direction: Pair,
    /// By which lobe, and whether at all.
    pub lobe: Pair,
}

impl Numbers {
    /// The first pair places the sample in the pixel.
    #[inline(always)]
    pub fn at(sampler: &Sampler, depth: u32) -> Self {
        let first = 1 + 4 * depth;
        Self {
            light: sampler.pair(first),
            place: sampler.pair(first + 1),
            direction: sampler.pair(first + 2),
            lobe: sampler.pair(first + 3),
        }
    }
}
