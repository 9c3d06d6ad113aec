//! Whether neighbours in a batch go the same way, and so which of two kernels answers it.

use rayon::prelude::*;
use raywarp_core::traversal::bvh2_dual::octant;

use super::device::Answer;
use super::{QueryError, RayCaster};
use crate::device::{Buffer, Device, DeviceError};
use crate::Ray;

/// How the rays of a batch lie to each other: which of two kernels answers it on a GPU, over a tree in two layouts
/// ([`AccelKind::Bvh`](crate::accel::AccelKind)). The answers are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coherence {
    /// Most neighbours go the same way, as camera rays in tiles of pixels do: a ray a thread.
    Coherent,
    /// They do not, as after a diffuse bounce: they are answered by [persistent threads](raywarp_core::persistent).
    Incoherent,
}

/// Rays in a row that a GPU traces together.
const RUN: usize = 32;

/// Runs that are looked at.
const MOST: usize = 1024;

impl Coherence {
    /// Of a batch, from a sample: coherent if in at least half of the runs of 32 rays all have the same signs of their
    /// directions' components.
    pub fn of(rays: &[Ray]) -> Self {
        let runs = rays.len().div_ceil(RUN);
        let step = runs.div_ceil(MOST).max(1);
        let looked_at: Vec<bool> = rays
            .par_chunks(RUN)
            .step_by(step)
            .map(|run| run.iter().all(|ray| octant(ray) == octant(&run[0])))
            .collect();
        let same = looked_at.iter().filter(|&&same| same).count();
        if 2 * same >= looked_at.len() {
            Self::Coherent
        } else {
            Self::Incoherent
        }
    }
}

/// Rays of a batch from which on it is worth to trace some of them twice.
const LARGE: usize = 1 << 20;

/// Runs that are traced twice: enough to fill a large GPU.
const TRACED: usize = 1 << 12;

impl RayCaster {
    /// The same for batches like this one, which is traced by either kernel, and from then on by the faster. Directions alone
    /// do not say: where triangles are as small as pixels, neighbours part that go the same way. Other structures than
    /// [`AccelKind::Bvh`](crate::accel::AccelKind), and CPUs, have one kernel. The answer is filled as by
    /// [`trace`](RayCaster::trace).
    ///
    /// # Errors
    /// As for [`trace`](RayCaster::trace).
    pub fn tuned_to(&self, rays: &Buffer<Ray>, answer: &mut impl Answer) -> Result<Self, QueryError> {
        if !self.has_choice() {
            self.trace(rays, answer)?;
            return Ok(self.clone());
        }
        faster(|coherence| {
            let caster = self.expecting(coherence);
            // The first time the driver may have to load the kernel.
            caster.trace(rays, answer)?;
            Ok(caster.trace(rays, answer)?.min(caster.trace(rays, answer)?))
        })
        .map(|coherence| self.expecting(coherence))
    }

    /// The same for a slice: [`tuned_to`](Self::tuned_to) a sample of a large one, and by [`Coherence::of`] for others.
    pub(super) fn suited_to<A: Answer>(
        &self,
        rays: &[Ray],
        room: impl Fn(&Device, u32) -> Result<A, DeviceError>,
    ) -> Result<Self, QueryError> {
        if !self.has_choice() {
            return Ok(self.clone());
        }
        if rays.len() < LARGE {
            return Ok(self.expecting(Coherence::of(rays)));
        }
        let step = rays.len().div_ceil(RUN).div_ceil(TRACED);
        let sample: Vec<Ray> = rays.chunks(RUN).step_by(step).flatten().copied().collect();
        let mut answer = room(self.device(), sample.len() as u32)?;
        self.tuned_to(&self.device().upload(&sample)?, &mut answer)
    }
}

/// With which the seconds are fewer.
pub(super) fn faster(mut seconds: impl FnMut(Coherence) -> Result<f64, QueryError>) -> Result<Coherence, QueryError> {
    let (coherent, incoherent) = (seconds(Coherence::Coherent)?, seconds(Coherence::Incoherent)?);
    Ok(if coherent <= incoherent { Coherence::Coherent } else { Coherence::Incoherent })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    fn ray(i: usize) -> Ray {
        let sign = |bit: usize| if i >> bit & 1 != 0 { -1.0 } else { 1.0 };
        Ray::new(Vec3::ZERO, Vec3::new(sign(0), sign(1), sign(2)))
    }

    #[test]
    fn most_runs_decide() {
        let with = |coherent: usize| -> Vec<Ray> {
            (0..10 * RUN).map(|i| if i / RUN < coherent { ray(i / RUN) } else { ray(i) }).collect()
        };
        assert_eq!(Coherence::of(&with(5)), Coherence::Coherent);
        assert_eq!(Coherence::of(&with(4)), Coherence::Incoherent);
        assert_eq!(Coherence::of(&[]), Coherence::Coherent);
        assert_eq!(Coherence::of(&[ray(1)]), Coherence::Coherent);
        assert_eq!(Coherence::of(&[ray(1), ray(2)]), Coherence::Incoherent);
    }

    #[test]
    fn a_sample_is_spread_over_the_batch() {
        let half: Vec<Ray> = (0..100_000 * RUN).map(|i| ray(if i < 51_000 * RUN { 0 } else { i })).collect();
        assert_eq!(Coherence::of(&half), Coherence::Coherent);
        assert_eq!(Coherence::of(&half[2_000 * RUN..]), Coherence::Coherent);
        assert_eq!(Coherence::of(&half[3_000 * RUN..]), Coherence::Incoherent);
    }
}
