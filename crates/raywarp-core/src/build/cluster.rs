//! Clusters of triangles in the lanes of a warp, and their merging: each looks for the neighbour with which it would have the
//! smallest box, and two that choose each other become one (Meister and Bittner 2018).

use super::bounds::{greater, half_area, lesser, Bounds};
use super::node::{Below, Link};
use crate::arch::{lanes_where, Lanes, Shuffle, LANES};
use crate::math::{vec3, Vec3};

/// How many places away a cluster looks for its neighbour.
const RADIUS: u32 = 8;

/// A subtree that has no parent yet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cluster {
    pub bounds: Bounds,
    pub below: Below,
    pub link: Link,
    /// The number that it gives to the node in which it ends as the right one of two: no other cluster has it.
    pub leader: u32,
}

impl Shuffle for Cluster {
    #[inline(always)]
    fn of_lane(self, lane: u32) -> Self {
        let vector = |v: Vec3| vec3(v.x.of_lane(lane), v.y.of_lane(lane), v.z.of_lane(lane));
        let below = Below {
            cost: self.below.cost.of_lane(lane),
            sah: self.below.sah.of_lane(lane),
            count: self.below.count.of_lane(lane),
            nodes: self.below.nodes.of_lane(lane),
            shape: self.below.shape.of_lane(lane),
        };
        Self {
            bounds: Bounds { low: vector(self.bounds.low), high: vector(self.bounds.high) },
            below,
            link: Link::of_bits(self.link.bits().of_lane(lane)),
            leader: self.leader.of_lane(lane),
        }
    }
}

/// Clusters side by side, one a lane from the first lane on.
#[derive(Clone, Copy)]
pub(super) struct Clusters {
    pub lanes: Lanes<Cluster>,
    pub count: u32,
}

/// Greater than what [`key`] gives.
const NONE: u32 = u32::MAX;

/// By what a pair of lanes is chosen: the area of its box, whose last bits make way for what tells the two lanes from each
/// other. Of pairs with the same area those at even places come first, so that equal boxes are merged two by two.
#[inline(always)]
fn key(area: f32, lane: u32, other: u32) -> u32 {
    (area.to_bits() & !(LANES - 1)) | (lane ^ other)
}

impl Clusters {
    /// Merges every two that choose each other. `merge` makes one of two, the left one first.
    ///
    /// There is such a pair, for a pair has the same key from both sides and the least of all keys is chosen from both.
    #[inline(always)]
    pub fn round(&self, mut merge: impl FnMut(&Cluster, &Cluster) -> Cluster) -> Self {
        let (own, nearest) = (&self.lanes, self.nearest());
        let partner = Lanes::<u32>::each(|lane| lane ^ (nearest.of(lane) % LANES));
        let answer = Lanes::<u32>::each(|lane| nearest.from(partner.of(lane)));
        let is_pair = |lane| nearest.of(lane) != NONE && answer.of(lane) == nearest.of(lane);
        let others = Lanes::each(|lane| own.from(partner.of(lane)));
        let merged = Lanes::each(|lane| {
            if is_pair(lane) && lane < partner.of(lane) {
                merge(&own.of(lane), &others.of(lane))
            } else {
                own.of(lane)
            }
        });
        let stay = lanes_where(|lane| lane < self.count && !(is_pair(lane) && lane > partner.of(lane)));
        Self { lanes: compacted(&merged, stay), count: stay.count_ones() }
    }

    /// The key of the best pair that each cluster could be in.
    #[inline(always)]
    fn nearest(&self) -> Lanes<u32> {
        let own = Sides::of(&self.lanes);
        let mut best = Lanes::<u32>::each(|_| NONE);
        let mut by = 1;
        while by <= RADIUS {
            let other = own.later(by);
            let forwards = Lanes::<u32>::each(|lane| {
                let key = key(own.area_with(&other, lane), lane, lane + by);
                if lane + by < self.count {
                    key
                } else {
                    NONE
                }
            });
            let backwards = forwards.earlier(by);
            best = Lanes::<u32>::each(|lane| {
                let back = if lane >= by { backwards.of(lane) } else { NONE };
                best.of(lane).min(forwards.of(lane)).min(back)
            });
            by += 1;
        }
        best
    }
}

/// The sides of boxes, each in lanes of its own: so a CPU has several in a register.
struct Sides {
    low: [Lanes<f32>; 3],
    high: [Lanes<f32>; 3],
}

impl Sides {
    #[inline(always)]
    fn of(clusters: &Lanes<Cluster>) -> Self {
        let low = |axis| Lanes::<f32>::each(|lane| clusters.of(lane).bounds.low[axis]);
        let high = |axis| Lanes::<f32>::each(|lane| clusters.of(lane).bounds.high[axis]);
        Self { low: [low(0), low(1), low(2)], high: [high(0), high(1), high(2)] }
    }

    #[inline(always)]
    fn later(&self, by: u32) -> Self {
        let ([a, b, c], [d, e, f]) = (&self.low, &self.high);
        Self { low: [a.later(by), b.later(by), c.later(by)], high: [d.later(by), e.later(by), f.later(by)] }
    }

    /// Half the area around a lane's box and the other one there.
    #[inline(always)]
    fn area_with(&self, other: &Self, lane: u32) -> f32 {
        let side = |axis: usize| {
            greater(self.high[axis].of(lane), other.high[axis].of(lane))
                - lesser(self.low[axis].of(lane), other.low[axis].of(lane))
        };
        half_area(side(0), side(1), side(2))
    }
}

/// The clusters of the lanes that stay, side by side.
#[inline(always)]
fn compacted(clusters: &Lanes<Cluster>, stay: u32) -> Lanes<Cluster> {
    Lanes::each(|lane| clusters.from(nth_bit(stay, lane)))
}

/// Which bit of a word is the one that has so many others below it; any, where there are not as many.
#[inline(always)]
pub(super) fn nth_bit(word: u32, n: u32) -> u32 {
    let (mut bit, mut step) = (0, LANES / 2);
    while step > 0 {
        let below = word & ((1 << (bit + step)) - 1);
        bit += if below.count_ones() <= n { step } else { 0 };
        step /= 2;
    }
    bit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, lane: u32) -> Cluster {
        let bounds = Bounds { low: vec3(x, 0.0, 0.0), high: vec3(x + 1.0, 1.0, 1.0) };
        let below = Below::triangle(bounds.half_area());
        Cluster { bounds, below, link: Link::leaf(lane), leader: lane }
    }

    /// Which lanes were merged in a round, and how many clusters are left.
    fn pairs(positions: &[f32]) -> (Vec<[u32; 2]>, u32) {
        let lanes = Lanes::each(|lane| positions.get(lane as usize).map_or(Cluster::default(), |&x| at(x, lane)));
        let mut pairs = Vec::new();
        let after = Clusters { lanes, count: positions.len() as u32 }.round(|a, b| {
            pairs.push([a.leader, b.leader]);
            Cluster { bounds: a.bounds.join(&b.bounds), ..*a }
        });
        (pairs, after.count)
    }

    #[test]
    fn bits_are_found_by_their_number() {
        let word: u32 = 0b1000_0101_0000_0000_0000_0001_0001_0010;
        let bits: Vec<u32> = (0..word.count_ones()).map(|n| nth_bit(word, n)).collect();
        assert_eq!(bits, [1, 4, 8, 24, 26, 31]);
    }

    #[test]
    fn neighbours_that_choose_each_other_are_merged() {
        assert_eq!(pairs(&[0.0, 5.0, 5.5, 9.0, 20.0]), (vec![[1, 2]], 4));
        assert_eq!(pairs(&[0.0, 0.5, 5.0, 5.5, 9.0]), (vec![[0, 1], [2, 3]], 3));
        assert_eq!(pairs(&[0.0]), (vec![], 1));
    }

    #[test]
    fn equal_boxes_are_merged_two_by_two() {
        let (pairs, left) = pairs(&[1.0; 32]);
        assert_eq!((pairs.len(), left), (16, 16));
        assert!(pairs.iter().all(|&[a, b]| a % 2 == 0 && b == a + 1));
    }

    #[test]
    fn what_is_too_far_away_is_not_looked_at() {
        // Both ends coincide, but eleven places apart.
        let mut positions: Vec<f32> = (0..12).map(|i| (i * i) as f32 * 10.0 + 100.0).collect();
        positions[11] = positions[0];
        assert!(!pairs(&positions).0.contains(&[0, 11]));
    }
}
