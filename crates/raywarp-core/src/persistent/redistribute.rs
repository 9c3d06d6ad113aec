//! The triangles of a warp's leaves, one a lane.
//!
//! Leaves are of unequal length, and some lanes have none: with a lane a ray, most would wait while the longest leaf is
//! tested. So the triangles are dealt out. A lane then tests another one's ray, which it finds in memory that the warp
//! shares, and whoever's ray it is collects the hits.

use super::{from, vote};
use crate::arch::{self, WARP};
use crate::traversal::bvh2::{Child, MAX_LEAF};

/// What of the leaves that the lanes of a warp have is tested now: as many triangles as there are lanes.
pub(super) struct LeafRedistribution {
    /// Which lane has this lane's first triangle, and how many are tested.
    first: u32,
    taken: u32,
    /// What this lane tests: the ray of that lane, with that triangle. Nothing for lanes beyond the last triangle.
    pub test: Option<(u32, u32)>,
}

/// Bits of the number of a leaf's triangles.
const BITS: u32 = u32::BITS - MAX_LEAF.leading_zeros();

impl LeafRedistribution {
    /// Of the leaf that each lane has, or of none. All threads of the warp are here.
    #[inline(always)]
    pub fn new(leaf: Option<Child>) -> Self {
        let count = leaf.map_or(0, Child::count);
        // Triangles of the lanes before this one, and of all.
        let (mut first, mut all) = (0, 0);
        for bit in 0..BITS {
            let lanes = vote(count >> bit & 1 != 0);
            first += (lanes & arch::lanes_below()).count_ones() << bit;
            all += lanes.count_ones() << bit;
        }
        // The last lane that begins at or before this one.
        let (mut owner, mut step) = (0, WARP / 2);
        while step > 0 {
            let lane = owner + step;
            owner = if from(first, lane) <= arch::lane() { lane } else { owner };
            step /= 2;
        }
        let begin = leaf.map_or(0, Child::index).wrapping_sub(first);
        let triangle = from(begin, owner).wrapping_add(arch::lane());
        let test = (arch::lane() < all).then_some((owner, triangle));
        Self { first, taken: count.min(WARP.saturating_sub(first)), test }
    }

    /// Gives `collect` what the lanes found on this lane's ray: distances, and which triangle of its leaf each belongs to.
    /// `found` is infinite for nothing. All threads of the warp are here.
    #[inline(always)]
    pub fn collect(&self, found: f32, mut collect: impl FnMut(f32, u32)) {
        let hits = vote(found < f32::INFINITY);
        let mut mine = if self.taken > 0 { hits >> self.first & ((1 << self.taken) - 1) } else { 0 };
        while vote(mine != 0) != 0 {
            let nth = mine.trailing_zeros();
            let t = f32::from_bits(from(found.to_bits(), self.first + nth));
            if mine != 0 {
                mine &= mine - 1;
                collect(t, nth);
            }
        }
    }

    /// What is left of this lane's leaf.
    #[inline(always)]
    pub fn rest(&self, leaf: Child) -> Option<Child> {
        let left = leaf.count() - self.taken;
        (left > 0).then(|| Child::leaf(leaf.index() + self.taken, left))
    }
}
