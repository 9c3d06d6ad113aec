//! Every question about a ray has the answer that looking at each triangle gives, on every structure.

use std::ops::ControlFlow;

use crate::common::{ray, scene, Numbers, AIMS, FAMILIES};
use proptest::prelude::*;
use raywarp::accel::AccelKind;
use raywarp::device::{Device, DeviceChoice};
use raywarp::query::{device, QueryError, RayCaster};
use raywarp::scene::{Instance, Mesh, Scene, Transform};
use raywarp::{Hit, Ray, Triangle, Vec3, MISS};
use raywarp_core::triangle::RayShear;

fn cpu() -> Device {
    Device::open(DeviceChoice::Cpu).expect("there always is a CPU")
}

/// Every structure over the same triangles.
fn casters(triangles: &[Triangle]) -> Vec<RayCaster> {
    AccelKind::ALL.map(|kind| RayCaster::new(triangles.to_vec(), kind, &cpu()).expect("few triangles")).into()
}

/// The hits of a ray: each triangle by itself, sorted, each once.
fn oracle(triangles: &[Triangle], ray: &Ray) -> Vec<[u32; 4]> {
    if !(2f32.powi(-100)..=2f32.powi(100)).contains(&ray.direction.max_abs()) {
        return Vec::new();
    }
    let within = |hit: &Hit| hit.t >= ray.t_min && hit.t <= ray.t_max && hit.t.is_finite();
    let shear = RayShear::new(ray);
    let mut hits: Vec<_> = triangles.iter().filter_map(|triangle| triangle.intersect(&shear)).filter(within).collect();
    hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.primitive.cmp(&b.primitive)));
    hits.dedup_by(|a, b| a.t == b.t && a.primitive == b.primitive);
    // Where -0 and 0 meet, the primitive decides.
    hits.sort_by(|a, b| if a.precedes(b) { std::cmp::Ordering::Less } else { std::cmp::Ordering::Greater });
    hits.iter().map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive]).collect()
}

/// The hits of each ray of a batch, as the oracle has them.
fn rows(caster: &RayCaster, rays: &[Ray], limit: u32) -> Vec<Vec<[u32; 4]>> {
    let all = caster.batch(rays).max_hits(limit).all().unwrap();
    assert_eq!(all.offsets.len(), rays.len() + 1);
    let hits = &all.hits;
    let item = |i: usize| [hits.t[i].to_bits(), hits.uv[i][0].to_bits(), hits.uv[i][1].to_bits(), hits.primitive[i]];
    all.offsets.windows(2).map(|ends| (ends[0] as usize..ends[1] as usize).map(item).collect()).collect()
}

/// All four questions of a batch, to every structure.
fn check(triangles: &[Triangle], rays: &[Ray]) {
    let truth: Vec<_> = rays.iter().map(|ray| oracle(triangles, ray)).collect();
    let counts: Vec<u32> = truth.iter().map(|hits| hits.len() as u32).collect();
    for caster in casters(triangles) {
        let name = caster.report().tree;
        let all = rows(&caster, rays, u32::MAX);
        for ((ray, found), truth) in rays.iter().zip(&all).zip(&truth) {
            assert_eq!(found, truth, "{name:?}: {ray:?}");
        }
        assert_eq!(caster.count(rays).unwrap(), counts, "{name:?}");
        let any: Vec<bool> = counts.iter().map(|&count| count > 0).collect();
        assert_eq!(caster.any(rays).unwrap(), any, "{name:?}");
        for (hit, truth) in caster.hits(rays).unwrap().iter().zip(&truth) {
            let first = truth.first().copied().unwrap_or([f32::INFINITY.to_bits(), 0, 0, MISS]);
            assert_eq!([hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive], first, "{name:?}");
        }
        for limit in [0, 1, 3, 4, 5, 9] {
            let first = |hits: &Vec<_>| hits.iter().take(limit as usize).copied().collect::<Vec<_>>();
            assert_eq!(rows(&caster, rays, limit), truth.iter().map(first).collect::<Vec<_>>(), "{name:?}");
            let bounded: Vec<u32> = counts.iter().map(|&count| count.min(limit)).collect();
            assert_eq!(caster.batch(rays).max_hits(limit).count().unwrap(), bounded, "{name:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_question_has_its_answer(family in 0..FAMILIES, count in 1usize..200, seed: u64) {
        let mut numbers = Numbers(seed);
        let triangles = scene(family, count, &mut numbers);
        if !triangles.is_empty() {
            let rays: Vec<_> = (0..AIMS * 6).map(|i| ray(i % AIMS, &triangles, &mut numbers)).collect();
            check(&triangles, &rays);
        }
    }
}

/// Parallel walls at z = 1, 2, ..., each of two triangles.
fn walls(count: u32) -> Vec<Triangle> {
    let wall = |i: u32| {
        let corner = |x, y| Vec3::new(x, y, (i + 1) as f32);
        let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        [Triangle::new(a, b, c, 2 * i, 0), Triangle::new(a, c, d, 2 * i + 1, 0)]
    };
    (0..count).flat_map(wall).collect()
}

fn along_z(x: f32, y: f32) -> Ray {
    Ray::new(Vec3::new(x, y, 0.0), Vec3::new(0.0, 0.0, 1.0))
}

#[test]
fn many_walls_are_counted_in_order() {
    let triangles = walls(100);
    // The second runs along the diagonals, which belong to one triangle each.
    let rays = [along_z(0.25, 0.5), along_z(0.5, 0.5), along_z(2.0, 0.0)];
    check(&triangles, &rays);
    for caster in casters(&triangles) {
        assert_eq!(caster.count(&rays).unwrap(), [100, 100, 0]);
        let all = caster.all(&rays).unwrap();
        assert_eq!(all.offsets, [0, 100, 200, 200]);
        assert!(all.hits.t[..100].iter().copied().eq((1..=100).map(|z| z as f32)));
    }
}

/// Identical triangles are as many hits as there are numbers, however often a structure refers to each.
#[test]
fn identical_triangles_are_one_hit_each() {
    let one = walls(1)[0];
    let triangles: Vec<_> = (0..50).map(|i| Triangle { primitive: i, ..one }).collect();
    for caster in casters(&triangles) {
        assert_eq!(caster.count(&[along_z(0.5, 0.25)]).unwrap(), [50]);
        assert_eq!(caster.all(&[along_z(0.5, 0.25)]).unwrap().hits.primitive, (0..50).collect::<Vec<_>>());
    }
}

const INF: f32 = f32::INFINITY;
const NAN: f32 = f32::NAN;

/// What the documentation of [`Ray`] says of odd rays. Each with the distances of its hits of walls at 1, 2 and 3.
#[test]
fn odd_rays_hit_what_is_documented() {
    let triangles = walls(3);
    let good = along_z(0.25, 0.5);
    let with = |change: &dyn Fn(&mut Ray)| {
        let mut ray = good;
        change(&mut ray);
        ray
    };
    let rays_and_hits: Vec<(Ray, &[f32])> = vec![
        (good, &[1.0, 2.0, 3.0]),
        // The direction's length is the unit of t.
        (with(&|ray| ray.direction.z = 0.5), &[2.0, 4.0, 6.0]),
        // Both ends belong to the ray.
        (with(&|ray| (ray.t_min, ray.t_max) = (1.0, 2.0)), &[1.0, 2.0]),
        (with(&|ray| (ray.t_min, ray.t_max) = (2.0, 2.0)), &[2.0]),
        (with(&|ray| ray.t_min = 1.0000001), &[2.0, 3.0]),
        (with(&|ray| ray.t_max = 0.99999994), &[]),
        (with(&|ray| (ray.t_min, ray.t_max) = (2.0, 1.0)), &[]),
        (with(&|ray| ray.t_max = 0.0), &[]),
        (with(&|ray| ray.t_max = -1.0), &[]),
        // Hits behind the origin count from t_min on.
        (with(&|ray| (ray.origin.z, ray.t_min) = (2.5, -1.0)), &[-0.5, 0.5]),
        (with(&|ray| (ray.origin.z, ray.t_min) = (2.5, -INF)), &[-1.5, -0.5, 0.5]),
        (with(&|ray| (ray.origin.z, ray.t_min, ray.t_max) = (2.5, -INF, 0.0)), &[-1.5, -0.5]),
        (with(&|ray| ray.t_min = INF), &[]),
        (with(&|ray| ray.t_max = -INF), &[]),
        // Origins on a surface are at distance 0 of it.
        (with(&|ray| ray.origin.z = 1.0), &[0.0, 1.0, 2.0]),
        (with(&|ray| (ray.origin.z, ray.t_min) = (1.0, f32::MIN_POSITIVE)), &[1.0, 2.0]),
        // Nothing is hit by what is no ray.
        (with(&|ray| ray.direction = Vec3::ZERO), &[]),
        (with(&|ray| ray.direction = Vec3::new(0.0, -0.0, 0.0)), &[]),
        // Shorter or longer than 2^-100 and 2^100.
        (with(&|ray| ray.direction.z = 7.88e-31), &[]),
        (with(&|ray| ray.direction.z = 1.27e30), &[]),
        (with(&|ray| ray.direction.z = 2f32.powi(-100)), &[1.2676506e30, 2.5353012e30, 3.8029518e30]),
        (with(&|ray| ray.direction.z = 2f32.powi(100)), &[7.888609e-31, 1.5777218e-30, 2.3665827e-30]),
        (with(&|ray| ray.direction.x = NAN), &[]),
        (with(&|ray| ray.direction.z = NAN), &[]),
        (with(&|ray| ray.direction.z = INF), &[]),
        (with(&|ray| ray.direction = Vec3::splat(INF)), &[]),
        (with(&|ray| ray.origin.x = NAN), &[]),
        (with(&|ray| ray.origin.z = NAN), &[]),
        (with(&|ray| ray.origin.z = -INF), &[]),
        (with(&|ray| ray.origin = Vec3::splat(INF)), &[]),
        (with(&|ray| ray.t_min = NAN), &[]),
        (with(&|ray| ray.t_max = NAN), &[]),
        // Parallel to the walls, beside them and in one.
        (with(&|ray| ray.direction = Vec3::new(1.0, 0.0, 0.0)), &[]),
        (with(&|ray| (ray.origin.z, ray.direction) = (2.0, Vec3::new(1.0, 0.0, 0.0))), &[]),
    ];
    let rays: Vec<_> = rays_and_hits.iter().map(|(ray, _)| *ray).collect();
    check(&triangles, &rays);
    for caster in casters(&triangles) {
        let all = caster.all(&rays).unwrap();
        for (i, (ray, hits)) in rays_and_hits.iter().enumerate() {
            assert_eq!(&all.hits.t[all.offsets[i] as usize..all.offsets[i + 1] as usize], *hits, "{ray:?}");
        }
    }
}

/// Where a distance overflows there is no hit, whatever the end of the ray.
#[test]
fn a_distance_beyond_the_largest_float_is_no_hit() {
    let far = |z: f32| {
        let corner = |x, y| Vec3::new(x, y, z);
        Triangle::new(corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0), 0, 0)
    };
    let slow = Ray { direction: Vec3::new(0.0, 0.0, 1e-30), t_min: -INF, ..along_z(0.0, 0.0) };
    for (z, count) in [(1e6, 1), (1e9, 0), (-1e6, 1), (-1e9, 0)] {
        for caster in casters(&[far(z)]) {
            assert_eq!(caster.count(&[slow]).unwrap(), [count], "{z}");
            assert_eq!(caster.any(&[slow]).unwrap(), [count == 1], "{z}");
            assert_eq!(caster.closest(&[slow]).unwrap().t[0].is_finite(), count == 1, "{z}");
        }
    }
}

/// A closed box of any size, at its own distance from the origin and far away from it: a ray through it has two hits,
/// from its middle one, and from a face on two or one.
#[test]
fn boxes_from_small_to_large_are_entered_and_left() {
    for scale in [1e-6f32, 1e-3, 1.0, 1e3, 1e6] {
        for offset in [0.0, 0.5 * scale, 1000.0 * scale] {
            let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * scale;
            let at = Vec3::splat(offset);
            let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
            let triangles: Vec<_> = (0..12)
                .map(|i| {
                    let [a, b, c, d] = faces[i / 2].map(|i| corner(i) + at);
                    let (b, c) = if i % 2 == 0 { (b, c) } else { (c, d) };
                    Triangle::new(a, b, c, i as u32, 0)
                })
                .collect();
            let middle = Vec3::new(0.5, 0.5, 0.5) * scale + at;
            let axes = [0, 1, 2].map(|axis| {
                let mut direction = [0.0, -0.0, 0.0];
                direction[axis] = scale;
                Vec3::from(direction)
            });
            // Along the axes, in planes of the box too; and across, not through edges.
            let beside = Vec3::new(0.3, 0.6, 0.45) * scale + at;
            let rays: Vec<_> = axes
                .into_iter()
                .chain([Vec3::new(0.9, 0.3, -0.2) * scale])
                .flat_map(|d| [Ray::new(beside, d), Ray { t_min: -INF, ..Ray::new(beside, d) }])
                .chain(axes.map(|d| Ray::new(corner(0) + at - d, d)))
                .chain(axes.map(|d| Ray::new(middle - d * 0.5, d)))
                .collect();
            check(&triangles, &rays);
            for caster in casters(&triangles) {
                assert_eq!(caster.count(&rays[..8]).unwrap(), [1, 2, 1, 2, 1, 2, 1, 2], "{scale:e} at {offset:e}");
            }
        }
    }
}

#[test]
fn nothing_is_asked_or_there() {
    for caster in casters(&[]) {
        let rays = [along_z(0.0, 0.0)];
        assert_eq!(caster.count(&rays).unwrap(), [0]);
        assert_eq!(caster.all(&rays).unwrap().offsets, [0, 0]);
        assert_eq!(caster.closest(&rays).unwrap().geometry, [MISS]);
    }
    for caster in casters(&walls(1)) {
        assert!(caster.closest(&[]).unwrap().is_empty() && caster.any(&[]).unwrap().is_empty());
        assert_eq!(caster.all(&[]).unwrap().offsets, [0]);
    }
}

/// A triangle with corners at (0, 0), (1, 0) and (0, 1), and one below it without area.
fn mesh() -> Mesh {
    Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 1], [0, 1, 2]],
        materials: vec![0, 0],
        ..Mesh::default()
    }
}

#[test]
fn hits_name_the_instance_and_its_own_triangle() {
    let place = |mesh, x: f32, mirror: f32| Instance {
        name: String::new(),
        mesh,
        transform: Transform {
            columns: [[mirror, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            translation: [x, 0.0, 2.0],
        },
        material: None,
    };
    let scene = Scene {
        meshes: vec![mesh(), Mesh::default()],
        instances: vec![place(1, 0.0, 1.0), place(0, 0.0, 1.0), place(1, 0.0, 1.0), place(0, 5.0, -1.0)],
        materials: vec![Default::default()],
        ..Scene::default()
    };
    for kind in AccelKind::ALL {
        let caster = RayCaster::from_scene(&scene, kind, &cpu()).unwrap();
        assert_eq!((caster.report().triangles, caster.report().dropped.without_area), (2, 2));
        // The second sees the mirrored one: its vertex 1 is to the left.
        let hits = caster.closest(&[along_z(0.25, 0.5), along_z(4.75, 0.5), along_z(-1.0, 0.0)]).unwrap();
        assert_eq!(hits.geometry, [1, 3, MISS]);
        assert_eq!(hits.primitive, [1, 1, MISS]);
        assert_eq!(hits.t, [2.0, 2.0, INF]);
        assert_eq!(hits.uv, [[0.25, 0.5], [0.25, 0.5], [0.0, 0.0]]);
    }
}

#[test]
fn a_watched_batch_tells_how_far_it_is_and_can_be_ended() {
    let caster = RayCaster::new(walls(2), AccelKind::Bvh, &cpu()).unwrap();
    let rays = vec![along_z(0.25, 0.5); 300_000];
    let mut seen = Vec::new();
    let mut watch = |progress: raywarp::query::Progress| {
        seen.push(progress.done);
        assert_eq!(progress.total, 300_000);
        ControlFlow::Continue(())
    };
    assert_eq!(caster.batch(&rays).watched(&mut watch).count().unwrap(), vec![2; 300_000]);
    assert!(seen.len() > 1 && seen.is_sorted() && seen.last() == Some(&300_000), "{seen:?}");
    let stopped = caster.batch(&rays).watched(&mut |_| ControlFlow::Break(())).closest();
    assert!(matches!(stopped, Err(QueryError::Stopped { done, total: 300_000 }) if done < 300_000));
    let mut parts = 0;
    let stopped = caster.batch(&rays).all_by_parts(&mut |part| {
        parts += 1;
        assert_eq!(part.hits.len() as u64, part.offsets[part.offsets.len() - 1]);
        ControlFlow::Break(())
    });
    assert!(matches!(stopped, Err(QueryError::Stopped { done: 0, .. })) && parts == 1);
}

#[test]
fn buffers_that_do_not_fit_are_refused() {
    let device = cpu();
    let caster = RayCaster::new(walls(3), AccelKind::Bvh, &device).unwrap();
    let rays = device.upload(&[along_z(0.25, 0.5); 2]).unwrap();
    let mut short = device::Closest::new(&device, 1).unwrap();
    let refused = caster.trace(&rays, &mut short).unwrap_err().to_string();
    assert_eq!(refused, "2 rays need 2 hits, and the buffer has 1");
    let mut narrow = device::All { limit: 5, ..device::All::new(&device, 2, 4).unwrap() };
    let refused = caster.trace(&rays, &mut narrow).unwrap_err().to_string();
    assert_eq!(refused, "2 rays need 10 hits, and the buffer has 8");
}

#[test]
fn rows_of_hits_stay_on_the_device() {
    let device = cpu();
    let caster = RayCaster::new(walls(3), AccelKind::Kd, &device).unwrap();
    let rays = device.upload(&[along_z(0.25, 0.5), along_z(9.0, 0.0), along_z(0.5, 0.25)]).unwrap();
    let mut all = device::All::new(&device, 3, 2).unwrap();
    caster.trace(&rays, &mut all).unwrap();
    assert_eq!(all.counts.to_vec().unwrap(), [2, 0, 2]);
    let hits = all.hits.to_vec().unwrap();
    assert_eq!([hits[0].t, hits[1].t, hits[4].t, hits[5].t], [1.0, 2.0, 1.0, 2.0]);
    let stream = device.stream().unwrap();
    let count = device::Count::new(&device, 3).unwrap();
    let answered = caster.trace_on(&stream, rays, count).unwrap().wait().unwrap();
    assert_eq!(answered.answer.counts.to_vec().unwrap(), [3, 0, 3]);
    assert_eq!(answered.rays.len(), 3);
}
