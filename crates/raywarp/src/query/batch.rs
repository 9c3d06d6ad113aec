//! Batches of any size, in passes that fit the device's memory.

use raywarp_device::kernels::{Pace, Views};
use std::ops::ControlFlow;

use super::device::{Answer, Any, Closest, Count};
use super::launch::{Collect, Request};
use super::{AllHits, HitBuffers, Hits, QueryError, RayCaster};
use crate::device::Buffer;
use crate::{Hit, Ray};

/// Most rays of a pass: more would not make it faster.
const MOST_RAYS: usize = 1 << 24;

/// Most hits that are brought back at once: a GiB.
const MOST_HITS: usize = 1 << 26;

/// Bytes of a ray, and of an answer at most.
const BYTES_A_RAY: u64 = (size_of::<Ray>() + HitBuffers::HIT) as u64;

/// How far a batch is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Rays answered.
    pub done: usize,
    /// Rays of the batch.
    pub total: usize,
    /// Seconds that kernels ran on the device.
    pub kernel_seconds: f64,
}

/// A question about many rays, made by [`RayCaster::batch`].
pub struct Batch<'a> {
    caster: &'a RayCaster,
    rays: &'a [Ray],
    limit: u32,
    watch: Option<&'a mut Watch<'a>>,
    kernel_seconds: f64,
}

/// Told of each pass; may end the work.
type Watch<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

impl<'a> Batch<'a> {
    pub(super) fn new(caster: &'a RayCaster, rays: &'a [Ray]) -> Self {
        Self { caster, rays, limit: u32::MAX, watch: None, kernel_seconds: 0.0 }
    }

    /// [`count`](Self::count) and [`all`](Self::all) end at so many hits of a ray.
    pub fn max_hits(mut self, limit: u32) -> Self {
        self.limit = limit;
        self
    }

    /// Calls `watch` after each pass, which aims at a tenth of a second. Where it breaks, the work ends with
    /// [`QueryError::Stopped`].
    pub fn watched(mut self, watch: &'a mut Watch<'a>) -> Self {
        self.watch = Some(watch);
        self
    }

    /// See [`RayCaster::closest`].
    ///
    /// # Errors
    /// The device fails, has no room, or the watcher ends the work.
    pub fn closest(self) -> Result<Hits, QueryError> {
        let mut hits = Hits::default();
        hits.reserve(self.rays.len());
        self.each_hit(|found| hits.extend(&found))?;
        Ok(hits)
    }

    /// See [`RayCaster::hits`].
    ///
    /// # Errors
    /// As for [`closest`](Self::closest).
    pub fn hits(self) -> Result<Vec<Hit>, QueryError> {
        let mut hits = Vec::with_capacity(self.rays.len());
        self.each_hit(|mut found| hits.append(&mut found))?;
        Ok(hits)
    }

    /// See [`RayCaster::any`].
    ///
    /// # Errors
    /// As for [`closest`](Self::closest).
    pub fn any(mut self) -> Result<Vec<bool>, QueryError> {
        let mut blocked = Vec::with_capacity(self.rays.len());
        let caster = self.caster.suited_to(self.rays, Any::new)?;
        self.passes(|_, rays| {
            let (seconds, answer) = answered(&caster, rays, Any::new(caster.device(), rays.len() as u32)?)?;
            blocked.extend(answer.blocked.download()?.iter().map(|&answer| answer != 0));
            Ok(seconds)
        })?;
        Ok(blocked)
    }

    /// See [`RayCaster::count`].
    ///
    /// # Errors
    /// As for [`closest`](Self::closest).
    pub fn count(mut self) -> Result<Vec<u32>, QueryError> {
        let limit = self.limit;
        let mut counts = Vec::with_capacity(self.rays.len());
        self.passes(|caster, rays| {
            let room = Count { limit, ..Count::new(caster.device(), rays.len() as u32)? };
            let (seconds, answer) = answered(caster, rays, room)?;
            counts.append(&mut answer.counts.download()?);
            Ok(seconds)
        })?;
        Ok(counts)
    }

    /// See [`RayCaster::all`].
    ///
    /// # Errors
    /// As for [`closest`](Self::closest).
    pub fn all(self) -> Result<AllHits, QueryError> {
        let mut all = AllHits::default();
        self.all_by_parts(&mut |mut part| {
            all.append(&mut part);
            ControlFlow::Continue(())
        })?;
        Ok(all)
    }

    /// As [`all`](Self::all), handed over part by part: the answers to the first rays, then to those after them. So they
    /// need not fit in memory at once. Where `take` breaks, the work ends with [`QueryError::Stopped`].
    ///
    /// # Errors
    /// As for [`closest`](Self::closest).
    pub fn all_by_parts(mut self, take: &mut dyn FnMut(AllHits) -> ControlFlow<()>) -> Result<(), QueryError> {
        let (limit, total) = (self.limit, self.rays.len());
        let (mut done, room) = (0, self.room_for_hits()?);
        self.passes(|caster, rays| {
            let on_device = caster.device().upload(rays)?;
            let mut answer = Count { limit, ..Count::new(caster.device(), on_device.len())? };
            let mut seconds = caster.trace(&on_device, &mut answer)?;
            let counts = answer.counts.download()?;
            let mut on_device = Some(on_device);
            for part in parts(&counts, room) {
                // Nearly always the whole pass, which is on the device already.
                let (first, counts) = (part.start, &counts[part.clone()]);
                let own = match on_device.take_if(|_| part.len() == rays.len()) {
                    Some(buffer) => buffer,
                    None => caster.device().upload(&rays[part.clone()])?,
                };
                let (more, hits) = fill(caster, &own, counts)?;
                seconds += more;
                if take(hits).is_break() {
                    return Err(QueryError::Stopped { done: done + first, total });
                }
            }
            done += rays.len();
            Ok(seconds)
        })
    }

    fn each_hit(mut self, mut take: impl FnMut(Vec<Hit>)) -> Result<(), QueryError> {
        let caster = self.caster.suited_to(self.rays, Closest::new)?;
        self.passes(|_, rays| {
            let (seconds, answer) = answered(&caster, rays, Closest::new(caster.device(), rays.len() as u32)?)?;
            take(answer.hits.to_vec()?);
            Ok(seconds)
        })
    }

    /// Goes through the rays; `pass` answers some and returns the seconds on the device.
    fn passes(
        &mut self,
        mut pass: impl FnMut(&RayCaster, &[Ray]) -> Result<f64, QueryError>,
    ) -> Result<(), QueryError> {
        let device = self.caster.device();
        let fitting = self.fitting(BYTES_A_RAY)?.min(MOST_RAYS);
        let mut pace = Pace::new(device.is_cuda());
        let (mut done, total) = (0, self.rays.len());
        while done < total {
            let end = total.min(done + (pace.items() as usize).clamp(1, fitting));
            let seconds = pass(self.caster, &self.rays[done..end])?;
            pace.took((end - done) as u64, seconds);
            self.kernel_seconds += seconds;
            done = end;
            let progress = Progress { done, total, kernel_seconds: self.kernel_seconds };
            let stopped = self.watch.as_mut().is_some_and(|watch| watch(progress).is_break());
            if stopped {
                return Err(QueryError::Stopped { done, total });
            }
        }
        Ok(())
    }

    /// Hits that may be on the device at once, beside the rays.
    fn room_for_hits(&self) -> Result<usize, QueryError> {
        Ok(self.fitting(2 * HitBuffers::HIT as u64)?.min(MOST_HITS))
    }

    /// Items of so many bytes that fit in half of the memory that is free; at least one.
    fn fitting(&self, bytes: u64) -> Result<usize, QueryError> {
        let free = self.caster.device().available_memory()?.unwrap_or(u64::MAX);
        Ok(usize::try_from(free / 2 / bytes).unwrap_or(usize::MAX).max(1))
    }
}

/// Traces the rays of a pass.
fn answered<A: Answer>(caster: &RayCaster, rays: &[Ray], mut answer: A) -> Result<(f64, A), QueryError> {
    let rays = caster.device().upload(rays)?;
    let seconds = caster.trace(&rays, &mut answer)?;
    Ok((seconds, answer))
}

/// Runs of rays whose hits fit in `room`; a ray with more is alone.
fn parts(counts: &[u32], room: usize) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
    let mut start = 0;
    std::iter::from_fn(move || {
        let mut hits = 0;
        let fits = counts[start..].iter().take_while(|&&count| {
            hits += count as usize;
            hits <= room
        });
        let len = fits.count().max(1);
        let part = start..counts.len().min(start + len);
        start = part.end;
        (!part.is_empty()).then_some(part)
    })
}

/// The hits of rays that have so many each.
fn fill(caster: &RayCaster, rays: &Buffer<Ray>, counts: &[u32]) -> Result<(f64, AllHits), QueryError> {
    let mut sum = 0;
    let ends = counts.iter().map(|&count| {
        sum += u64::from(count);
        sum
    });
    let offsets: Vec<u64> = std::iter::once(0).chain(ends).collect();
    let total = offsets[counts.len()] as usize;
    caster.device().reserve((total * HitBuffers::HIT) as u64, "the hits of a batch")?;
    let mut hits = HitBuffers::new(caster.device(), total)?;
    // Less than 2^32, or there were no such buffer.
    let places: Vec<u32> = offsets.iter().map(|&offset| offset as u32).collect();
    let places = caster.device().upload(&places)?;
    let mut seen = caster.device().zeroed::<u32>(counts.len())?;
    let (counts, arrays) = (seen.view_mut(), hits.arrays());
    let request = Request::Collect(Collect::All { offsets: places.view(), limit: 0, counts, hits: arrays });
    // SAFETY: all buffers are made here or by the caller on the caster's device and held until the launch is over. The
    // places ascend to the length of `hits`, so each ray has items of its own.
    let seconds = unsafe { caster.launch(rays.view(), request, None) }?.wait()?;
    let mut found = Hits::default();
    found.extend(&hits.to_vec()?);
    Ok((seconds, AllHits { offsets, hits: found }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_what_fits_and_at_least_one_ray() {
        let ranges = |counts: &[u32], room| parts(counts, room).collect::<Vec<_>>();
        assert_eq!(ranges(&[1, 2, 3, 9, 0, 0, 5], 5), [0..2, 2..3, 3..4, 4..7]);
        assert_eq!(ranges(&[1, 1, 6], 5), [0..2, 2..3]);
        assert_eq!(ranges(&[], 5), []);
    }
}
