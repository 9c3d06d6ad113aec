//! Every structure finds what brute force finds, bit for bit.

use crate::common::{every_structure, ray, scene, Numbers, AIMS, FAMILIES};
use proptest::prelude::*;
use raywarp::accel::{Accel, AccelKind};
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::{Hit, Ray, MISS};
use raywarp_core::traversal::{NullStatistics, Occlusion, START};
use raywarp_core::triangle::Triangle;

/// The bits, so that equal means equal.
fn bits(hit: Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance]
}

/// The first hits along the ray, one after the other, and what a shadow ray meets, are those of brute force.
fn agree(structures: &[Accel], ray: &Ray) -> Result<(), String> {
    let mut previous = START;
    for _ in 0..4 {
        let truth = structures[0].closest(ray, &previous, &mut NullStatistics);
        for structure in &structures[1..] {
            let found = structure.closest(ray, &previous, &mut NullStatistics);
            if bits(found) != bits(truth) {
                return Err(format!("{}: {found:?}, not {truth:?}, along {ray:?}", structure.kind()));
            }
        }
        previous = truth;
        if truth.is_miss() {
            break;
        }
    }
    let truth = structures[0].occlusion(ray, &mut NullStatistics);
    match structures.iter().find(|structure| structure.occlusion(ray, &mut NullStatistics) != truth) {
        Some(structure) => Err(format!("{}: not {truth:?} along {ray:?}", structure.kind())),
        None => Ok(()),
    }
}

/// Builds, validates, and traces a few rays of every kind.
fn check(family: usize, count: usize, rays: usize, seed: u64) -> Result<(), String> {
    let mut numbers = Numbers(seed);
    let triangles = scene(family, count, &mut numbers);
    let structures = every_structure(&triangles);
    for structure in &structures {
        structure.validate().map_err(|flaw| format!("{}: {flaw}", structure.kind()))?;
    }
    if triangles.is_empty() {
        return Ok(());
    }
    (0..AIMS * rays).try_for_each(|i| agree(&structures, &ray(i % AIMS, &triangles, &mut numbers)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn structures_agree(family in 0..FAMILIES, count in 1usize..300, seed: u64) {
        check(family, count, 8, seed).map_err(TestCaseError::fail)?;
    }
}

#[test]
fn small_scenes_agree() {
    for count in 0..=20 {
        for family in 0..FAMILIES {
            for seed in 0..8 {
                check(family, count, 4, seed << 32 | (count * FAMILIES + family) as u64).unwrap();
            }
        }
    }
}

/// Found above: cells left a k-d tree's stack as if none overlapped, and one behind the hit ended the search.
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
        for structure in every_structure(&[triangle]) {
            for zero in [0.0, -0.0] {
                let ray = Ray::new(vec3(axis, 0.5, 5.0), vec3(zero, 0.0, -1.0));
                assert_eq!(
                    structure.closest(&ray, &START, &mut NullStatistics).t,
                    5.0,
                    "{} at {axis}",
                    structure.kind()
                );
            }
        }
    }
}

#[test]
fn an_empty_scene_is_missed_by_every_ray() {
    let structures = every_structure(&[]);
    let far = 1e30;
    for origin in [Vec3::ZERO, Vec3::splat(far), Vec3::splat(f32::INFINITY), Vec3::splat(f32::NAN)] {
        for direction in [Vec3::ONE, Vec3::ZERO, Vec3::splat(1e-40), Vec3::splat(f32::NAN)] {
            let ray = Ray::new(origin, direction);
            for structure in &structures {
                assert_eq!(structure.validate(), Ok(()));
                assert_eq!(structure.closest(&ray, &START, &mut NullStatistics).primitive, MISS);
                assert_eq!(structure.occlusion(&ray, &mut NullStatistics), Occlusion::Clear);
            }
        }
    }
}

/// Coordinates near the limits of single precision.
#[test]
fn extreme_scales_agree() {
    for (i, scale) in [1e-30f32, 1e-18, 1e18, 1e30].into_iter().enumerate() {
        let mut numbers = Numbers(i as u64);
        let unscaled = scene(1, 200, &mut numbers);
        let scaled = unscaled.iter().map(|t| {
            let scale = scale / t.extent().max(1e-20);
            Triangle::new(t.v0 * scale, t.v1 * scale, t.v2 * scale, t.primitive, 0)
        });
        let triangles = raywarp::accel::drop_degenerate(scaled.collect()).0;
        let structures = every_structure(&triangles);
        for structure in &structures {
            assert_eq!(structure.validate(), Ok(()), "{scale:e}");
        }
        for i in 0..1000 {
            agree(&structures, &ray([0, 1, 4, 6][i % 4], &triangles, &mut numbers)).unwrap();
        }
    }
}

/// What the loader would have dropped: slower at worst.
#[test]
fn triangles_that_cannot_be_hit_do_no_harm() {
    let mut numbers = Numbers(1);
    let mut triangles = scene(0, 40, &mut numbers);
    for (i, odd) in [f32::NAN, f32::INFINITY, -f32::INFINITY].into_iter().enumerate() {
        triangles[i * 2].v1.x = odd;
        triangles[i * 2 + 1].v0 = Vec3::splat(odd);
    }
    let structures = every_structure(&triangles);
    for _ in 0..1000 {
        let ray = ray(1, &triangles[10..], &mut numbers);
        agree(&structures, &ray).unwrap();
    }
}

#[test]
fn names_select_structures() {
    for kind in AccelKind::ALL {
        assert_eq!(Accel::build(kind, Vec::new()).unwrap().kind(), kind);
    }
}
