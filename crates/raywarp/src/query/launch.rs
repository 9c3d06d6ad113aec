//! From a request to the launch of its kernel.

use raywarp_core::kernels::Kernel;
use raywarp_core::persistent::Persistent;
use raywarp_core::ray::HitArrays;
use raywarp_core::traversal::query::{AnyHit, ClosestHit, Query};
use raywarp_core::traversal::QuantizedBvh2;
use raywarp_core::view::{View, ViewMut};
use raywarp_device::kernels::{Launchable, Timed, Views};

use super::{Coherence, QueryError, RayCaster};
use crate::device::{Buffer, Device, DeviceError, Stream};
use crate::Ray;

/// What a kernel is asked, and where its answers go.
#[derive(Clone, Copy)]
pub enum Request {
    Find(Find),
    Collect(Collect),
}

/// What one traversal answers.
#[derive(Clone, Copy)]
pub enum Find {
    Closest { hits: HitArrays },
    Any { blocked: ViewMut<u32> },
}

/// What looks at every hit.
#[derive(Clone, Copy)]
pub enum Collect {
    Count { limit: u32, counts: ViewMut<u32> },
    All { offsets: View<u32>, limit: u32, counts: ViewMut<u32>, hits: HitArrays },
}

/// What answers can do. Not for other crates: kernels trust it.
pub trait Fill {
    /// Whether the buffers fit so many rays, on this device.
    fn check(&self, device: &Device, rays: u32) -> Result<(), QueryError>;

    /// What to ask.
    fn request(&mut self) -> Request;
}

impl RayCaster {
    /// Launches the kernel of a request.
    ///
    /// # Safety
    /// As for [`Device::launch`], until the launch has been waited for.
    pub(super) unsafe fn launch(
        &self,
        rays: View<Ray>,
        request: Request,
        stream: Option<&Stream>,
    ) -> Result<Launched, DeviceError> {
        let batch = Batch { device: self.device(), rays, stream };
        let structure = self.structure();
        let kernel = match request {
            Request::Find(request) => match (self.persistent(), request) {
                // SAFETY: the caller's promise.
                (Some(tree), request) => return unsafe { batch.find_by_persistent_threads(tree, request) },
                (None, Find::Closest { hits }) => structure.closest(rays, hits),
                (None, Find::Any { blocked }) => structure.occluded(rays, blocked),
            },
            Request::Collect(Collect::Count { limit, counts }) => structure.count(rays, limit, counts),
            Request::Collect(Collect::All { offsets, limit, counts, hits }) => {
                structure.all(rays, offsets, limit, counts, hits)
            }
        };
        // SAFETY: the caller's promise.
        unsafe { batch.run(&*kernel, rays.len()) }.map(Launched::from)
    }

    /// The tree by which batches as expected are answered by persistent threads, if they are.
    pub(super) fn persistent(&self) -> Option<QuantizedBvh2> {
        let persistent = self.expected == Coherence::Incoherent && self.device().is_cuda();
        persistent.then(|| self.structure().quantized()).flatten()
    }

    /// Whether batches are answered by one kernel or the other as [`Coherence`] says.
    pub(super) fn has_choice(&self) -> bool {
        self.device().is_cuda() && self.structure().quantized().is_some()
    }
}

/// A request under way.
pub struct Launched {
    launch: Timed,
    /// Of persistent threads.
    _numbers: Option<Buffer<u32>>,
}

impl Launched {
    /// Waits for the answers; the seconds that it took on the device.
    pub fn wait(&self) -> Result<f64, DeviceError> {
        self.launch.wait()
    }
}

impl From<Timed> for Launched {
    fn from(launch: Timed) -> Self {
        Self { launch, _numbers: None }
    }
}

/// Persistent threads for the whole device, or for the batch; with the threads of its launch.
pub fn persistent<Q: Query>(
    device: &Device,
    tree: QuantizedBvh2,
    rays: View<Ray>,
    answers: Q::Answers,
    numbers: &mut Buffer<u32>,
) -> Result<(Persistent<Q>, u32), DeviceError>
where
    Persistent<Q>: Kernel,
{
    let (threads, warps) = threads_and_warps(device, device.resident_threads::<Persistent<Q>>()?, rays);
    Ok((Persistent { tree, rays, answers, taken: numbers.view_mut(), warps }, threads))
}

/// Threads and warps for a batch, of as many threads as the device holds. Blocks are whole: the last of all warps that there are leaves
/// the counters at zero.
pub fn threads_and_warps(device: &Device, resident: u32, rays: View<Ray>) -> (u32, u32) {
    let (warp, block) = device.warp_and_block();
    let threads = resident.min(rays.len().div_ceil(block).saturating_mul(block));
    (threads, threads.div_ceil(warp))
}

struct Batch<'a> {
    device: &'a Device,
    rays: View<Ray>,
    stream: Option<&'a Stream>,
}

impl Batch<'_> {
    /// # Safety
    /// As for [`Device::launch`], until the launch has been waited for.
    unsafe fn find_by_persistent_threads(&self, tree: QuantizedBvh2, request: Find) -> Result<Launched, DeviceError> {
        let mut numbers = self.device.zeroed(Persistent::<ClosestHit>::NUMBERS)?;
        // SAFETY: the caller's promise, for each of them; the numbers are held as long.
        let launch = unsafe {
            match request {
                Find::Closest { hits } => {
                    let (kernel, threads) = persistent::<ClosestHit>(self.device, tree, self.rays, hits, &mut numbers)?;
                    self.run(&kernel, threads)?
                }
                Find::Any { blocked } => {
                    let (kernel, threads) = persistent::<AnyHit>(self.device, tree, self.rays, blocked, &mut numbers)?;
                    self.run(&kernel, threads)?
                }
            }
        };
        Ok(Launched { launch, _numbers: Some(numbers) })
    }

    /// # Safety
    /// As for [`Device::launch`], until the launch has been waited for.
    unsafe fn run(&self, kernel: &dyn Launchable, threads: u32) -> Result<Timed, DeviceError> {
        let extent = [threads, 1];
        match self.stream {
            // SAFETY: the caller's promise.
            Some(stream) => unsafe { Timed::launch_on(stream, kernel, extent) },
            // SAFETY: the caller's promise.
            None => unsafe { Timed::launch(self.device, kernel, extent) },
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::accel::{AccelKind, Build, Quality};
    use crate::device::DeviceChoice;
    use crate::query::HitBuffers;
    use crate::{Triangle, Vec3};

    fn point(size: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-size..size).prop_map(Vec3::from)
    }

    fn scene() -> impl Strategy<Value = Vec<Triangle>> {
        let corners = (point(4.0), point(1.0), point(1.0));
        prop::collection::vec(corners, 0..300).prop_map(|corners| {
            let triangle = |(i, (a, b, c)): (usize, (Vec3, Vec3, Vec3))| Triangle::new(a, a + b, a + c, i as u32, 0);
            corners.into_iter().enumerate().map(triangle).collect()
        })
    }

    fn rays() -> impl Strategy<Value = Vec<Ray>> {
        let limits = prop::sample::select(vec![
            (0.0, f32::INFINITY),
            (0.5, 2.0),
            (-3.0, 3.0),
            (2.0, 1.0),
            (f32::NEG_INFINITY, f32::INFINITY),
            (f32::NAN, 1.0),
            (0.0, f32::NAN),
        ]);
        let special = prop::sample::select(vec![[0.0; 3], [0.0, 1.0, 0.0], [f32::NAN, 1.0, 0.0], [f32::INFINITY; 3]]);
        let direction = prop_oneof![8 => point(1.0), 1 => special.prop_map(Vec3::from)];
        let ray = (point(5.0), direction, limits);
        let ray = ray.prop_map(|(origin, direction, (t_min, t_max))| Ray { origin, t_min, direction, t_max });
        prop::collection::vec(ray, 0..400)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// On the CPU, where a warp is one lane: the GPU's is asked in `tests/conformance`.
        #[test]
        fn persistent_threads_answer_as_brute_force_does(triangles in scene(), rays in rays()) {
            let device = Device::open(DeviceChoice::Cpu).unwrap();
            let with = |kind| {
                let build = Build { quality: Quality::High, ..Build::from(kind) };
                RayCaster::new(triangles.clone(), build, &device).unwrap()
            };
            let (brute, caster) = (with(AccelKind::Brute), with(AccelKind::Bvh));
            let tree = caster.structure().quantized().unwrap();
            let batch = device.upload(&rays).unwrap();
            let mut numbers = device.zeroed(Persistent::<ClosestHit>::NUMBERS).unwrap();
            let mut hits = HitBuffers::new(&device, rays.len()).unwrap();
            let mut blocked = device.zeroed::<u32>(rays.len()).unwrap();
            // Twice, for what the first launch leaves behind.
            for _ in 0..2 {
                let (kernel, threads) =
                    persistent::<ClosestHit>(&device, tree, batch.view(), hits.arrays(), &mut numbers).unwrap();
                // SAFETY: the buffers are held until the launch is over, which is when this returns.
                unsafe { device.launch(&kernel, [threads, 1]) }.unwrap();
                let (kernel, threads) =
                    persistent::<AnyHit>(&device, tree, batch.view(), blocked.view_mut(), &mut numbers).unwrap();
                // SAFETY: as above.
                unsafe { device.launch(&kernel, [threads, 1]) }.unwrap();
                prop_assert_eq!(numbers.to_vec().unwrap(), [0, 0]);
                prop_assert_eq!(hits.to_vec().unwrap(), brute.hits(&rays).unwrap());
                let any: Vec<bool> = blocked.to_vec().unwrap().iter().map(|&any| any != 0).collect();
                prop_assert_eq!(any, brute.any(&rays).unwrap());
            }
        }
    }
}
