//! Rays and answers that stay in the memory of the device.
//!
//! Each kind of answer is a struct with its buffers. [`RayCaster::trace`] fills it and waits; [`RayCaster::trace_on`]
//! takes rays and answer over while the host goes on, and [`Pending::wait`] gives them back: so nobody can touch or free
//! a buffer that a kernel still uses.
//!
//! ```
//! use raywarp::device::{Device, DeviceChoice};
//! use raywarp::query::{device::Closest, RayCaster};
//! use raywarp::{Ray, Triangle, Vec3};
//!
//! let device = Device::open(DeviceChoice::Cpu)?;
//! let wall = Triangle::new(Vec3::ZERO, [1.0, 0.0, 0.0].into(), [0.0, 1.0, 0.0].into(), 0, 0);
//! let caster = RayCaster::new(vec![wall], raywarp::accel::AccelKind::Bvh, &device)?;
//! let ahead = |x| Ray::new(Vec3::new(x, 0.25, 3.0), Vec3::new(0.0, 0.0, -1.0));
//!
//! // Two batches at a time: one is traced while the next is made.
//! let stream = device.stream()?;
//! let mut pending = None;
//! for x in [0.25, 0.5, 2.0] {
//!     let rays = device.upload(&[ahead(x)])?;
//!     let next = caster.trace_on(&stream, rays, Closest::new(&device, 1)?)?;
//!     if let Some(last) = pending.replace(next) {
//!         assert_eq!(last.wait()?.answer.hits.to_vec()?[0].t, 3.0);
//!     }
//! }
//! assert!(pending.unwrap().wait()?.answer.hits.to_vec()?[0].is_miss());
//! # Ok::<(), raywarp::query::QueryError>(())
//! ```

use raywarp_core::view::{Plain, View};
use raywarp_device::kernels::Views;

use super::launch::{Collect, Fill, Find, Launched, Request};
use super::{HitBuffers, QueryError, RayCaster};
use crate::device::{Buffer, Device, DeviceError, Stream};
use crate::Ray;

/// Room for the answers to a batch: one of this module's structs.
pub trait Answer: Fill {}

/// The closest hit of each ray.
#[derive(Debug)]
pub struct Closest {
    /// One a ray.
    pub hits: HitBuffers,
}

/// Whether each ray hits anything at all.
#[derive(Debug)]
pub struct Any {
    /// 0 or 1, one a ray.
    pub blocked: Buffer<u32>,
}

/// How many hits each ray has.
#[derive(Debug)]
pub struct Count {
    /// Counting ends here.
    pub limit: u32,
    /// One a ray.
    pub counts: Buffer<u32>,
}

/// The first hits of each ray, in order.
#[derive(Debug)]
pub struct All {
    /// Hits that are kept of each ray.
    pub limit: u32,
    /// How many there are of each ray, at most `limit`.
    pub counts: Buffer<u32>,
    /// Those of ray `i` from `i * limit` on, as many as `counts` says; the rest of each row is as it was.
    pub hits: HitBuffers,
}

impl Closest {
    /// Room for the answers to so many rays.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(device: &Device, rays: u32) -> Result<Self, DeviceError> {
        Ok(Self { hits: HitBuffers::new(device, rays as usize)? })
    }
}

impl Any {
    /// Room for the answers to so many rays.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(device: &Device, rays: u32) -> Result<Self, DeviceError> {
        Ok(Self { blocked: device.zeroed(rays as usize)? })
    }
}

impl Count {
    /// Room for the answers to so many rays; no limit.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(device: &Device, rays: u32) -> Result<Self, DeviceError> {
        Ok(Self { limit: u32::MAX, counts: device.zeroed(rays as usize)? })
    }
}

impl All {
    /// Room for `limit` hits of each of so many rays.
    ///
    /// # Errors
    /// The device has no room, or they are 2^32 or more.
    pub fn new(device: &Device, rays: u32, limit: u32) -> Result<Self, DeviceError> {
        let hits = HitBuffers::new(device, rays as usize * limit as usize)?;
        Ok(Self { limit, counts: device.zeroed(rays as usize)?, hits })
    }
}

/// A batch that is being answered. Dropped, it is waited for.
pub struct Pending<A> {
    launch: Launched,
    /// None once they were given back.
    batch: Option<(Buffer<Ray>, A)>,
    /// Holds the structure.
    _caster: RayCaster,
}

/// A batch that was answered.
#[derive(Debug)]
pub struct Answered<A> {
    /// The batch.
    pub rays: Buffer<Ray>,
    /// Its answers.
    pub answer: A,
    /// Seconds that the kernel ran on the device.
    pub seconds: f64,
}

impl<A> Pending<A> {
    /// Waits until the batch is answered.
    ///
    /// # Errors
    /// The device fails.
    pub fn wait(mut self) -> Result<Answered<A>, QueryError> {
        let seconds = self.launch.wait()?;
        let Some((rays, answer)) = self.batch.take() else { unreachable!("only `wait` takes it, and but once") };
        Ok(Answered { rays, answer, seconds })
    }
}

impl<A> Drop for Pending<A> {
    fn drop(&mut self) {
        if self.batch.is_some() {
            // Of a device that fails nothing can be learned here; it runs no kernels either.
            let _ = self.launch.wait();
        }
    }
}

impl RayCaster {
    /// Answers a batch and waits for it. Returns the seconds that the kernel ran on the device.
    ///
    /// # Errors
    /// A buffer has the wrong length or belongs to another device, or the device fails.
    pub fn trace(&self, rays: &Buffer<Ray>, answer: &mut impl Answer) -> Result<f64, QueryError> {
        Ok(self.start(rays, answer, None)?.wait()?)
    }

    /// Answers a batch after those launched on the stream before, while the host goes on. On the CPU it is answered when
    /// this returns.
    ///
    /// # Errors
    /// As for [`trace`](Self::trace).
    pub fn trace_on<A: Answer>(
        &self,
        stream: &Stream,
        rays: Buffer<Ray>,
        mut answer: A,
    ) -> Result<Pending<A>, QueryError> {
        self.device().check_stream(stream)?;
        let launch = self.start(&rays, &mut answer, Some(stream))?;
        Ok(Pending { launch, batch: Some((rays, answer)), _caster: self.clone() })
    }

    /// The launch has to be waited for before any of the buffers is touched.
    fn start(
        &self,
        rays: &Buffer<Ray>,
        answer: &mut impl Answer,
        stream: Option<&Stream>,
    ) -> Result<Launched, QueryError> {
        self.device().check(rays, "rays")?;
        answer.check(self.device(), rays.len())?;
        let request = answer.request();
        // SAFETY: the buffers are this device's and long enough, each ray writes its own items, and the callers hold all
        // of it until they have waited. The builders keep the structure's indices in range.
        Ok(unsafe { self.launch(rays.view(), request, stream) }?)
    }
}

/// Whether a buffer is on the device and has so many items.
pub(super) fn check<T: Plain>(
    buffer: &Buffer<T>,
    what: &'static str,
    device: &Device,
    rays: u32,
    each: u32,
) -> Result<(), QueryError> {
    device.check(buffer, what)?;
    let needed = u64::from(rays) * u64::from(each);
    if u64::from(buffer.len()) != needed {
        return Err(QueryError::Length { rays, what, needed, has: buffer.len() });
    }
    Ok(())
}

impl Answer for Closest {}
impl Answer for Any {}
impl Answer for Count {}
impl Answer for All {}

impl Fill for Closest {
    fn check(&self, device: &Device, rays: u32) -> Result<(), QueryError> {
        self.hits.check(device, rays, 1)
    }

    fn request(&mut self) -> Request {
        Request::Find(Find::Closest { hits: self.hits.arrays() })
    }
}

impl Fill for Any {
    fn check(&self, device: &Device, rays: u32) -> Result<(), QueryError> {
        check(&self.blocked, "answers", device, rays, 1)
    }

    fn request(&mut self) -> Request {
        Request::Find(Find::Any { blocked: self.blocked.view_mut() })
    }
}

impl Fill for Count {
    fn check(&self, device: &Device, rays: u32) -> Result<(), QueryError> {
        check(&self.counts, "counts", device, rays, 1)
    }

    fn request(&mut self) -> Request {
        Request::Collect(Collect::Count { limit: self.limit, counts: self.counts.view_mut() })
    }
}

impl Fill for All {
    fn check(&self, device: &Device, rays: u32) -> Result<(), QueryError> {
        check(&self.counts, "counts", device, rays, 1)?;
        self.hits.check(device, rays, self.limit)
    }

    fn request(&mut self) -> Request {
        let (counts, hits) = (self.counts.view_mut(), self.hits.arrays());
        Request::Collect(Collect::All { offsets: View::EMPTY, limit: self.limit, counts, hits })
    }
}
