//! The boxes of a structure: every level with the leaves above it holds all triangles, and lies within the level above.

use crate::common::{devices, every_structure, kinds_on, scene, Numbers, FAMILIES};
use proptest::prelude::*;
use raywarp::accel::{Accel, AccelKind, Build, Quality, TreeBox, MAX_BOXES};
use raywarp::device_scene::world_triangles;
use raywarp::scene::load;
use raywarp::DeviceScene;
use raywarp::Triangle;

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

/// Whether `part` is in `whole`.
fn within(whole: &TreeBox, part: &TreeBox) -> bool {
    let ([low, high], [a, b]) = (whole.bounds, part.bounds);
    (0..3).all(|i| a[i] >= low[i] && b[i] <= high[i])
}

fn check(structure: &Accel, triangles: &[Triangle]) -> Result<(), String> {
    let (boxes, kind) = (structure.boxes(u32::MAX), structure.kind());
    let fail = |what: &str, level: u32| Err(format!("{kind}: {what} at level {level}"));
    if triangles.is_empty() {
        return if boxes.is_empty() { Ok(()) } else { fail("boxes of nothing", 0) };
    }
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
        if !here.all(|part| above.iter().any(|whole| within(whole, part))) {
            return fail("a box outside of those above it", level);
        }
    }
    let (stats, leaves) = (structure.stats(), boxes.iter().filter(|b| b.is_leaf).count());
    // A k-d tree may have cells without any room.
    let is_whole = leaves == stats.leaves && deepest as usize == stats.depth;
    if !is_whole && (kind != AccelKind::Kd || leaves > stats.leaves || deepest as usize > stats.depth) {
        return fail("not as many leaves and levels as the statistics say", deepest);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn every_level_holds_all_triangles(family in 0..FAMILIES, count in 0usize..150, seed: u64) {
        let triangles = scene(family, count, &mut Numbers(seed));
        for structure in every_structure(&triangles) {
            check(&structure, &triangles).map_err(TestCaseError::fail)?;
        }
    }
}

#[test]
fn of_a_large_structure_whole_levels_are_left_out() {
    let triangles = scene(1, 60_000, &mut Numbers(7));
    for kind in AccelKind::ALL {
        let structure = Accel::build(kind, triangles.clone()).unwrap();
        let boxes = structure.boxes(64);
        assert!(boxes.len() <= MAX_BOXES);
        let deepest = boxes.last().unwrap().level;
        // A list has one box.
        let list = kind == AccelKind::Brute;
        assert!(list || (deepest as usize) < structure.stats().depth);
        assert!(list || boxes.len() > MAX_BOXES / 16, "{kind}: {}", boxes.len());
        let cover = cover(&boxes, deepest);
        assert!(triangles.iter().step_by(997).all(|triangle| holds(&cover, triangle)), "{kind}");
    }
}

#[test]
fn a_tracer_tells_the_boxes_that_were_built() {
    let scene = load::builtin().unwrap().scene;
    for device in devices() {
        for kind in kinds_on(&device) {
            let what = Build { kind, quality: Quality::Fast, cached: false };
            let on_device = DeviceScene::new(&scene, what, &device).unwrap();
            let triangles = world_triangles(&scene, &scene.instances, &scene.materials).unwrap();
            let built = Accel::build(what, triangles).unwrap();
            for level in [0, 1, 5, 64] {
                assert_eq!(
                    on_device.structure().boxes(level).unwrap(),
                    built.boxes(level),
                    "{kind} on {}",
                    device.description()
                );
            }
        }
    }
}

#[test]
fn boxes_go_with_what_has_moved() {
    let scene = load::builtin().unwrap().scene;
    for device in devices() {
        let what = Build { kind: AccelKind::Bvh2, quality: Quality::Fast, cached: false };
        let mut on_device = DeviceScene::new(&scene, what, &device).unwrap();
        let mut moved = scene.instances.clone();
        moved[1].transform.translation = [3.0, 40.0, -2.0];
        let triangles = world_triangles(&scene, &moved, &scene.materials).unwrap();
        let all_are_held = |on_device: &DeviceScene, level| {
            let cover = cover(&on_device.structure().boxes(level).unwrap(), level);
            triangles.iter().all(|triangle| holds(&cover, triangle))
        };
        assert!(!all_are_held(&on_device, 0));
        assert!(on_device.move_instances(&scene, &moved, &[1]).unwrap());
        assert!((0..6).all(|level| all_are_held(&on_device, level)), "{}", device.description());
        on_device.move_instances(&scene, &scene.instances, &[1]).unwrap();
        assert!(!all_are_held(&on_device, 0));
    }
}
