//! Whether neighbours in a batch go the same way.

use rayon::prelude::*;
use raywarp_kernels::traverse::octants::octant;

use crate::Ray;

/// How the rays of a batch lie to each other: which of two kernels answers it on a GPU, over a tree in two layouts
/// ([`AccelKind::Bvh`](crate::accel::AccelKind)). The answers are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coherence {
    /// Most neighbours go the same way, as camera rays in tiles of pixels do: a ray a thread.
    Coherent,
    /// They do not, as after a diffuse bounce: threads are [pooled](raywarp_kernels::pool).
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
