//! The ray-triangle test against exact integers, and for gaps between neighbours.

use proptest::prelude::*;
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::Ray;
use raywarp_core::triangle::{RayShear, Triangle};

type Point = [i128; 3];

fn minus(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// `a . (b x c)`
fn determinant(a: Point, b: Point, c: Point) -> i128 {
    let minor = |j: usize, k: usize| b[j] * c[k] - b[k] * c[j];
    a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
}

fn largest(a: Point) -> i128 {
    a.map(i128::abs).into_iter().max().unwrap_or(0)
}

/// The least of u, v and w, exactly, and the size of the products they are summed from.
fn exact([a, b, c]: [Point; 3], origin: Point, direction: Point) -> (i128, i128) {
    let [a, b, c] = [a, b, c].map(|v| minus(v, origin));
    let (u, v, w) = (determinant(direction, c, a), determinant(direction, a, b), determinant(direction, b, c));
    let sign = (u + v + w).signum();
    let extent = [minus(b, a), minus(c, a), minus(c, b)].map(largest).into_iter().max().unwrap_or(0);
    ((u * sign).min(v * sign).min(w * sign), largest(direction) * extent * largest(a).max(extent))
}

/// Single precision holds these exactly.
fn single(point: Point) -> Vec3 {
    let [x, y, z] = point.map(|x| x as f32);
    vec3(x, y, z)
}

fn point(size: i128) -> impl Strategy<Value = Point> {
    [-size..=size, -size..=size, -size..=size]
}

/// The bound that `ROUNDING` promises with `decide`: 16 roundings, and one for what the counting leaves out.
const DECIDED: i128 = 17;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200_000))]

    /// Beyond a few roundings from the edge the answer is the exact one. Rays are aimed near edges.
    #[test]
    fn the_answer_is_exact_but_for_the_last_bits(
        size in prop::sample::select(vec![4i128, 100, 5_000, 1 << 20]),
        corners in [point(1 << 20), point(1 << 20), point(1 << 20)],
        from in point(1 << 20),
        along in 0i128..=16,
        beside in point(3),
        side in 0usize..3,
    ) {
        let corners = corners.map(|corner| corner.map(|x| x % size));
        let (a, b) = (corners[side], corners[(side + 1) % 3]);
        let target = [0, 1, 2].map(|i| (a[i] * (16 - along) + b[i] * along) / 16 + beside[i]);
        let direction = minus(target, from);
        let (least, scale) = exact(corners, from, direction);
        let [v0, v1, v2] = corners.map(single);
        let hit = Triangle::new(v0, v1, v2, 0, 0).intersect(&RayShear::new(&Ray::new(single(from), single(direction))));
        if (least.abs() << 24) > DECIDED * scale {
            prop_assert_eq!(hit.is_some(), least > 0, "least {} of {}", least, scale);
        }
    }

    /// Whatever the sizes, a ray at the apex of a flat fan, or at a point of its spokes, meets one of its triangles.
    #[test]
    fn no_ray_passes_the_apex_of_a_fan(
        valence in 3usize..8,
        apex in prop::array::uniform2(-0.1f32..0.1),
        radii in prop::collection::vec(0.6f32..2.0, 8),
        from in prop::array::uniform3(0.1f32..2.0),
        (offset, size, distance) in (prop::sample::select(vec![0.0f32, 1.0, 1000.0]), -40i32..40, 0i32..12),
        (spoke, along) in (0usize..8, prop::sample::select(vec![0.0f32, 0.0, 0.25, 0.7])),
        turned in any::<u8>(),
    ) {
        let (size, distance) = ((size as f32).exp2(), (distance as f32).exp2());
        let place = |x: f32, z: f32| vec3(offset + x, 0.25, z - offset) * size;
        let apex = place(apex[0], apex[1]);
        let ring: Vec<Vec3> = (0..valence).map(|i| {
            let angle = std::f32::consts::TAU * i as f32 / valence as f32;
            place(angle.cos() * radii[i], angle.sin() * radii[i])
        }).collect();
        let target = (ring[spoke % valence] - apex) * along + apex;
        let origin = apex + vec3(from[0] - 1.0, from[1], from[2] - 1.0) * (distance * size);
        let ray = Ray::new(origin, target - origin);
        let hit = (0..valence).any(|i| {
            let (a, b) = (ring[i], ring[(i + 1) % valence]);
            let [v0, v1, v2] = match turned >> i & 1 { 0 => [apex, a, b], _ => [b, apex, a] };
            Triangle::new(v0, v1, v2, 0, 0).intersect(&RayShear::new(&ray)).is_some()
        });
        prop_assert!(hit, "{ray:?} at {target:?}");
    }
}

/// The three determinants of a spoke's ends and a ray at the apex once rounded each by itself: all could be negative.
#[test]
fn the_apex_of_a_square_is_met_by_rays_aimed_at_it() {
    let apex = vec3(0.1, 0.0, 0.07);
    let ring = [vec3(1.1, 0.0, 0.2), vec3(-0.1, 0.0, 0.9), vec3(-1.3, 0.0, -0.2), vec3(0.3, 0.0, -0.7)];
    let lost = (0..100_000).filter(|i| {
        let origin =
            vec3((i % 317) as f32 * 0.003 - 0.5, 1.0 + (i % 1009) as f32 * 0.002, (i % 211) as f32 * 0.004 - 0.4);
        let ray = Ray::new(origin, apex - origin);
        !(0..4).any(|i| Triangle::new(apex, ring[i], ring[(i + 1) % 4], 0, 0).intersect(&RayShear::new(&ray)).is_some())
    });
    assert_eq!(lost.count(), 0);
}

/// Products that overflow or vanish are computed anew in double precision.
#[test]
fn extreme_sizes_are_hit() {
    for exponent in (-110..=110).step_by(5) {
        let size = (exponent as f32).exp2();
        let triangle = Triangle::new(vec3(0.0, 0.0, 0.0) * size, vec3(size, 0.0, 0.0), vec3(0.0, size, 0.0), 0, 0);
        for length in [-100.0f32, -60.0, 0.0, 60.0, 100.0].map(f32::exp2) {
            let ray = Ray::new(vec3(0.25, 0.25, 1.0) * size, vec3(0.0, 0.0, -length));
            let t = f64::from(size) / f64::from(length);
            if t < f64::from(f32::MAX) {
                let hit = triangle.intersect(&RayShear::new(&ray)).map(|hit| f64::from(hit.t));
                assert!(hit.is_some_and(|found| (found - t).abs() <= 1e-6 * t + 1e-44), "{size:e} {length:e}: {hit:?}");
            }
        }
    }
}
