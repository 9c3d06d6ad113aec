//! A batch that stays on the device and is asked again and again: for measuring.

use raywarp_core::persistent::Persistent;
use raywarp_core::traversal::query::{AnyHit, ClosestHit};
use raywarp_device::kernels::{Launchable, Views};

use super::coherence::faster;
use super::launch::persistent;
use super::{HitBuffers, QueryError, RayCaster};
use crate::device::{Buffer, DeviceError, KernelInfo};
use crate::{Hit, Ray};

/// Rays on a device with room for their answers.
pub struct Timed {
    caster: RayCaster,
    rays: Buffer<Ray>,
    room: Room,
    /// Of persistent threads.
    numbers: Buffer<u32>,
}

/// Room for answers on the device.
enum Room {
    Closest(HitBuffers),
    Occluded(Buffer<u32>),
}

/// What became of a batch, one a ray.
#[derive(Clone, Debug, PartialEq)]
pub enum Answers {
    /// As [`RayCaster::hits`].
    Closest(Vec<Hit>),
    /// As [`RayCaster::any`].
    Occluded(Vec<bool>),
}

impl RayCaster {
    /// Copies rays to the device, to ask for the closest hit of each, or whether each hits anything. Where there are two
    /// kernels for it, both are tried, and the faster is used.
    ///
    /// # Errors
    /// The device has no room for the batch, or fails.
    pub fn timed(&self, rays: &[Ray], any_hit: bool) -> Result<Timed, QueryError> {
        let answer = if any_hit { size_of::<u32>() } else { HitBuffers::HIT };
        self.device().reserve(((size_of::<Ray>() + answer) * rays.len()) as u64, "the rays")?;
        let room = match any_hit {
            true => Room::Occluded(self.device().zeroed(rays.len())?),
            false => Room::Closest(HitBuffers::new(self.device(), rays.len())?),
        };
        let numbers = self.device().zeroed(Persistent::<ClosestHit>::NUMBERS)?;
        let mut timed = Timed { caster: self.clone(), rays: self.device().upload(rays)?, room, numbers };
        if self.has_choice() {
            let suits = faster(|coherence| {
                timed.caster = self.expecting(coherence);
                Ok(timed.time(1, 3)?.into_iter().fold(f64::INFINITY, f64::min))
            })?;
            timed.caster = self.expecting(suits);
        }
        Ok(timed)
    }
}

impl Timed {
    /// Asks `warmup` times, and then `repeats` times of which each is timed. Returns the seconds on the device, without
    /// any copy.
    ///
    /// # Errors
    /// The device fails.
    pub fn time(&mut self, warmup: u32, repeats: u32) -> Result<Vec<f64>, QueryError> {
        let (kernel, threads) = self.kernel()?;
        // SAFETY: this holds structure, rays and answers until it returns. The builders keep their indices in range.
        Ok(unsafe { kernel.time(self.caster.device(), [threads, 1], [warmup, repeats]) }?)
    }

    /// What the kernel takes of the device; nothing on the CPU.
    ///
    /// # Errors
    /// The device does not answer.
    pub fn kernel_info(&mut self) -> Result<Option<KernelInfo>, QueryError> {
        let (kernel, threads) = self.kernel()?;
        Ok(kernel.info(self.caster.device(), [threads, 1])?)
    }

    /// The kernel that answers the batch, and its threads.
    fn kernel(&mut self) -> Result<(Box<dyn Launchable>, u32), DeviceError> {
        let (caster, rays, numbers) = (&self.caster, self.rays.view(), &mut self.numbers);
        let device = caster.device();
        Ok(match (caster.persistent(), &mut self.room) {
            (Some(tree), Room::Closest(hits)) => {
                let (kernel, threads) = persistent::<ClosestHit>(device, tree, rays, hits.arrays(), numbers)?;
                (Box::new(kernel), threads)
            }
            (Some(tree), Room::Occluded(occluded)) => {
                let (kernel, threads) = persistent::<AnyHit>(device, tree, rays, occluded.view_mut(), numbers)?;
                (Box::new(kernel), threads)
            }
            (None, Room::Closest(hits)) => (caster.structure().closest(rays, hits.arrays()), rays.len()),
            (None, Room::Occluded(occluded)) => (caster.structure().occluded(rays, occluded.view_mut()), rays.len()),
        })
    }

    /// The answers of the last time; before any, zeros.
    ///
    /// # Errors
    /// The device fails.
    pub fn answers(self) -> Result<Answers, QueryError> {
        Ok(match self.room {
            Room::Closest(hits) => Answers::Closest(hits.to_vec()?),
            Room::Occluded(occluded) => Answers::Occluded(occluded.download()?.iter().map(|&any| any != 0).collect()),
        })
    }
}

impl Answers {
    /// Rays that hit something.
    pub fn hits(&self) -> usize {
        match self {
            Self::Closest(hits) => hits.iter().filter(|hit| !hit.is_miss()).count(),
            Self::Occluded(occluded) => occluded.iter().filter(|&&any| any).count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::AccelKind;
    use crate::device::Device;
    use crate::device::DeviceChoice;
    use crate::{Triangle, Vec3};

    #[test]
    fn a_batch_answers_as_a_single_call_does() {
        let floor = Triangle::new([0.0; 3].into(), [1.0, 0.0, 0.0].into(), [0.0, 0.0, 1.0].into(), 0, 0);
        let down = |x: f32| Ray::new(Vec3::new(x, 2.0, 0.25), Vec3::new(0.0, -1.0, 0.0));
        let rays: Vec<_> = (0..300).map(|i| down(i as f32 * 0.01)).collect();
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        for kind in AccelKind::ALL {
            let caster = RayCaster::new(vec![floor], kind, &device).unwrap();
            for any_hit in [false, true] {
                let mut batch = caster.timed(&rays, any_hit).unwrap();
                let seconds = batch.time(1, 3).unwrap();
                assert!(seconds.len() == 3 && seconds.iter().all(|&seconds| seconds >= 0.0));
                assert_eq!(batch.kernel_info().unwrap(), None);
                let answers = batch.answers().unwrap();
                assert!((74..=76).contains(&answers.hits()), "{}", answers.hits());
                match answers {
                    Answers::Closest(hits) => assert_eq!(hits, caster.hits(&rays).unwrap()),
                    Answers::Occluded(any) => assert_eq!(any, caster.any(&rays).unwrap()),
                }
            }
        }
    }
}
