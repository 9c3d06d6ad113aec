//! Counts and lists of hits, device buffers and streams.

use raywarp::accel::AccelKind;
use raywarp::device::Device;
use raywarp::query::device::{All, Any, Closest, Count};
use raywarp::query::{AllHits, Coherence, RayCaster};
use raywarp::{Hit, Ray, Triangle, Vec3};

use super::hits::{rays, soup};
use super::{device, kinds, reference, scaled, scene, triangles, Random};

/// The hits of ray `i`, to the bit.
fn row(all: &AllHits, i: usize) -> Vec<[u32; 4]> {
    let hits = &all.hits;
    let item = |i: usize| [hits.t[i].to_bits(), hits.uv[i][0].to_bits(), hits.uv[i][1].to_bits(), hits.primitive[i]];
    (all.offsets[i] as usize..all.offsets[i + 1] as usize).map(item).collect()
}

fn assert_same(found: &AllHits, expected: &AllHits, rays: &[Ray], what: &str) {
    let differ: Vec<_> = (0..rays.len()).filter(|&i| row(found, i) != row(expected, i)).collect();
    if let Some(&i) = differ.first() {
        let (found, expected) = (row(found, i), row(expected, i));
        panic!("{what}: {} of {} rays, such as {:?}: {found:x?}, not {expected:x?}", differ.len(), rays.len(), rays[i]);
    }
}

/// Every structure on the device under test against brute force on the CPU: the same hits in the same order, and the
/// same counts, bounded and not.
fn check(name: &str, triangles: &[Triangle], count: usize) {
    let rays = rays(triangles, scaled(count), &mut Random(5));
    let oracle = RayCaster::new(triangles.to_vec(), AccelKind::Brute, &reference()).unwrap();
    let (all, counts) = (oracle.all(&rays).unwrap(), oracle.count(&rays).unwrap());
    let bounded = oracle.batch(&rays).max_hits(3).all().unwrap();
    assert!(all.hits.len() > rays.len() / 2, "{name}: the rays hit something");
    for kind in kinds() {
        let caster = RayCaster::new(triangles.to_vec(), kind, &device()).unwrap();
        assert_same(&caster.all(&rays).unwrap(), &all, &rays, &format!("{name}, {kind}"));
        assert!(caster.count(&rays).unwrap() == counts, "{name}, {kind}: counts");
        let three = caster.batch(&rays).max_hits(3).all().unwrap();
        assert_same(&three, &bounded, &rays, &format!("{name}, {kind}, at most three"));
        println!("{name}, {kind}: {} rays, {} hits, all the same", rays.len(), all.hits.len());
    }
}

#[test]
fn all_hits_of_random_triangles() {
    check("soup", &soup(&mut Random(1)), 100_000);
}

#[test]
fn all_hits_of_a_mesh() {
    check("suzanne", &triangles(&scene("built-in")), 20_000);
}

/// What the documentation of [`Ray`] says: with a floor and a wall of large triangles in the planes of boxes.
#[test]
fn odd_rays_are_the_same_everywhere() {
    let mut cornell = triangles(&scene("cornell/cornell_box.obj"));
    let corners: Vec<Vec3> = cornell.iter().flat_map(|t| [t.v0, t.v1, t.v2]).collect();
    for scale in [1e-6f32, 1.0, 1e6] {
        for triangle in &mut cornell {
            let [a, b, c] = [0, 1, 2].map(|i| corners[3 * triangle.primitive as usize + i] * (scale / 500.0));
            *triangle = Triangle::new(a, b, c, triangle.primitive, 0);
        }
        // What is large comes last: see `rays_along_axes_agree_up_to_2_57_times_the_extent_of_a_triangle`.
        let odd = [0.0, -0.0, scale, -scale, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-38, 1e30, f32::MAX];
        let mut random = Random(9);
        let mut any = |kinds: usize, one_in: usize, good: f32| match random.bits() as usize % one_in {
            i if i < kinds => odd[i],
            _ => good,
        };
        let mut numbers = Random(10);
        let rays: Vec<Ray> = (0..scaled(200_000))
            .map(|i| {
                let corner = corners[numbers.bits() as usize % corners.len()] * (scale / 500.0);
                let direction = if i % 3 == 0 { Vec3::new(0.0, 0.0, -scale) } else { numbers.vector() * scale };
                let mut vector = |k, v: Vec3| Vec3::new(any(k, 60, v.x), any(k, 60, v.y), any(k, 60, v.z));
                let (origin, direction) = (vector(8, corner - direction), vector(10, direction));
                Ray { t_min: any(10, 20, 0.0), t_max: any(10, 20, f32::INFINITY), ..Ray::new(origin, direction) }
            })
            .collect();
        let oracle = RayCaster::new(cornell.clone(), AccelKind::Brute, &reference()).unwrap();
        let (all, blocked) = (oracle.all(&rays).unwrap(), oracle.any(&rays).unwrap());
        assert!(all.hits.len() > rays.len() / 4);
        for kind in kinds() {
            let caster = RayCaster::new(cornell.clone(), kind, &device()).unwrap();
            assert_same(&caster.all(&rays).unwrap(), &all, &rays, &format!("{kind} at {scale:e}"));
            assert!(caster.any(&rays).unwrap() == blocked, "{kind} at {scale:e}: any hit");
        }
    }
}

/// Where boxes are tested, a component of the direction counts as at least 2^-80 of the largest, and boxes have a margin
/// of 2^-22 of each triangle's extent, half of which the test of the triangle may need. So the extent of the triangle counts,
/// and not the size of the scene.
#[test]
fn rays_along_axes_agree_up_to_2_57_times_the_extent_of_a_triangle() {
    for extent in [1.0f32, 2.0f32.powi(-10)] {
        // Squares in a row, the first and the last of which are a thousand apart.
        let corner = |place: f32, x: f32, y: f32| Vec3::new(place + x * extent, y * extent, 0.0);
        let square = |(index, place): (u32, f32)| {
            let [a, b, c, d] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| corner(place, x, y));
            [Triangle::new(a, b, c, 2 * index, 0), Triangle::new(a, c, d, 2 * index + 1, 0)]
        };
        let places = (0..64).map(|i| i as f32 * extent).chain([1000.0]);
        let triangles: Vec<Triangle> = (0..).zip(places.clone()).flat_map(square).collect();
        // From edges, corners and the inside, backwards and forwards along z.
        let spots: Vec<_> = places.flat_map(|place| [0.0, 0.25, 0.5, 1.0].map(|x| place + x * extent)).collect();
        let mut rays = Vec::new();
        for power in [0, 30, 50, 55, 56, 57] {
            let away = extent * 2.0f32.powi(power);
            for (index, &x) in spots.iter().enumerate() {
                let y = [0.0, 0.25, 0.75, 1.0][index / 4 % 4] * extent;
                for (z, sign) in [(away, -1.0), (-away, 1.0)] {
                    for zero in [0.0, -0.0] {
                        rays.push(Ray::new(Vec3::new(x, y, z), Vec3::new(zero, zero, sign)));
                    }
                }
            }
        }
        let oracle = RayCaster::new(triangles.clone(), AccelKind::Brute, &reference()).unwrap().all(&rays).unwrap();
        assert!(oracle.hits.len() > rays.len() / 2);
        for kind in kinds() {
            let caster = RayCaster::new(triangles.clone(), kind, &device()).unwrap();
            assert_same(&caster.all(&rays).unwrap(), &oracle, &rays, &format!("{kind}, extent {extent:e}"));
        }
    }
}

/// Batches of every length around that of a warp and far beyond what fits on a device, by either kernel, with many
/// triangles at the same place: which is hit first does not depend on the lane that finds it.
#[test]
fn batches_are_answered_alike_whatever_is_expected_of_them() {
    let device = device();
    let mut triangles = soup(&mut Random(21));
    let copies: Vec<Triangle> = triangles.iter().step_by(3).copied().cycle().take(6000).collect();
    triangles.extend(copies.iter().enumerate().map(|(i, t)| Triangle { primitive: 3000 + i as u32, ..*t }));
    let mut mixed = rays(&triangles, scaled(600_000), &mut Random(22));
    // Runs in which all go one way, among the others.
    for run in mixed.chunks_mut(32).step_by(3) {
        run.iter_mut().for_each(|ray| ray.direction = ray.direction.max(-ray.direction));
    }
    let expected = RayCaster::new(triangles.clone(), AccelKind::Bvh, &reference()).unwrap().hits(&mixed).unwrap();
    let caster = RayCaster::new(triangles, AccelKind::Bvh, &device).unwrap();
    let sample = device.upload(&mixed[..1000]).unwrap();
    let tuned = caster.tuned_to(&sample, &mut Closest::new(&device, 1000).unwrap()).unwrap();
    let expecting = |coherence| caster.expecting(coherence);
    let casters = [expecting(Coherence::Coherent), expecting(Coherence::Incoherent), tuned];
    for (caster, name) in casters.iter().zip(["coherent", "incoherent", "tuned"]) {
        for count in [0, 1, 31, 32, 33, 65, 1000, 4097, mixed.len()] {
            let (rays, expected) = (device.upload(&mixed[..count]).unwrap(), &expected[..count]);
            let mut closest = Closest::new(&device, count as u32).unwrap();
            caster.trace(&rays, &mut closest).unwrap();
            let hits = closest.hits.to_vec().unwrap();
            let bits = |hit: &Hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive];
            let differing = hits.iter().zip(expected).filter(|(a, b)| bits(a) != bits(b)).count();
            assert_eq!((hits.len(), differing), (count, 0), "{name}");
            let mut any = Any::new(&device, count as u32).unwrap();
            caster.trace(&rays, &mut any).unwrap();
            let any = any.blocked.to_vec().unwrap();
            assert!(any.iter().zip(expected).all(|(&any, hit)| (any != 0) != hit.is_miss()), "{name}, {count}");
        }
    }
    // Of so many some are traced first, to see which kernel suits.
    let many = if device.is_cuda() { (1 << 20) + 5 } else { 1000 };
    let rays: Vec<Ray> = mixed.iter().copied().cycle().take(many).collect();
    let hits = caster.hits(&rays).unwrap();
    assert!(hits.iter().eq(expected.iter().cycle().take(many)));
    assert!(caster.any(&rays).unwrap().iter().zip(&hits).all(|(&any, hit)| any != hit.is_miss()));
}

/// Two batches under way at once on two streams, many times over: each gets its own answers.
#[test]
fn streams_answer_their_own_batches() {
    let device = device();
    let triangles = triangles(&scene("built-in"));
    let caster = RayCaster::new(triangles.clone(), AccelKind::Bvh, &device).unwrap();
    let rays = rays(&triangles, scaled(1_000_000), &mut Random(13));
    let expected = caster.hits(&rays).unwrap();
    let pieces: Vec<_> = rays.chunks(rays.len() / 20).zip(expected.chunks(rays.len() / 20)).collect();
    let streams = [device.stream().unwrap(), device.stream().unwrap()];
    let mut pending: [Option<(_, &[_])>; 2] = [None, None];
    for (i, (rays, expected)) in pieces.iter().enumerate() {
        let (on_device, room) = (device.upload(rays).unwrap(), Closest::new(&device, rays.len() as u32).unwrap());
        let next = caster.trace_on(&streams[i % 2], on_device, room).unwrap();
        if let Some((last, expected)) = pending[i % 2].replace((next, *expected)) {
            let answered: raywarp::query::device::Answered<Closest> = last.wait().unwrap();
            assert!(answered.answer.hits.to_vec().unwrap() == expected, "before piece {i}");
            assert!(answered.rays.len() as usize == expected.len());
        }
    }
    // Those that nobody waits for are waited for where they are dropped, and so is the structure.
    drop(caster);
    drop(pending);
}

#[test]
fn answers_stay_on_the_device() {
    let device = device();
    let triangles = triangles(&scene("built-in"));
    let caster = RayCaster::new(triangles.clone(), AccelKind::Bvh, &device).unwrap();
    let rays = rays(&triangles, 3000, &mut Random(17));
    let on_device = device.upload(&rays).unwrap();
    let (mut any, mut count) = (Any::new(&device, 3000).unwrap(), Count::new(&device, 3000).unwrap());
    let mut all = All::new(&device, 3000, 4).unwrap();
    caster.trace(&on_device, &mut any).unwrap();
    caster.trace(&on_device, &mut count).unwrap();
    caster.trace(&on_device, &mut all).unwrap();
    let counts = count.counts.to_vec().unwrap();
    assert_eq!(counts, caster.count(&rays).unwrap());
    assert!(any.blocked.to_vec().unwrap().iter().zip(&counts).all(|(&any, &count)| (any != 0) == (count > 0)));
    let (kept, hits) = (all.counts.to_vec().unwrap(), all.hits.to_vec().unwrap());
    let expected = caster.batch(&rays).max_hits(4).all().unwrap();
    for (i, ends) in expected.offsets.windows(2).enumerate() {
        assert_eq!(u64::from(kept[i]), ends[1] - ends[0]);
        let row = hits[4 * i..4 * i + kept[i] as usize].iter().map(|hit| hit.t);
        assert!(row.eq(expected.hits.t[ends[0] as usize..ends[1] as usize].iter().copied()));
    }
}

/// A buffer of another device, or of another handle to the same, is refused before a kernel could follow it.
#[test]
fn buffers_of_other_devices_are_refused() {
    let caster = RayCaster::new(soup(&mut Random(1)), AccelKind::Bvh, &device()).unwrap();
    if !caster.device().is_cuda() {
        return;
    }
    let ray = Ray::new(Vec3::ZERO, Vec3::ONE);
    for other in [reference(), device()] {
        let (own, foreign): (&Device, _) = (caster.device(), other.upload(&[ray]).unwrap());
        let refused = caster.trace(&foreign, &mut Closest::new(own, 1).unwrap()).unwrap_err().to_string();
        assert!(refused.contains("belong to another device than"), "{refused}");
        let rays = own.upload(&[ray]).unwrap();
        assert!(caster.trace(&rays, &mut Closest::new(&other, 1).unwrap()).is_err());
        assert!(caster.trace_on(&other.stream().unwrap(), rays, Closest::new(own, 1).unwrap()).is_err());
    }
}
