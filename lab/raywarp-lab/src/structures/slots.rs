//! Which slot of a node a child goes to, so that rays meet near children first (Ylitie, Karras and Laine 2017, section 3.3).
//!
//! Rays from octant `o` (bit `i` set: the direction is negative on axis `i`) visit slot `o` first and slot `7 - o` last. So
//! the children are assigned to slots with the least sum of how far each lies along its slot's diagonal.

use raywarp::accel::bounds::Bounds;

/// The best assignment of at most eight children, exactly: dynamic programming over the sets of slots taken.
pub(super) fn by_octant(parent: &Bounds, children: &[Bounds]) -> [Option<usize>; 8] {
    let costs: Vec<[f64; 8]> = children.iter().map(|child| along_diagonals(parent, child)).collect();
    // By set of slots: the least cost of the first children in it, and the slot of the last one.
    let mut best = [(f64::INFINITY, 0); 256];
    best[0] = (0.0, 0);
    for taken in 0..256usize {
        let Some(costs) = costs.get(taken.count_ones() as usize) else { continue };
        for slot in (0..8).filter(|slot| taken >> slot & 1 == 0) {
            let cost = best[taken].0 + costs[slot];
            let next = &mut best[taken | 1 << slot];
            if cost < next.0 {
                *next = (cost, slot);
            }
        }
    }
    let full = (0..256usize).filter(|taken| taken.count_ones() as usize == children.len());
    let mut taken = full.min_by(|&a, &b| best[a].0.total_cmp(&best[b].0)).unwrap_or(0);
    let mut slots = [None; 8];
    for child in (0..children.len()).rev() {
        let slot = best[taken].1;
        slots[slot] = Some(child);
        taken &= !(1 << slot);
    }
    slots
}

/// How far the centre of a child lies from its parent's, along the diagonal of each octant.
fn along_diagonals(parent: &Bounds, child: &Bounds) -> [f64; 8] {
    let (from, to) = (parent.centre(), child.centre());
    let offset = [0, 1, 2].map(|i| f64::from(to[i]) - f64::from(from[i]));
    std::array::from_fn(|octant| (0..3).map(|i| if octant >> i & 1 == 1 { -offset[i] } else { offset[i] }).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, y: f32, z: f32) -> Bounds {
        let centre = [x, y, z];
        Bounds { low: centre.map(|x| x - 0.5), high: centre.map(|x| x + 0.5) }
    }

    #[test]
    fn corners_go_to_the_octants_that_see_them_first() {
        let corner = |i: usize| at((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let parent = Bounds { low: [-0.5; 3], high: [1.5; 3] };
        // A ray to the left comes from the right.
        assert_eq!(by_octant(&parent, &[0, 1, 2, 3, 4, 5, 6, 7].map(corner)), [0, 1, 2, 3, 4, 5, 6, 7].map(Some));
        assert_eq!(by_octant(&parent, &[7, 6, 5, 4, 3, 2, 1, 0].map(corner)), [7, 6, 5, 4, 3, 2, 1, 0].map(Some));
    }

    #[test]
    fn every_child_has_one_slot() {
        for count in 0..=8 {
            let children: Vec<Bounds> = (0..count).map(|i| at(i as f32 * 0.3, 1e30, -(i as f32))).collect();
            let slots = by_octant(&Bounds { low: [-f32::MAX; 3], high: [f32::MAX; 3] }, &children);
            let mut placed: Vec<usize> = slots.into_iter().flatten().collect();
            placed.sort();
            assert!(placed.into_iter().eq(0..count));
        }
    }
}
