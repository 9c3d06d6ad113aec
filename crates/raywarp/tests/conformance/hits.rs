//! Closest hits and shadows of batches of rays.

use raywarp::accel::AccelKind;
use raywarp::query::RayCaster;
use raywarp::{Hit, Ray, Triangle, Vec3};

use super::{device, kinds, reference, scaled, scene, triangles, Random};

/// Rays of every sort: through the scene, axis-parallel, from surfaces, with limits, without a meaning.
pub fn rays(triangles: &[Triangle], count: usize, random: &mut Random) -> Vec<Ray> {
    let corner = |random: &mut Random| triangles[random.bits() as usize % triangles.len()].v0;
    (0..count)
        .map(|index| {
            let target = corner(random) + random.vector() * 0.05;
            let origin = if index % 4 == 0 { corner(random) } else { target + random.vector() * 4.0 };
            let mut ray = Ray::new(origin, target - origin);
            match index % 16 {
                1 => ray.direction = Vec3::new(0.0, -1.0, 0.0),
                2 => ray.direction = Vec3::new(0.0, ray.direction.y, ray.direction.z),
                3 => ray.t_max = 1.0,
                5 => ray.t_min = 0.9,
                6 if index % 64 == 6 => ray.direction = Vec3::ZERO,
                6 if index % 64 == 22 => ray.origin.x = f32::NAN,
                6 if index % 64 == 38 => ray.direction.z = f32::INFINITY,
                6 if index % 128 == 54 => ray.t_min = f32::NAN,
                6 => ray.t_max = f32::NAN,
                _ => {}
            }
            ray
        })
        .collect()
}

pub fn soup(random: &mut Random) -> Vec<Triangle> {
    let triangle = |id| {
        let centre = random.vector() * 2.0;
        let [a, b, c] = [(); 3].map(|()| centre + random.vector() * 0.2);
        Triangle::new(a, b, c, id, 0)
    };
    (0..3000).map(triangle).collect()
}

fn bits(hit: &Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive, hit.instance]
}

/// Every structure on the device under test against brute force on the CPU: the same bits for all of `count` rays.
fn check(name: &str, triangles: &[Triangle], count: usize) {
    let count = scaled(count);
    let rays = rays(triangles, count, &mut Random(7));
    let oracle = RayCaster::new(triangles.to_vec(), AccelKind::Brute, &reference()).unwrap();
    let expected = oracle.hits(&rays).unwrap();
    assert!(expected.iter().filter(|hit| !hit.is_miss()).count() > count / 3, "{name}: the rays hit something");
    let occluded = oracle.any(&rays).unwrap();
    for kind in kinds() {
        let caster = RayCaster::new(triangles.to_vec(), kind, &device()).unwrap();
        let hits = caster.hits(&rays).unwrap();
        let differing = expected.iter().zip(&hits).filter(|(a, b)| bits(a) != bits(b)).count();
        assert_eq!(differing, 0, "{name}, {kind}: of {count} hits");
        println!("{name}, {kind}: {count} rays, all the same");
        assert_eq!(caster.any(&rays).unwrap(), occluded, "{name}, {kind}: shadows");
    }
}

#[test]
fn random_triangles() {
    check("soup", &soup(&mut Random(1)), 200_000);
}

#[test]
fn a_mesh() {
    check("suzanne", &triangles(&scene("built-in")), 40_000);
}

#[test]
fn large_axis_aligned_triangles() {
    let mut walls = triangles(&scene("cornell/cornell_box.obj"));
    for wall in &mut walls {
        let scale = |v: Vec3| v * 0.01;
        *wall = Triangle::new(scale(wall.v0), scale(wall.v1), scale(wall.v2), wall.primitive, 0);
    }
    check("cornell", &walls, 400_000);
}

#[test]
fn no_triangles_and_no_rays() {
    for kind in kinds() {
        let empty = RayCaster::new(Vec::new(), kind, &device()).unwrap();
        let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 1.0));
        assert!(empty.hits(&[ray]).unwrap()[0].is_miss(), "{kind}");
        assert_eq!(empty.any(&[ray]).unwrap(), [false], "{kind}");
        assert!(empty.hits(&[]).unwrap().is_empty(), "{kind}");
    }
}

/// A structure that a device has no kernels for is refused before it is built, with a sentence.
#[test]
fn a_structure_for_cpus_is_refused_on_a_gpu() {
    let refused =
        RayCaster::new(soup(&mut Random(1)), AccelKind::Bvh8f, &device()).err().map(|error| error.to_string());
    assert_eq!(refused.is_some(), device().is_cuda(), "{refused:?}");
    assert!(refused.is_none_or(|sentence| sentence.starts_with("the structure bvh8f is laid out for CPUs")));
}

/// The device and the CPU with the same structure take the same steps: every bit is the same, ties included.
#[test]
fn two_machines_give_the_same_bits() {
    let triangles = triangles(&scene("built-in"));
    let rays = rays(&triangles, scaled(1_000_000), &mut Random(3));
    for kind in [AccelKind::Kd, AccelKind::Bvh] {
        let [a, b] = [reference(), device()]
            .map(|device| RayCaster::new(triangles.clone(), kind, &device).unwrap().hits(&rays).unwrap());
        let differing = a.iter().zip(&b).filter(|(a, b)| bits(a) != bits(b)).count();
        assert_eq!(differing, 0, "{kind}: of {} hits", rays.len());
    }
}
