//! No ray passes between two triangles of a closed mesh.
//!
//! Rays are aimed from outside at points on edges and at vertices, where the test of each triangle alone is a toss-up,
//! and must hit it there: in a closed mesh the far side would hide a gap. From inside none may escape.

use std::collections::HashMap;

use crate::common::{every_structure, Numbers};
use rayon::prelude::*;
use raywarp::accel::{Accel, AccelKind};
use raywarp_core::math::{vec3, Vec3};
use raywarp_core::ray::Ray;
use raywarp_core::traversal::{NullStatistics, Occlusion};
use raywarp_core::triangle::Triangle;

/// A closed surface, star-shaped around a point inside.
struct Solid {
    name: &'static str,
    vertices: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    centre: Vec3,
    /// Distance of the coordinates that vertices and origins are rounded to, or 0. Where there is one, the difference of
    /// two points is exact: the ray meets the target itself, and every sign there hangs on rounding.
    lattice: f32,
}

impl Solid {
    fn snap(&self, v: Vec3) -> Vec3 {
        let [x, y, z] =
            v.to_array().map(|x| if self.lattice > 0.0 { (x / self.lattice).round() * self.lattice } else { x });
        vec3(x, y, z)
    }

    fn snapped(mut self, name: &'static str) -> Self {
        self.lattice = 1.0 / 4_194_304.0;
        self.vertices = self.vertices.iter().map(|&v| self.snap(v)).collect();
        Self { name, ..self }
    }

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
    Solid { name: "octahedron", vertices, faces, centre: Vec3::ZERO, lattice: 0.0 }
}

/// Each face in four, `levels` times, vertices on the unit sphere.
fn sphere(levels: usize) -> Solid {
    let mut solid = octahedron();
    for _ in 0..levels {
        let mut middles = HashMap::new();
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

/// Every side of `n` by `n` squares, each in four triangles around a point within.
fn cube(n: usize) -> Solid {
    let mut solid = Solid { name: "cube", vertices: Vec::new(), faces: Vec::new(), centre: Vec3::ZERO, lattice: 0.0 };
    let at = |i: f32| i * 2.0 / n as f32 - 1.0;
    let mut numbers = Numbers(n as u64);
    for side in 0..6 {
        let point = |i: f32, j: f32| {
            let (end, a, b) = (if side % 2 == 0 { 1.0 } else { -1.0 }, at(i), at(j));
            [vec3(end, a, b), vec3(a, end, b), vec3(a, b, end)][side / 2]
        };
        for (i, j) in (0..n * n).map(|k| ((k % n) as f32, (k / n) as f32)) {
            let first = solid.vertices.len();
            let middle = point(i + 0.2 + 0.6 * numbers.unit(), j + 0.2 + 0.6 * numbers.unit());
            solid.vertices.extend([point(i, j), point(i + 1.0, j), point(i + 1.0, j + 1.0), point(i, j + 1.0), middle]);
            solid.faces.extend([0, 1, 2, 3].map(|k| [first + k, first + (k + 1) % 4, first + 4]));
        }
    }
    solid
}

/// Each face in three: its middle is a vertex of three triangles.
fn starred(mut solid: Solid) -> Solid {
    for [a, b, c] in std::mem::take(&mut solid.faces) {
        let [p, q, r] = [a, b, c].map(|i| solid.vertices[i]);
        let middle = solid.vertices.len();
        solid.vertices.push((p + q + r) / 3.0);
        solid.faces.extend([[a, b, middle], [b, c, middle], [c, a, middle]]);
    }
    solid
}

/// Two cones of long thin triangles, base to base.
fn spindle(sides: usize) -> Solid {
    let angle = |i: usize| std::f32::consts::TAU * i as f32 / sides as f32;
    let mut vertices: Vec<Vec3> = (0..sides).map(|i| vec3(angle(i).cos(), 0.0, angle(i).sin())).collect();
    vertices.extend([vec3(0.0, 30.0, 0.0), vec3(0.0, -0.01, 0.0)]);
    let faces = (0..2 * sides).map(|i| [i / 2, (i / 2 + 1) % sides, sides + i % 2]).collect();
    Solid { name: "spindle", vertices, faces, centre: vec3(0.0, 0.1, 0.0), lattice: 0.0 }
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
        starred(sphere(1)).moved("star", |v| v),
        starred(cube(2)).placed("cube of threes", 1.7, vec3(0.1, 0.2, 0.3)),
        cube(4).snapped("cube on a lattice"),
        sphere(3).snapped("sphere on a lattice"),
        starred(sphere(2)).snapped("star on a lattice"),
        starred(cube(2)).snapped("cube of threes on a lattice"),
        spindle(40),
        spindle(500),
    ]
}

/// Faces by their corners: where a ray must be seen to enter.
struct Seams<'a> {
    solid: &'a Solid,
    around: HashMap<[u32; 3], Vec<usize>>,
}

fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(|x| (x + 0.0).to_bits())
}

impl<'a> Seams<'a> {
    fn new(solid: &'a Solid) -> Self {
        let mut around = HashMap::<_, Vec<usize>>::new();
        for (i, face) in solid.faces.iter().enumerate() {
            face.iter().for_each(|&corner| around.entry(bits(solid.vertices[corner])).or_default().push(i));
        }
        Self { solid, around }
    }

    /// A point on which triangles meet, and those triangles.
    fn pick(&self, numbers: &mut Numbers) -> (Vec3, Vec<usize>) {
        let (face, side) = (numbers.pick(&self.solid.faces), numbers.below(3));
        let (a, b) = (self.solid.vertices[face[side]], self.solid.vertices[face[(side + 1) % 3]]);
        let mut faces = self.around[&bits(a)].clone();
        if numbers.below(2) == 0 {
            return (a, faces);
        }
        faces.retain(|i| self.around[&bits(b)].contains(i));
        // Not too near the ends: at the tip of a needle rounding the target can move it out.
        (self.solid.snap((b - a).mul_add(0.1 + 0.8 * numbers.unit(), a)), faces)
    }

    /// Whether a direction leads well into the solid through a face.
    fn enters(&self, face: usize, direction: Vec3) -> bool {
        let [a, b, c] = self.solid.faces[face].map(|i| self.solid.vertices[i]);
        let normal = (b - a).cross(c - a).normalize();
        let outwards = if normal.dot(a - self.solid.centre) < 0.0 { -normal } else { normal };
        outwards.dot(direction.normalize()) < -0.05
    }
}

/// Through a seam all of whose triangles face it: what is beyond is inside, however the target was rounded.
fn from_outside(seams: &Seams, numbers: &mut Numbers) -> Option<Ray> {
    let (target, faces) = seams.pick(numbers);
    let size = (target - seams.solid.centre).length();
    let aside = numbers.point() * (size * numbers.pick(&[0.0, 1.0, 1.0]));
    let origin = (target - seams.solid.centre + aside).mul_add(numbers.pick(&[0.25, 1.0, 7.0, 30.0]), target);
    let origin = seams.solid.snap(origin);
    let direction = target - origin;
    let enters = faces.iter().all(|&face| seams.enters(face, direction));
    let speed = numbers.pick(&[1.0, 1.0, 0.013]);
    // It ends where rounding and a grazing angle could have moved the surface: the far side would hide a gap.
    let rounding = origin.max_abs().max(target.max_abs()) / direction.max_abs() / 16_777_216.0;
    enters.then(|| Ray { t_max: (1.0 + 100.0 * rounding) / speed, ..Ray::new(origin, direction * speed) })
}

fn from_inside(seams: &Seams, numbers: &mut Numbers) -> Option<Ray> {
    let direction = match numbers.below(3) {
        0 => numbers.point(),
        1 => vec3(0.0, numbers.pick(&[1.0, -1.0]), numbers.pick(&[0.0, 1.0, -1.0])),
        _ => seams.pick(numbers).0 - seams.solid.centre,
    };
    Some(Ray::new(seams.solid.centre, direction))
}

type Aim = fn(&Seams, &mut Numbers) -> Option<Ray>;

/// How many rays were traced, and how many of them hit nothing.
fn lost(seams: &Seams, accel: &Accel, rays: u64, aim: Aim) -> (usize, usize) {
    let trace = |seed: u64| {
        let ray = aim(seams, &mut Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)))?;
        Some((1, (accel.occlusion(&ray, &mut NullStatistics) == Occlusion::Clear) as usize))
    };
    (0..rays).into_par_iter().filter_map(trace).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

#[test]
fn closed_meshes_let_no_ray_pass() {
    let mut total = 0;
    for solid in solids() {
        let seams = Seams::new(&solid);
        for accel in every_structure(&solid.triangles()) {
            // Brute force tests everything: fewer rays say as much, since the triangles' test is the same.
            let rays = if accel.kind() == AccelKind::Brute { 2_000 } else { 60_000 };
            for (from, aim) in [("outside", from_outside as Aim), ("inside", from_inside)] {
                let (traced, lost) = lost(&seams, &accel, rays, aim);
                assert!(traced as u64 * 4 > rays, "{traced} of {rays} from {from} are of use, {}", solid.name);
                assert_eq!(lost, 0, "of {traced} rays from {from}, {}, {}", solid.name, accel.kind());
                total += traced;
            }
        }
    }
    assert!(total > 2_000_000, "{total}");
}
