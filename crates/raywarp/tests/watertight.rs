//! No ray passes between two triangles of a closed mesh.
//!
//! Rays are aimed from outside at points on edges and at vertices, where the test of each triangle alone is a toss-up,
//! and from inside in every direction. Each must hit something, in every structure.

mod common;

use common::{every_structure, Numbers};
use rayon::prelude::*;
use raywarp::accel::Accel;
use raywarp_kernels::math::{vec3, Vec3};
use raywarp_kernels::ray::Ray;
use raywarp_kernels::traverse::{Occlusion, Uncounted};
use raywarp_kernels::triangle::Triangle;

/// A closed surface, star-shaped around a point inside.
struct Solid {
    name: &'static str,
    vertices: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    centre: Vec3,
}

impl Solid {
    fn triangles(&self) -> Vec<Triangle> {
        // Turned, so that neighbours see their common edge in every order.
        let turned = |(i, face): (usize, &[usize; 3])| {
            let [a, b, c] = [0, 1, 2].map(|k| self.vertices[face[(k + i) % 3]]);
            Triangle::new(a, b, c, i as u32, 0)
        };
        self.faces.iter().enumerate().map(turned).collect()
    }

    fn placed(mut self, name: &'static str, scale: f32, offset: Vec3) -> Self {
        let place = |v: Vec3| v.mul_add(scale, offset);
        self.vertices.iter_mut().for_each(|v| *v = place(*v));
        Self { name, centre: place(self.centre), ..self }
    }

    fn moved(mut self, name: &'static str, mut to: impl FnMut(Vec3) -> Vec3) -> Self {
        self.vertices.iter_mut().for_each(|v| *v = to(*v));
        Self { name, ..self }
    }
}

fn octahedron() -> Solid {
    let vertices = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    let faces = (0..8).map(|i| [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2)]).collect();
    let vertices = vertices.map(|[x, y, z]| vec3(x as f32, y as f32, z as f32)).to_vec();
    Solid { name: "octahedron", vertices, faces, centre: Vec3::ZERO }
}

/// Each face in four, `levels` times, vertices on the unit sphere.
fn sphere(levels: usize) -> Solid {
    let mut solid = octahedron();
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut faces = Vec::new();
        for [a, b, c] in std::mem::take(&mut solid.faces) {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    solid.vertices.push((solid.vertices[p] + solid.vertices[q]).normalize());
                    solid.vertices.len() - 1
                })
            });
            faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        solid.faces = faces;
    }
    Solid { name: "sphere", ..solid }
}

/// Every side of `n` by `n` squares in two halves, corners shared.
fn cube(n: usize) -> Solid {
    let mut solid = Solid { name: "cube", vertices: Vec::new(), faces: Vec::new(), centre: Vec3::ZERO };
    let at = |i: usize| i as f32 * 2.0 / n as f32 - 1.0;
    for side in 0..6 {
        let point = |i: usize, j: usize| {
            let (end, a, b) = (if side % 2 == 0 { 1.0 } else { -1.0 }, at(i), at(j));
            [vec3(end, a, b), vec3(a, end, b), vec3(a, b, end)][side / 2]
        };
        for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
            let first = solid.vertices.len();
            solid.vertices.extend([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
            solid.faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    solid
}

/// Two cones of long thin triangles, base to base.
fn spindle(sides: usize) -> Solid {
    let angle = |i: usize| std::f32::consts::TAU * i as f32 / sides as f32;
    let mut vertices: Vec<Vec3> = (0..sides).map(|i| vec3(angle(i).cos(), 0.0, angle(i).sin())).collect();
    vertices.extend([vec3(0.0, 300.0, 0.0), vec3(0.0, -0.01, 0.0)]);
    let faces = (0..2 * sides).map(|i| [i / 2, (i / 2 + 1) % sides, sides + i % 2]).collect();
    Solid { name: "spindle", vertices, faces, centre: vec3(0.0, 0.1, 0.0) }
}

fn solids() -> Vec<Solid> {
    let mut numbers = Numbers(1);
    let far = vec3(1000.0, -1000.0, 1000.0);
    vec![
        octahedron(),
        cube(1),
        cube(5),
        cube(3).placed("cube far off", 0.37, far),
        sphere(2),
        sphere(5),
        sphere(4).placed("sphere far off", 1.0, far),
        sphere(3).placed("tiny sphere", 1e-6, Vec3::ZERO),
        sphere(3).placed("huge sphere", 1e6, Vec3::ZERO),
        sphere(4).moved("rock", |v| v * (0.6 + 0.4 * numbers.unit())),
        sphere(4).moved("disc", |v| vec3(v.x, v.y * 1e-3, v.z)),
        spindle(40),
        spindle(500),
    ]
}

/// A point of the surface on which triangles meet.
fn seam(solid: &Solid, numbers: &mut Numbers) -> Vec3 {
    let face = numbers.pick(&solid.faces);
    let side = numbers.below(3);
    let (a, b) = (solid.vertices[face[side]], solid.vertices[face[(side + 1) % 3]]);
    let along = if numbers.below(2) == 0 { 0.0 } else { numbers.unit() };
    (b - a).mul_add(along, a)
}

/// Through a seam and on towards a point inside, so that the surface cannot be grazed from outside.
fn from_outside(solid: &Solid, numbers: &mut Numbers) -> Ray {
    let target = seam(solid, numbers);
    let outwards = target - solid.centre;
    let origin = outwards.mul_add(numbers.pick(&[0.25, 1.0, 7.0, 100.0]), target);
    Ray::new(origin, (target - origin) * numbers.pick(&[1.0, 1.0, 0.013]))
}

fn from_inside(solid: &Solid, numbers: &mut Numbers) -> Ray {
    let direction = match numbers.below(3) {
        0 => numbers.point(),
        1 => vec3(0.0, numbers.pick(&[1.0, -1.0]), numbers.pick(&[0.0, 1.0, -1.0])),
        _ => seam(solid, numbers) - solid.centre,
    };
    Ray::new(solid.centre, direction)
}

/// Rays of `aim` that hit nothing.
fn lost(solid: &Solid, accel: &Accel, rays: u64, aim: fn(&Solid, &mut Numbers) -> Ray) -> usize {
    let is_lost = |seed: u64| {
        let ray = aim(solid, &mut Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        accel.occlusion(&ray, &mut Uncounted) == Occlusion::Clear
    };
    (0..rays).into_par_iter().filter(|&seed| is_lost(seed)).count()
}

#[test]
fn closed_meshes_let_no_ray_pass() {
    for solid in solids() {
        for accel in every_structure(&solid.triangles()) {
            // Brute force tests everything: fewer rays say as much, since the triangles' test is the same.
            let rays = if accel.kind() == raywarp::accel::AccelKind::Brute { 2_000 } else { 60_000 };
            for (from, aim) in [("outside", from_outside as fn(&_, &mut _) -> _), ("inside", from_inside)] {
                let lost = lost(&solid, &accel, rays, aim);
                assert_eq!(lost, 0, "{} of {rays} rays from {from} lost in {}, {}", lost, solid.name, accel.kind());
            }
        }
    }
}
