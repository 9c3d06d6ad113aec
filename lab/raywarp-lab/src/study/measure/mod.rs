//! The measurements, one question a file, in the order of the report.

mod about;
mod costs;
mod frames;
mod growth;
mod lanes;
mod paths;
mod scene;
mod sharing;
mod structures;

use raywarp::device::Device;
use raywarp_cli::bench::Spread;
use raywarp_lab::structures::StructureKind;

use super::findings::About;
use super::options::StudyOptions;

pub use about::about;
pub use growth::growth;
pub use scene::scene;

/// How much to measure, and where.
pub struct Setting<'a> {
    pub device: &'a Device,
    /// See [`About::peak_flops`].
    pub peak_flops: Option<f64>,
    pub quick: bool,
    /// Of pictures, in pixels.
    pub size: [u32; 2],
    /// Rays of a kind at least: fewer do not fill a GPU.
    pub least_rays: usize,
    /// Launches before those that are timed, and how many are.
    pub times: [u32; 2],
    /// Tests of a launch that tests every triangle; rays beyond are left out.
    pub most_tests: u64,
    /// Rays that are counted on the CPU, and warps that are followed there.
    pub counted: usize,
    pub followed: usize,
}

impl<'a> Setting<'a> {
    pub fn new(options: &StudyOptions, device: &'a Device, about: &About) -> Self {
        let gpu = device.is_cuda();
        let quick = options.quick;
        let size = options.size.unwrap_or(if quick { [240, 135] } else { [1920, 1080] });
        Self {
            device,
            peak_flops: about.peak_flops,
            quick,
            size,
            least_rays: if quick { 0 } else { 2_000_000 },
            times: [if quick { 1 } else { 3 }, options.repeats.unwrap_or(if quick { 3 } else { 10 })],
            most_tests: if gpu { 40_000_000_000 } else { 60_000_000 },
            counted: if quick { 20_000 } else { 200_000 },
            followed: if quick { 200 } else { 4000 },
        }
    }
}

impl Setting<'_> {
    /// As [`times`](Self::times), and fewer for structures that take long.
    fn times_of(&self, kind: StructureKind) -> [u32; 2] {
        let [warmup, repeats] = self.times;
        match kind.is_exhaustive() {
            true => [1, repeats.min(3)],
            false => [warmup, repeats],
        }
    }
}

/// Seconds as milliseconds.
fn milliseconds(seconds: Vec<f64>) -> Spread {
    Spread::of(seconds.into_iter().map(|seconds| 1e3 * seconds).collect())
}

/// Million rays a second. A clock too coarse for a few rays says 0.
fn rate(rays: usize, seconds: Vec<f64>) -> Spread {
    Spread::of(seconds).falling(|seconds| 1e-6 * rays as f64 / seconds.max(1e-9))
}
