//! How far the distance of a hit is from the truth, on triangles much larger than the distance: floors, walls, slopes.

use raywarp_kernels::math::{vec3, Vec3};
use raywarp_kernels::ray::Ray;
use raywarp_kernels::triangle::{Across, Triangle};

/// A sequence of numbers from 0 to 1, the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// The two halves of a square of which `across` and `along` are half the sides.
fn square(across: [f64; 3], along: [f64; 3]) -> [Triangle; 2] {
    let corner = |a: f64, b: f64| {
        let [x, y, z] = [0, 1, 2].map(|i| (a * across[i] + b * along[i]) as f32);
        vec3(x, y, z)
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let [a, b, c, d] = corners;
    [Triangle::new(a, b, c, 0, 0), Triangle::new(a, c, d, 1, 0)]
}

fn double(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Where the ray meets the plane of the triangle: by double precision, of the very floats.
fn truth(triangle: &Triangle, ray: &Ray) -> f64 {
    let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(double);
    let normal = cross(minus(b, a), minus(c, a));
    dot(normal, minus(a, double(ray.origin))) / dot(normal, double(ray.direction))
}

/// The same in single precision as Embree does it by default, after Möller and Trumbore.
fn moller_trumbore(triangle: &Triangle, ray: &Ray) -> f64 {
    let normal = (triangle.v2 - triangle.v0).cross(triangle.v1 - triangle.v0);
    f64::from(normal.dot(triangle.v0 - ray.origin) / normal.dot(ray.direction))
}

/// The hit of the square and its triangle.
fn hit(square: &[Triangle; 2], ray: &Ray) -> Option<(Triangle, f64)> {
    let across = Across::new(ray);
    square.iter().find_map(|triangle| {
        let hit = triangle.intersect(&across).filter(|hit| hit.t > 0.0)?;
        Some((*triangle, f64::from(hit.t)))
    })
}

/// A ray down to a floor at height 0 from `height`, towards a point up to `size` away; any length of the direction.
fn downwards(random: &mut Random, height: f64, size: f64) -> Ray {
    let distance = height * (size / height).powf(random.next());
    let angle = random.between(0.0, std::f64::consts::TAU);
    let start =
        [random.between(-1.0, 1.0) * height, height * random.between(0.5, 1.0), random.between(-1.0, 1.0) * height];
    let length = random.between(0.1, 10.0);
    let direction = [distance * angle.cos(), -start[1], distance * angle.sin()].map(|x| (x * length / distance) as f32);
    Ray::new(vec3(start[0] as f32, start[1] as f32, start[2] as f32), direction.into())
}

/// The axes of a vector, moved on.
fn turned(v: Vec3, axes: usize) -> Vec3 {
    let v = v.to_array();
    [0, 1, 2].map(|i| v[(i + axes) % 3]).into()
}

#[test]
fn on_floors_and_walls_of_any_size_the_distance_is_right_to_the_last_bits() {
    let mut random = Random(1);
    for exponent in -6..=6 {
        let size = 10f64.powi(exponent);
        for height in [1.5f64.min(0.2 * size), size * 1e-3, size * 0.3] {
            for axes in 0..3 {
                let floor = square([size, 0.0, 0.0], [0.0, 0.0, size])
                    .map(|t| Triangle::new(turned(t.v0, axes), turned(t.v1, axes), turned(t.v2, axes), t.primitive, 0));
                let mut hits = 0;
                for _ in 0..2_000 {
                    let ray = downwards(&mut random, height, size);
                    let ray = Ray::new(turned(ray.origin, axes), turned(ray.direction, axes));
                    let Some((triangle, t)) = hit(&floor, &ray) else { continue };
                    let truth = truth(&triangle, &ray);
                    hits += 1;
                    assert!(
                        (t - truth).abs() <= 4e-7 * truth,
                        "size {size}, height {height}: {t} for {truth}, {ray:?}"
                    );
                }
                assert!(hits > 1_000, "size {size}: {hits}");
            }
        }
    }
}

#[test]
fn on_slopes_the_distance_is_as_good_as_by_moller_and_trumbore() {
    let mut random = Random(2);
    for exponent in 2..=6 {
        let size = 10f64.powi(exponent);
        for tilt in [1e-3f64, 0.1, 0.5, 1.0] {
            let (sin, cos) = tilt.sin_cos();
            let slope = square([size * cos, size * sin, 0.0], [-0.3 * sin * size, 0.3 * cos * size, size]);
            let (mut ours, mut theirs) = ([0.0f64; 2], [0.0f64; 2]);
            for _ in 0..20_000 {
                let distance = size.powf(random.next());
                let aim = [0, 1, 2].map(|_| random.between(-1.0, 1.0) * distance);
                let ray = Ray::new(vec3(0.0, 1.5, 0.0), aim.map(|x| (x / distance) as f32).into());
                let Some((triangle, t)) = hit(&slope, &ray) else { continue };
                let truth = truth(&triangle, &ray);
                let errors = [(t - truth).abs() / truth, (moller_trumbore(&triangle, &ray) - truth).abs() / truth];
                ours = [ours[0].max(errors[0]), ours[1] + errors[0]];
                theirs = [theirs[0].max(errors[1]), theirs[1] + errors[1]];
            }
            println!("size {size:e}, tilt {tilt}: {ours:?} beside {theirs:?}");
            assert!(
                ours[0] <= 3.0 * theirs[0] && ours[1] <= 3.0 * theirs[1],
                "size {size}, tilt {tilt}: {ours:?}, {theirs:?}"
            );
        }
    }
}
