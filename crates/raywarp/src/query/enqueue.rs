//! Queries in memory and on streams that others own: arrays of CUDA libraries, without a copy and without a wait.
//!
//! An [`Enqueuer`] tells a stream what to do and returns. On the way there is no allocation, no event, no wait and no kernel that
//! is still to be loaded, so a stream may be [captured](Stream::is_capturing) into a CUDA graph meanwhile.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use raywarp_core::gather::GatherRays;
use raywarp_core::kernels::Kernel;
use raywarp_core::persistent::Persistent;
use raywarp_core::ray::HitArrays;
use raywarp_core::traversal::query::{AnyHit, ClosestHit};
use raywarp_core::traversal::QuantizedBvh2;
use raywarp_core::view::{View, ViewMut};
use raywarp_device::kernels::{Launchable, Views};

use super::launch::threads_and_warps;
use super::{Coherence, QueryError, RayCaster};
use crate::device::{Buffer, Device, DeviceError, Stream};
use crate::scene::Transform;
use crate::Ray;

/// Numbers of a launch of persistent threads; those of closest and any hit are as many.
const NUMBERS: usize = Persistent::<ClosestHit>::NUMBERS;

/// Launches that may be under way at once, each with numbers of its own: one for each stream, and one for each that is captured.
const LAUNCHES: usize = 1 << 16;

/// What is asked, and where the answers go.
#[derive(Clone, Copy, Debug)]
pub enum Question {
    /// The closest hit of each ray: one a ray.
    Closest(HitArrays),
    /// Whether each hits anything: 0 or 1, one a ray.
    Any(ViewMut<u32>),
    /// How many hits each has.
    Count {
        /// Where counting ends.
        limit: u32,
        /// One a ray.
        counts: ViewMut<u32>,
    },
    /// Every hit of each ray, in order.
    All {
        /// Where the hits of each ray begin, and where those of the last end: one more than there are rays, ascending.
        offsets: View<u32>,
        /// How many were found, one a ray: what lies between two offsets, or less.
        counts: ViewMut<u32>,
        /// As many as the last offset says.
        hits: HitArrays,
    },
}

/// Asks a scene on a device, on streams and in memory that others own. When it is dropped it waits for the device, as kernels may
/// still be reading the scene; graphs into which it was captured are not to be launched after that.
pub struct Enqueuer {
    caster: RayCaster,
    persistent: Option<PersistentLaunch>,
}

/// What persistent threads need beside a batch.
struct PersistentLaunch {
    tree: QuantizedBvh2,
    /// Threads that the device holds of the kernels for closest and for any hit.
    threads: [u32; 2],
    numbers: Mutex<Numbers>,
}

/// Counters of persistent threads, which are zero between launches.
struct Numbers {
    buffer: Buffer<u32>,
    of_streams: HashMap<usize, u32>,
    used: u32,
}

impl Enqueuer {
    /// Loads all that questions need on the device.
    ///
    /// # Errors
    /// The device fails, or has no room.
    pub fn new(caster: RayCaster) -> Result<Self, QueryError> {
        let device = caster.device();
        let (rays, hits) = (View::EMPTY, HitArrays { hits: ViewMut::EMPTY, instances: ViewMut::EMPTY });
        let structure = caster.structure();
        let kernels = [
            structure.closest(rays, hits),
            structure.occluded(rays, ViewMut::EMPTY),
            structure.count(rays, 0, ViewMut::EMPTY),
            structure.all(rays, View::EMPTY, 0, ViewMut::EMPTY, hits),
        ];
        kernels.iter().try_for_each(|kernel| kernel.load(device))?;
        device.load::<GatherRays>()?;
        let persistent = tree(&caster).map(|tree| PersistentLaunch::new(device, tree)).transpose()?;
        // What was copied to the device is there, whichever stream asks.
        device.synchronize()?;
        Ok(Self { caster, persistent })
    }

    /// Puts instances elsewhere, as [`DeviceScene::set_transforms`](crate::device_scene::DeviceScene::set_transforms) does, once the
    /// device has done what it was told. What is enqueued from then on sees it; graphs that were captured before are of the scene as it was,
    /// and are not to be launched.
    ///
    /// # Errors
    /// As there, and where others hold the scene.
    pub fn set_transforms(&mut self, moved: &[(usize, &Transform)]) -> Result<bool, QueryError> {
        self.caster.device().synchronize()?;
        let done = self.caster.scene_mut()?.set_transforms(moved)?;
        self.caster.device().synchronize()?;
        if let (Some(launch), Some(tree)) = (&mut self.persistent, tree(&self.caster)) {
            launch.tree = tree;
        }
        Ok(done)
    }

    /// What is asked.
    pub fn caster(&self) -> &RayCaster {
        &self.caster
    }

    /// Enqueues a question of a batch after all that the stream was told before. `handle` tells the stream from others of the device.
    ///
    /// # Safety
    /// Rays and answers are in memory of the device, there are as many as [`Question`] says, and until the stream has done this, or
    /// each time that a graph does it, they stay there and nothing else touches the answers or writes the rays.
    ///
    /// # Errors
    /// The launch fails, or more than 65536 streams and captures were used.
    pub unsafe fn enqueue(
        &self,
        stream: &Stream,
        handle: usize,
        rays: View<Ray>,
        question: Question,
        coherence: Coherence,
    ) -> Result<(), QueryError> {
        let (device, structure) = (self.caster.device(), self.caster.structure());
        let persistent = self.persistent.as_ref().filter(|_| coherence == Coherence::Incoherent);
        let (kernel, threads): (Box<dyn Launchable>, u32) = match (question, persistent) {
            (Question::Closest(hits), Some(launch)) => {
                let (taken, (threads, warps)) =
                    (launch.numbers(stream, handle)?, threads_and_warps(device, launch.threads[0], rays));
                (Box::new(Persistent::<ClosestHit> { tree: launch.tree, rays, answers: hits, taken, warps }), threads)
            }
            (Question::Any(blocked), Some(launch)) => {
                let (taken, (threads, warps)) =
                    (launch.numbers(stream, handle)?, threads_and_warps(device, launch.threads[1], rays));
                (Box::new(Persistent::<AnyHit> { tree: launch.tree, rays, answers: blocked, taken, warps }), threads)
            }
            (Question::Closest(hits), None) => (structure.closest(rays, hits), rays.len()),
            (Question::Any(blocked), None) => (structure.occluded(rays, blocked), rays.len()),
            (Question::Count { limit, counts }, _) => (structure.count(rays, limit, counts), rays.len()),
            (Question::All { offsets, counts, hits }, _) => (structure.all(rays, offsets, 0, counts, hits), rays.len()),
        };
        // SAFETY: the caller's promise; the structure is held by this, which waits before it lets go.
        Ok(unsafe { kernel.launch_on(stream, [threads, 1]) }?)
    }

    /// Enqueues the making of rays, as [`GatherRays`] says.
    ///
    /// # Safety
    /// As for [`enqueue`](Self::enqueue), with the rays for answers.
    ///
    /// # Errors
    /// The launch fails.
    pub unsafe fn gather(&self, stream: &Stream, kernel: &GatherRays) -> Result<(), QueryError> {
        // SAFETY: the caller's promise.
        Ok(unsafe { stream.launch(kernel, [kernel.rays.len(), 1]) }?)
    }
}

impl Drop for Enqueuer {
    fn drop(&mut self) {
        // Of a device that fails nothing can be learned here; it runs no kernels either.
        let _ = self.caster.device().synchronize();
    }
}

impl PersistentLaunch {
    fn new(device: &Device, tree: QuantizedBvh2) -> Result<Self, DeviceError> {
        let threads = [resident::<Persistent<ClosestHit>>(device)?, resident::<Persistent<AnyHit>>(device)?];
        let buffer = device.zeroed(NUMBERS * LAUNCHES)?;
        Ok(Self { tree, threads, numbers: Mutex::new(Numbers { buffer, of_streams: HashMap::new(), used: 0 }) })
    }

    /// Counters that no other launch has that may be under way: those of a stream run one after the other, and a graph may be
    /// launched beside them at any time.
    fn numbers(&self, stream: &Stream, handle: usize) -> Result<ViewMut<u32>, DeviceError> {
        let capturing = stream.is_capturing()?;
        let mut numbers = self.numbers.lock().unwrap_or_else(PoisonError::into_inner);
        let known = numbers.of_streams.get(&handle).copied().filter(|_| !capturing);
        let index = known.map_or_else(|| numbers.next(), Ok)?;
        if !capturing {
            numbers.of_streams.insert(handle, index);
        }
        let address = numbers.buffer.view_mut().shared(index * NUMBERS as u32);
        // SAFETY: so many lie there, for as long as this; whoever launches with them is the only one.
        Ok(unsafe { ViewMut::new(address, NUMBERS as u32) })
    }
}

impl Numbers {
    /// The first that nobody has.
    fn next(&mut self) -> Result<u32, DeviceError> {
        if self.used as usize == LAUNCHES {
            return Err(DeviceError::TooMany { len: LAUNCHES + 1 });
        }
        self.used += 1;
        Ok(self.used - 1)
    }
}

/// What persistent threads traverse, where they can.
fn tree(caster: &RayCaster) -> Option<QuantizedBvh2> {
    caster.expecting(Coherence::Incoherent).persistent()
}

/// Loads a kernel, and says how many of its threads fit.
fn resident<K: Kernel>(device: &Device) -> Result<u32, DeviceError> {
    device.load::<K>()?;
    device.resident_threads::<K>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AccelKind;
    use crate::device::DeviceChoice;
    use crate::query::HitBuffers;
    use crate::{Triangle, Vec3};

    /// On the CPU a stream does at once what it is told, so all but the order of streams is as on a GPU.
    #[test]
    fn answers_on_a_stream_are_those_of_a_batch() {
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        let wall = |z: f32, i| Triangle::new(Vec3::new(0.0, 0.0, z), [2.0, 0.0, z].into(), [0.0, 2.0, z].into(), i, 0);
        let caster = RayCaster::new(vec![wall(0.0, 0), wall(1.0, 1)], AccelKind::Bvh, &device).unwrap();
        let enqueuer = Enqueuer::new(caster.clone()).unwrap();
        // SAFETY: the CPU has no streams to be wrong about.
        let stream = unsafe { device.borrow_stream(0) };

        // Rays as others have them: one origin for all, and directions.
        let origins = device.upload(&[0.5_f32, 0.5, 3.0]).unwrap();
        let directions = device.upload(&[0.0_f32, 0.0, -1.0, 0.0, 0.0, 1.0, 0.1, 0.0, -1.0]).unwrap();
        let mut made = device.upload(&[Ray::new(Vec3::ZERO, Vec3::ZERO); 3]).unwrap();
        let gather = GatherRays {
            origins: origins.view(),
            directions: directions.view(),
            strides: [0, 3],
            ends: [0.0, f32::INFINITY],
            rays: made.view_mut(),
        };
        // SAFETY: the buffers live to the end of this test, and each is as long as it has to be. Here and below.
        unsafe { enqueuer.gather(&stream, &gather) }.unwrap();
        let rays = made.to_vec().unwrap();
        assert_eq!(rays[2], Ray::new(Vec3::new(0.5, 0.5, 3.0), Vec3::new(0.1, 0.0, -1.0)));

        let mut hits = HitBuffers::new(&device, 3).unwrap();
        let mut numbers = device.zeroed::<u32>(3).unwrap();
        let ask = |question| {
            // SAFETY: as above.
            unsafe { enqueuer.enqueue(&stream, 0, made.view(), question, Coherence::Incoherent) }.unwrap();
        };
        ask(Question::Closest(hits.arrays()));
        assert_eq!(hits.to_vec().unwrap(), caster.hits(&rays).unwrap());
        ask(Question::Any(numbers.view_mut()));
        assert_eq!(numbers.to_vec().unwrap(), [1, 0, 1]);
        ask(Question::Count { limit: u32::MAX, counts: numbers.view_mut() });
        assert_eq!(numbers.to_vec().unwrap(), [2, 0, 2]);
        let offsets = device.upload(&[0_u32, 2, 2, 4]).unwrap();
        let mut all = HitBuffers::new(&device, 4).unwrap();
        ask(Question::All { offsets: offsets.view(), counts: numbers.view_mut(), hits: all.arrays() });
        let t: Vec<f32> = all.to_vec().unwrap().iter().map(|hit| hit.t).collect();
        assert_eq!(t, caster.all(&rays).unwrap().hits.t);
    }
}
