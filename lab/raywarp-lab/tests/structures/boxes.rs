//! The boxes of a structure: every level with the leaves above it holds all triangles, and lies within the level above.

use proptest::prelude::*;
use raywarp::accel::TreeBox;
use raywarp::Triangle;
use raywarp_lab::structures::{StructureKind, Tree};

use crate::common::{scene, Numbers, FAMILIES};
use crate::every_tree;

/// The boxes of a level and the leaves above it.
fn cover(boxes: &[TreeBox], level: u32) -> Vec<[[f64; 3]; 2]> {
    let chosen = boxes.iter().filter(|b| b.level == level || (b.is_leaf && b.level < level));
    chosen.map(|b| b.bounds.map(|corner| corner.map(f64::from))).collect()
}

fn contains([low, high]: &[[f64; 3]; 2], point: [f64; 3]) -> bool {
    (0..3).all(|i| low[i] <= point[i] && point[i] <= high[i])
}

/// Corners and other points of a triangle, the last of which is the middle.
fn points(triangle: &Triangle) -> impl Iterator<Item = [f64; 3]> + '_ {
    let weights = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.5, 0.5], [0.5, 0.0], [0.0, 0.5], [0.2, 0.7], [0.25, 0.25]];
    weights.into_iter().map(move |[u, v]: [f64; 2]| {
        let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(|v| v.to_array().map(f64::from));
        [0, 1, 2].map(|i| a[i] * (1.0 - u - v) + b[i] * u + c[i] * v)
    })
}

fn holds(cover: &[[[f64; 3]; 2]], triangle: &Triangle) -> bool {
    points(triangle).all(|point| cover.iter().any(|part| contains(part, point)))
}

/// Whether `part` is in `whole`, but for two steps of a grid of 256 planes, twice as coarse as need be.
fn within(whole: &TreeBox, part: &TreeBox, is_exact: bool) -> bool {
    let ([low, high], [a, b]) = (whole.bounds, part.bounds);
    (0..3).all(|i| {
        let slack = if is_exact { 0.0 } else { 4.0 * (f64::from(high[i]) - f64::from(low[i])) / 255.0 + 1e-37 };
        f64::from(a[i]) >= f64::from(low[i]) - slack && f64::from(b[i]) <= f64::from(high[i]) + slack
    })
}

fn check(structure: &Tree, triangles: &[Triangle]) -> Result<(), String> {
    let (boxes, kind) = (structure.boxes(u32::MAX), structure.kind());
    let fail = |what: &str, level: u32| Err(format!("{kind}: {what} at level {level}"));
    if triangles.is_empty() {
        return if boxes.is_empty() { Ok(()) } else { fail("boxes of nothing", 0) };
    }
    let is_exact = !matches!(kind, StructureKind::Bvh4 | StructureKind::Bvh8 | StructureKind::Bvh8w);
    let deepest = boxes.last().map_or(0, |b| b.level);
    for level in 0..=deepest {
        let down_to: Vec<TreeBox> = boxes.iter().copied().filter(|b| b.level <= level).collect();
        if structure.boxes(level) != down_to {
            return fail("other boxes than in the whole list", level);
        }
        let cover = cover(&boxes, level);
        if !triangles.iter().all(|triangle| holds(&cover, triangle)) {
            return fail("a triangle in no box", level);
        }
        let above: Vec<&TreeBox> = boxes.iter().filter(|b| b.level + 1 == level && !b.is_leaf).collect();
        let mut here = boxes.iter().filter(|b| b.level == level && level > 0);
        if !here.all(|part| above.iter().any(|whole| within(whole, part, is_exact))) {
            return fail("a box outside of those above it", level);
        }
    }
    let (stats, leaves) = (structure.stats(), boxes.iter().filter(|b| b.is_leaf).count());
    // A k-d tree may have cells without any room.
    let is_whole = leaves == stats.leaves && deepest as usize == stats.depth;
    if !is_whole && (kind != StructureKind::KD || leaves > stats.leaves || deepest as usize > stats.depth) {
        return fail("not as many leaves and levels as the statistics say", deepest);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn every_level_holds_all_triangles(family in 0..FAMILIES, count in 0usize..150, seed: u64) {
        let triangles = scene(family, count, &mut Numbers(seed));
        for structure in every_tree(&triangles) {
            check(&structure, &triangles).map_err(TestCaseError::fail)?;
        }
    }
}
