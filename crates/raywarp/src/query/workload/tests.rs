use super::*;
use crate::accel::AccelKind;
use crate::device::{Device, DeviceChoice};
use crate::query::RayCaster;
use crate::scene::Projection;

/// A floor of 4 x 4 at height 0, and nothing else.
fn floor() -> Vec<Triangle> {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let [a, b, c, d] = [corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)];
    vec![Triangle::new(a, b, c, 0, 0), Triangle::new(a, c, d, 1, 0)]
}

fn above() -> Camera {
    Camera {
        name: "above".into(),
        eye: [0.0, 3.0, 0.5],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        projection: Projection::Perspective { fov_y: 1.5 },
    }
}

fn spots(source: &RaySource) -> Vec<Spot> {
    let device = Device::open(DeviceChoice::Cpu).unwrap();
    let caster = RayCaster::new(source.triangles.to_vec(), AccelKind::Bvh, &device).unwrap();
    let rays = source.primary().rays;
    source.spots(&rays, &caster.hits(&rays).unwrap())
}

#[test]
fn primary_rays_come_in_tiles_and_every_pixel_has_one() {
    let order: Vec<_> = tiled([16, 8]).collect();
    assert_eq!(order[..9], [[0, 0], [1, 0], [2, 0], [3, 0], [4, 0], [5, 0], [6, 0], [7, 0], [0, 1]]);
    assert_eq!((order[31], order[32], order[64]), ([7, 3], [8, 0], [0, 4]));
    for size in [[1, 1], [8, 4], [13, 7], [64, 36]] {
        let mut pixels: Vec<_> = tiled(size).collect();
        assert_eq!(pixels.len(), (size[0] * size[1]) as usize);
        pixels.sort();
        pixels.dedup();
        assert_eq!(pixels.len(), (size[0] * size[1]) as usize, "{size:?}");
    }
}

#[test]
fn a_primary_ray_goes_through_the_middle_of_its_pixel() {
    let (triangles, camera) = (floor(), above());
    let source = RaySource::new(&triangles, &camera, [15, 9]).unwrap();
    let rays = source.primary().rays;
    let middle = tiled([15, 9]).position(|pixel| pixel == [7, 4]).unwrap();
    let forward = (Vec3::from(camera.target) - camera.eye.into()).normalize();
    assert!((rays[middle].direction - forward).length() < 1e-6);
    assert_eq!(rays[middle].origin.to_array(), camera.eye);
}

#[test]
fn spots_leave_out_misses_and_face_the_ray() {
    let triangles = floor();
    let mut camera = above();
    for (eye, up) in [(3.0, 1.0), (-3.0, -1.0)] {
        camera.eye[1] = eye;
        let source = RaySource::new(&triangles, &camera, [64, 36]).unwrap();
        let spots = spots(&source);
        assert!(spots.len() > 500 && spots.len() < 64 * 36, "{}", spots.len());
        let offset = 1e-5 * source.diagonal();
        for spot in spots {
            assert_eq!(spot.normal.to_array(), [0.0, up, 0.0]);
            assert!((spot.origin.y - up * offset).abs() < 1e-6, "{spot:?}");
        }
    }
}

#[test]
fn triangles_without_a_normal_have_no_spot() {
    let nan = Triangle::new(Vec3::splat(f32::NAN), Vec3::ZERO, Vec3::ONE, 0, 0);
    let line = Triangle::new(Vec3::ZERO, Vec3::ONE, Vec3::ONE * 2.0, 1, 0);
    let triangles = [nan, line];
    let source = RaySource::new(&triangles, &above(), [8, 8]).unwrap();
    let ray = Ray::new(Vec3::ZERO, Vec3::ONE);
    let hit = |primitive| Hit { t: 1.0, primitive, ..Hit::NONE };
    assert!(source.spots(&[ray; 4], &[hit(0), hit(1), hit(2), Hit::NONE]).is_empty());
    // Too small for the product of its edges in single precision.
    let tiny = [Vec3::ZERO, Vec3::new(1e-30, 0.0, 0.0), Vec3::new(0.0, 1e-30, 0.0)];
    assert_eq!(normal(&Triangle::new(tiny[0], tiny[1], tiny[2], 0, 0)), Some(Vec3::new(0.0, 0.0, 1.0)));
}

#[test]
fn shadow_rays_end_at_the_light() {
    let triangles = floor();
    let source = RaySource::new(&triangles, &above(), [64, 36]).unwrap();
    let light = source.light();
    // Right of the camera is +X; up leans away from it.
    assert!((light.x - 0.5).abs() < 1e-6 && light.y > 3.0 && light.z < 0.5);
    let from_eye = (light - above().eye.into()).length();
    assert!((from_eye - (0.5f32 * 0.5 + 0.4 * 0.4).sqrt()).abs() < 1e-5);
    for ray in source.workload(RayKind::Shadow, &spots(&source), 0).rays {
        assert!((ray.at(ray.t_max) - light).length() < 1e-5 && (ray.direction.length() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn there_are_as_many_rays_as_asked_for_and_one_a_spot_at_least() {
    let triangles = floor();
    let source = RaySource::new(&triangles, &above(), [16, 9]).unwrap();
    let spots = spots(&source);
    for kind in [RayKind::Shadow, RayKind::Ao, RayKind::Diffuse] {
        assert_eq!(source.workload(kind, &spots, 7).rays.len(), spots.len());
        let many = source.workload(kind, &spots, 1000);
        assert_eq!((many.kind, many.rays.len()), (kind, 1000));
        assert_eq!(many.rays[spots.len()].origin, spots[0].origin);
        assert_eq!(many, source.workload(kind, &spots, 1000), "the same each time");
        assert!(source.workload(kind, &[], 1000).rays.is_empty());
    }
    let [ao, diffuse] = [RayKind::Ao, RayKind::Diffuse].map(|kind| source.workload(kind, &spots, 1000).rays);
    for (ao, diffuse) in ao.iter().zip(&diffuse) {
        assert_eq!((ao.origin, ao.direction), (diffuse.origin, diffuse.direction));
        assert_eq!((ao.t_max, diffuse.t_max), (0.1 * source.diagonal(), f32::INFINITY));
    }
    // The second round has directions of its own.
    assert_ne!(diffuse[0].direction, diffuse[spots.len()].direction);
}

#[test]
fn bounces_are_cosine_weighted() {
    const COUNT: usize = 100_000;
    for normal in [Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.48, -0.6, 0.64), Vec3::new(0.0, 0.0, -1.0)] {
        // The square of the cosine is even over [0, 1]: equal counts in equal bins.
        let mut bins = [0.0f64; 20];
        let mut mean = Vec3::ZERO;
        for key in 0..COUNT as u32 {
            let direction = cosine(normal, combine(key, 5));
            let cosine = direction.dot(normal);
            assert!((direction.length() - 1.0).abs() < 1e-5 && cosine >= 0.0);
            bins[((cosine * cosine * 20.0) as usize).min(19)] += 1.0;
            mean += direction * (1.0 / COUNT as f32);
        }
        let expected = COUNT as f64 / 20.0;
        let chi_square: f64 = bins.iter().map(|count| (count - expected).powi(2) / expected).sum();
        // 43.8 is exceeded once in a thousand with 19 degrees of freedom.
        assert!(chi_square < 43.8, "{normal:?}: {chi_square} {bins:?}");
        // Nothing prefers a side: the mean is 2/3 along the normal.
        assert!((mean - normal * (2.0 / 3.0)).length() < 0.01, "{mean:?}");
    }
}

#[test]
fn random_rays_fill_the_bounds_and_the_sphere() {
    const COUNT: usize = 100_000;
    let mut triangles = floor();
    triangles.push(Triangle::new(Vec3::new(0.0, 5.0, 0.0), Vec3::ONE, Vec3::new(-1.0, 1.0, 0.0), 2, 0));
    let source = RaySource::new(&triangles, &above(), [8, 8]).unwrap();
    let Workload { kind, rays } = source.random(COUNT);
    assert_eq!((kind, rays.len()), (RayKind::Random, COUNT));
    let mut dual = [0.0f64; 64];
    for ray in &rays {
        let place = (ray.origin - Vec3::new(-2.0, 0.0, -2.0)) * Vec3::new(0.25, 0.2, 0.25);
        let inside = place.to_array().iter().all(|x| (0.0..=1.0).contains(x));
        assert!(inside && (ray.direction.length() - 1.0).abs() < 1e-5, "{ray:?}");
        let halves = [place - Vec3::splat(0.5), ray.direction].map(|v| v.to_array().map(|x| (x >= 0.0) as usize));
        dual[halves.as_flattened().iter().fold(0, |index, half| 2 * index + half)] += 1.0;
    }
    let expected = COUNT as f64 / 64.0;
    let chi_square: f64 = dual.iter().map(|count| (count - expected).powi(2) / expected).sum();
    // 103.4 is exceeded once in a thousand with 63 degrees of freedom.
    assert!(chi_square < 103.4, "{chi_square}");
}

#[test]
fn triangles_are_numbered_by_place_and_opaque() {
    let scene = crate::scene::load::builtin().unwrap().scene;
    let triangles = opaque_triangles(&scene).unwrap();
    assert!(triangles.len() > 14_000);
    assert!((0..).zip(&triangles).all(|(place, triangle)| triangle.primitive == place && triangle.flags == 0));
}
