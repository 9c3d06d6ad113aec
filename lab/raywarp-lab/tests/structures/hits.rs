//! Every structure finds what brute force finds, bit for bit, on the host and on every device.

use proptest::prelude::*;
use raywarp::query::{opaque_triangles, RayKind, RaySource};
use raywarp::{Hit, Ray, Triangle};
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::traversal::{NullStatistics, Occlusion, START};
use raywarp_lab::structures::{StructureKind, Tree};

use crate::common::{ray, scene, Numbers, AIMS, FAMILIES};
use crate::{devices, every_tree, OWN};

/// The bits, so that equal means equal.
fn bits(hit: &Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance]
}

/// The first hits along the ray, one after the other, and what a shadow ray meets, are those of brute force.
fn agree(trees: &[Tree], ray: &Ray) -> Result<(), String> {
    let mut previous = START;
    for _ in 0..4 {
        let truth = trees[0].closest(ray, &previous, &mut NullStatistics);
        for tree in &trees[1..] {
            let found = tree.closest(ray, &previous, &mut NullStatistics);
            if bits(&found) != bits(&truth) {
                return Err(format!("{}: {found:?}, not {truth:?}, along {ray:?}", tree.kind()));
            }
        }
        previous = truth;
        if truth.is_miss() {
            break;
        }
    }
    let truth = trees[0].occlusion(ray, &mut NullStatistics);
    match trees.iter().find(|tree| tree.occlusion(ray, &mut NullStatistics) != truth) {
        Some(tree) => Err(format!("{}: not {truth:?} along {ray:?}", tree.kind())),
        None => Ok(()),
    }
}

/// Builds, validates, and traces a few rays of every kind.
fn check(family: usize, count: usize, rays: usize, seed: u64) -> Result<(), String> {
    let mut numbers = Numbers(seed);
    let triangles = scene(family, count, &mut numbers);
    let trees = every_tree(&triangles);
    for tree in &trees {
        tree.validate().map_err(|flaw| format!("{}: {flaw}", tree.kind()))?;
    }
    if triangles.is_empty() {
        return Ok(());
    }
    (0..AIMS * rays).try_for_each(|i| agree(&trees, &ray(i % AIMS, &triangles, &mut numbers)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn structures_agree(family in 0..FAMILIES, count in 1usize..300, seed: u64) {
        check(family, count, 8, seed).map_err(TestCaseError::fail)?;
    }
}

/// All sizes and families: long, so it runs where it is asked for.
#[test]
#[ignore = "minutes; part of the nightly tests"]
fn small_scenes_agree() {
    for count in 0..=20 {
        for family in 0..FAMILIES {
            for seed in 0..8 {
                check(family, count, 4, seed << 32 | (count * FAMILIES + family) as u64).unwrap();
            }
        }
    }
}

/// Found once: cells left a k-d tree's stack as if none overlapped, and one behind the hit ended the search.
#[test]
fn an_overlapping_cell_does_not_end_the_search() {
    check(7, 259, 8, 6_066_380_689_777_738_699).unwrap();
}

/// A box that ends at x = 0 and a ray with x = 0 throughout: the face is entered and left at `0 * inf`.
#[test]
fn rays_in_a_face_of_the_bounds_are_not_lost() {
    for axis in [0.0f32, 1.0, -1000.0] {
        let corners = [vec3(axis, -1.0, 0.0), vec3(axis, 1.0, 0.0), vec3(axis - 1.0, 0.0, 0.0)];
        let triangle = Triangle::new(corners[0], corners[1], corners[2], 0, 0);
        for tree in every_tree(&[triangle]) {
            for zero in [0.0, -0.0] {
                let ray = Ray::new(vec3(axis, 0.5, 5.0), vec3(zero, 0.0, -1.0));
                assert_eq!(tree.closest(&ray, &START, &mut NullStatistics).t, 5.0, "{} at {axis}", tree.kind());
            }
        }
    }
}

#[test]
fn an_empty_scene_is_missed_by_every_ray() {
    for tree in every_tree(&[]) {
        assert_eq!(tree.validate(), Ok(()));
        for origin in [Vec3::ZERO, Vec3::splat(1e30), Vec3::splat(f32::INFINITY), Vec3::splat(f32::NAN)] {
            let ray = Ray::new(origin, Vec3::ONE);
            assert!(tree.closest(&ray, &START, &mut NullStatistics).is_miss(), "{}", tree.kind());
            assert_eq!(tree.occlusion(&ray, &mut NullStatistics), Occlusion::Clear, "{}", tree.kind());
        }
    }
}

/// Closest hits, shadows, all hits and counts, in batches: by each device as by brute force there.
#[test]
fn batches_are_answered_as_by_brute_force() {
    let scene = raywarp::scene::load::builtin().unwrap().scene;
    let triangles = opaque_triangles(&scene).unwrap();
    let source = RaySource::new(&triangles, &scene.cameras[0], [61, 37]).unwrap();
    let mut rays = source.primary().rays;
    rays.extend(source.workload(RayKind::Random, &[], 3000).rays);
    for device in devices() {
        let caster = |kind: StructureKind| Tree::build(kind, triangles.clone()).unwrap().caster(&device).unwrap();
        let brute = caster(StructureKind::BRUTE);
        let (hits, any, counts) = (brute.hits(&rays).unwrap(), brute.any(&rays).unwrap(), brute.count(&rays).unwrap());
        let all = brute.all(&rays).unwrap();
        assert!(hits.iter().filter(|hit| !hit.is_miss()).count() > rays.len() / 10);
        for kind in OWN {
            let (caster, where_) = (caster(kind), device.description());
            let found = caster.hits(&rays).unwrap();
            assert!(found.iter().map(bits).eq(hits.iter().map(bits)), "{kind} on {where_}");
            assert_eq!(caster.any(&rays).unwrap(), any, "{kind} on {where_}");
            assert_eq!(caster.count(&rays).unwrap(), counts, "{kind} on {where_}");
            let every = caster.all(&rays).unwrap();
            assert_eq!((every.offsets, every.hits.t), (all.offsets.clone(), all.hits.t.clone()), "{kind} on {where_}");
        }
    }
}
