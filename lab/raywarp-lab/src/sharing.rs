//! A batch of rays, shared out among threads in several ways.

use std::marker::PhantomData;

use raywarp_core::kernels::Kernel;
use raywarp_core::traversal;
use raywarp_core::traversal::query::{AnyHit, ClosestHit, Query};
use raywarp_lab_core::sharing::direct::Direct;
use raywarp_lab_core::sharing::form::{Form, IfIf, Postponed, Speculative, WhileWhile};
use raywarp_lab_core::sharing::queued::Queued;
use raywarp_lab_core::sharing::refill::Refill;

use raywarp_core::view::ViewMut;

use crate::lanes::LoopForm;
use raywarp::accel::bvh2::Bvh2;
use raywarp::device::{Buffer, Device, DeviceError};
use raywarp::query::{Answers, HitBuffers};
use raywarp::{Ray, Triangle, Vec3};
use raywarp_device::kernels::Views;

/// How threads come by their rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// One thread a ray, with a loop.
    Direct(LoopForm),
    /// As many threads as fit on the device, which take work units of a warp's worth of rays from queues.
    Queued(Queues),
    /// The same, from one queue, and each lane that is done gets a new ray.
    Refill,
    /// With the speculative loop, as Aila and Laine's.
    RefillSpeculative,
}

/// Whose queues those are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Queues {
    /// One for all: persistent threads.
    Global,
    /// One a block, from which other blocks steal.
    Block,
    /// One a warp, likewise.
    Warp,
}

/// Queues that a warp looks into before it gives up. The owner of a queue empties it, so no unit is left.
const TRIES: u32 = 64;

/// A tree and rays on a device, with room for their answers.
pub struct Batch {
    device: Device,
    nodes: Buffer<traversal::bvh2::Node>,
    triangles: Buffer<Triangle>,
    reach: Vec3,
    rays: Buffer<Ray>,
    storage: Storage,
    taken: Option<Buffer<u32>>,
}

enum Storage {
    Closest(HitBuffers),
    Occluded(Buffer<u32>),
}

impl Batch {
    /// Copies a tree and rays to a device, to ask for the closest hit of each, or whether each hits anything.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(device: &Device, tree: &Bvh2, rays: &[Ray], any_hit: bool) -> Result<Self, DeviceError> {
        let answer = if any_hit { size_of::<u32>() } else { HitBuffers::HIT };
        let bytes = tree.stats().bytes + (size_of::<Ray>() + answer) * rays.len();
        device.reserve(bytes as u64, "a tree and rays")?;
        let storage = match any_hit {
            true => Storage::Occluded(device.zeroed(rays.len())?),
            false => Storage::Closest(HitBuffers::new(device, rays.len())?),
        };
        Ok(Self {
            device: device.clone(),
            nodes: device.upload(tree.nodes())?,
            triangles: device.upload(tree.triangles())?,
            reach: tree.reach(),
            rays: device.upload(rays)?,
            storage,
            taken: None,
        })
    }

    /// Launches in blocks of so many threads.
    ///
    /// # Errors
    /// As for [`Device::with_block`].
    pub fn set_block(&mut self, threads: u32) -> Result<(), DeviceError> {
        self.device = self.device.with_block(Some([threads, 1]))?;
        Ok(())
    }

    /// Answers all rays `warmup` times, and then `repeats` times of which each is timed: seconds on the device.
    ///
    /// # Errors
    /// The device fails.
    pub fn time(&mut self, way: Way, times: [u32; 2]) -> Result<Vec<f64>, DeviceError> {
        let tree = traversal::Bvh2 { nodes: self.nodes.view(), triangles: self.triangles.view(), reach: self.reach };
        let rays = self.rays.view();
        let mut launch = Launch { device: &self.device, tree, rays, taken: &mut self.taken, times };
        match &mut self.storage {
            Storage::Closest(hits) => launch.time::<ClosestHit>(way, hits.arrays()),
            Storage::Occluded(occluded) => launch.time::<AnyHit>(way, occluded.view_mut()),
        }
    }

    /// Forgets the answers.
    ///
    /// # Errors
    /// The device fails.
    pub fn clear(&mut self) -> Result<(), DeviceError> {
        match &mut self.storage {
            Storage::Closest(hits) => hits.clear(),
            Storage::Occluded(occluded) => occluded.clear(),
        }
    }

    /// Whether the numbers of the queues are back at zero. If they are not, launches after the first had nothing to do.
    ///
    /// # Errors
    /// The device fails.
    pub fn is_reset(&self) -> Result<bool, DeviceError> {
        Ok(match &self.taken {
            Some(taken) => taken.to_vec()?.iter().all(|&number| number == 0),
            None => true,
        })
    }

    /// The answers of the last time; before any, zeros.
    ///
    /// # Errors
    /// The device fails.
    pub fn answers(&self) -> Result<Answers, DeviceError> {
        Ok(match &self.storage {
            Storage::Closest(hits) => Answers::Closest(hits.to_vec()?),
            Storage::Occluded(occluded) => Answers::Occluded(occluded.to_vec()?.iter().map(|&any| any != 0).collect()),
        })
    }
}

/// What the kernels of all ways share.
struct Launch<'a> {
    device: &'a Device,
    tree: traversal::Bvh2,
    rays: raywarp_core::view::View<Ray>,
    /// The queues' numbers, zero between launches.
    taken: &'a mut Option<Buffer<u32>>,
    times: [u32; 2],
}

impl Launch<'_> {
    fn time<Q: Query>(&mut self, way: Way, answers: Q::Answers) -> Result<Vec<f64>, DeviceError>
    where
        Direct<IfIf, Q>: Kernel,
        Direct<WhileWhile, Q>: Kernel,
        Direct<Speculative, Q>: Kernel,
        Direct<Postponed, Q>: Kernel,
        Queued<Q>: Kernel,
        Refill<WhileWhile, Q>: Kernel,
        Refill<Speculative, Q>: Kernel,
    {
        match way {
            Way::Direct(LoopForm::IfIf) => self.direct::<IfIf, Q>(answers),
            Way::Direct(LoopForm::WhileWhile) => self.direct::<WhileWhile, Q>(answers),
            Way::Direct(LoopForm::Speculative) => self.direct::<Speculative, Q>(answers),
            Way::Direct(LoopForm::Postponed) => self.direct::<Postponed, Q>(answers),
            Way::Queued(queues) => self.queued::<Q>(queues, answers),
            Way::Refill => self.refill::<WhileWhile, Q>(answers),
            Way::RefillSpeculative => self.refill::<Speculative, Q>(answers),
        }
    }

    fn direct<F: Form, Q: Query>(&self, answers: Q::Answers) -> Result<Vec<f64>, DeviceError>
    where
        Direct<F, Q>: Kernel,
    {
        let kernel = Direct { tree: self.tree, rays: self.rays, answers, form: PhantomData::<F> };
        self.run(&kernel, self.rays.len())
    }

    fn queued<Q: Query>(&mut self, queues: Queues, answers: Q::Answers) -> Result<Vec<f64>, DeviceError>
    where
        Queued<Q>: Kernel,
    {
        let threads = self.device.resident_threads::<Queued<Q>>()?;
        let (warp, block) = self.device.warp_and_block();
        let warps = threads / warp;
        let warps_a_queue = match queues {
            Queues::Global => warps,
            Queues::Block => block / warp,
            Queues::Warp => 1,
        };
        let taken = self.numbers(warps.div_ceil(warps_a_queue) + 1)?;
        let (tree, rays, query) = (self.tree, self.rays, PhantomData);
        let tries = TRIES.min(warps.div_ceil(warps_a_queue));
        let kernel = Queued::<Q> { tree, rays, answers, taken, warps_a_queue, tries, warps, query };
        self.run(&kernel, threads)
    }

    fn refill<F: Form, Q: Query>(&mut self, answers: Q::Answers) -> Result<Vec<f64>, DeviceError>
    where
        Refill<F, Q>: Kernel,
    {
        let threads = self.device.resident_threads::<Refill<F, Q>>()?;
        let warps = threads / self.device.warp_and_block().0;
        let taken = self.numbers(2)?;
        let kernel = Refill { tree: self.tree, rays: self.rays, answers, taken, warps, form: PhantomData::<F> };
        self.run(&kernel, threads)
    }

    fn numbers(&mut self, count: u32) -> Result<ViewMut<u32>, DeviceError> {
        Ok(self.taken.insert(self.device.zeroed(count as usize)?).view_mut())
    }

    fn run<K: Kernel>(&self, kernel: &K, threads: u32) -> Result<Vec<f64>, DeviceError> {
        let [warmup, repeats] = self.times;
        // SAFETY: all buffers belong to the batch, which is borrowed, and are of its device. The builders keep their
        // indices in range. Numbers of queues start at zero, and their kernels leave them so.
        unsafe { self.device.time(kernel, [threads, 1], warmup, repeats) }
    }
}
