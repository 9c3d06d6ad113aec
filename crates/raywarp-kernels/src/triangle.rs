//! The ray-triangle test: Möller and Trumbore 1997, made watertight.

use crate::arch;
use crate::math::Vec3;
use crate::ray::{Hit, Ray};

/// What a triangle lets through, as bits of [`Triangle::flags`].
pub mod flags {
    /// Some of it may be missing (cut out by a texture): a hit must ask the material whether it counts.
    pub const CUTOUT: u32 = 1;
    /// It lets light through: a shadow ray that meets it is filtered, not stopped.
    pub const TRANSPARENT: u32 = 2;
}

/// A triangle as traversal reads it: by value, in the order of the leaves.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Vertex 0.
    pub v0: Vec3,
    /// Vertex 1.
    pub v1: Vec3,
    /// Vertex 2.
    pub v2: Vec3,
    /// Index of the triangle in the scene.
    pub primitive: u32,
    /// See [`flags`].
    pub flags: u32,
    /// Largest component of any edge: the scale of the rounding errors, see [`Triangle::intersect`].
    pub extent: f32,
}

/// How far from zero u, v and w must be for their sign to be that of the exact value, in units of the largest product
/// of three factors. Counted in roundings, of 2^-24 each:
/// - a determinant is six such products, rounded in the edge and in `s` (2 each), in the vector product (1 or 2) and in
///   the scalar product (1 to 3): 6 * (2 + 1.5 + 2) = 33;
/// - w sums three determinants, and the sum of two of them, at most 12 products, is rounded: 3 * 33 + 12 = 111;
/// - `decide` moves each corner by a rounding of its distance from the ray, at most two edges if it
///   then finds the ray inside: 2 products of 2 factors, each 2 * 2: 16.
///
/// The last lets neighbours disagree on nothing: a triangle that `decide` would accept is never refused without it.
const ROUNDING: f32 = 128.0 / 16_777_216.0;

/// Doubt for each unit of distance or direction: below 2^-126 a rounding of the product of two factors is not relative,
/// but at most 2^-149, to be multiplied by the third.
const VANISHING: f32 = f32::from_bits((127 - 120) << 23);

impl Triangle {
    /// From its corners; any floats are legal, a triangle with NaN or without area is never hit.
    pub fn new(v0: Vec3, v1: Vec3, v2: Vec3, primitive: u32, flags: u32) -> Self {
        let extent = arch::max(arch::max((v1 - v0).max_abs(), (v2 - v0).max_abs()), (v2 - v1).max_abs());
        Self { v0, v1, v2, primitive, flags, extent }
    }

    /// Where the ray meets the triangle, from either side, whatever the ray's `t_min` and `t_max`.
    ///
    /// Möller and Trumbore solve `s = t(-d) + u e1 + v e2` with `s = o - v0` by Cramer's rule. In single precision two
    /// triangles round the determinants of a shared edge differently, and a ray could pass between them. So where
    /// u, v or w is too close to zero to trust its sign, `decide` does: there neighbours compute the
    /// shared edge from the same numbers and cannot both say no.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let (d, s) = (ray.direction, ray.origin - self.v0);
        let (e1, e2) = (self.v1 - self.v0, self.v2 - self.v0);
        let p = d.cross(e2);
        let det = e1.dot(p);
        let sign = f32::from_bits(det.to_bits() & 0x8000_0000 | 0x3f80_0000);
        let u = s.dot(p) * sign;
        let q = s.cross(e1);
        let v = d.dot(q) * sign;
        let w = det.abs() - u - v;
        let (length, distance) = (d.max_abs(), arch::max(s.max_abs(), self.extent));
        // In this order it overflows before anything above does: then nothing is certain.
        let largest = 8.0 * self.extent * distance * length;
        let doubt = arch::fma(largest, ROUNDING / 8.0, VANISHING * (length + distance + 1.0));
        let least = arch::min(arch::min(u, v), w);
        if least < -doubt {
            return None;
        }
        if least > doubt {
            let inverse = 1.0 / det.abs();
            // Scaled first: `e2 . q` vanishes for triangles of 1e-13.
            let t = e2.dot(q * (sign * inverse));
            return Some(Hit { t, u: u * inverse, v: v * inverse, primitive: self.primitive });
        }
        // Copies, so that only this rare case has the two in memory and not in registers.
        let (triangle, ray) = (*self, *ray);
        triangle.decide(&ray)
    }

    /// The same question in the plane across the ray, after Woop, Benthin and Wald 2013.
    ///
    /// The corners are sheared along the ray and rounded to single precision, each by itself, so that every triangle of
    /// a mesh sees the same ones. In the plane the products of two coordinates are then exact in double precision and
    /// so are the signs of the edge functions: the mesh of rounded corners has no gaps. A ray that runs exactly through
    /// an edge or a corner belongs to one of the triangles on both sides, as a point does when polygons are filled: it
    /// is filtered, mixed and counted once.
    #[cold]
    #[inline(never)]
    fn decide(&self, ray: &Ray) -> Option<Hit> {
        let plane = Across::new(ray);
        let [a, b, c] = [self.v0, self.v1, self.v2].map(|v| plane.project(v));
        let (w, u, v) = (edge(b, c), edge(c, a), edge(a, b));
        let det = u + v + w;
        let inside = owns(w, b, c, det) && owns(u, c, a, det) && owns(v, a, b, det);
        if !inside || det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        let t = ((w * a.t + u * b.t + v * c.t) * inverse) as f32;
        let (u, v) = ((u * inverse) as f32, (v * inverse) as f32);
        let finite = t.abs() < f32::INFINITY && ray.direction.max_abs() < f32::INFINITY;
        finite.then_some(Hit { t, u, v, primitive: self.primitive })
    }
}

/// Four triangles, a component of all four after the other.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Four {
    /// x, y and z of the four vertices 0, then of vertices 1 and 2.
    pub corners: [[[f32; 4]; 3]; 3],
    /// See [`Triangle::primitive`].
    pub primitive: [u32; 4],
    /// See [`flags`].
    pub flags: [u32; 4],
    /// See [`Triangle::extent`].
    pub extent: [f32; 4],
}

impl Four {
    /// Of up to four triangles. Places that are left have points of primitive [`MISS`](crate::ray::MISS).
    pub fn new(triangles: &[Triangle]) -> Self {
        let mut four =
            Self { corners: [[[0.0; 4]; 3]; 3], primitive: [crate::ray::MISS; 4], flags: [0; 4], extent: [0.0; 4] };
        for (lane, triangle) in triangles.iter().take(4).enumerate() {
            for (corner, vertex) in [triangle.v0, triangle.v1, triangle.v2].into_iter().enumerate() {
                (0..3).for_each(|axis| four.corners[corner][axis][lane] = vertex.to_array()[axis]);
            }
            four.primitive[lane] = triangle.primitive;
            four.flags[lane] = triangle.flags;
            four.extent[lane] = triangle.extent;
        }
        four
    }

    /// One of them, of the four.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> Triangle {
        let lane = lane & 3;
        let corner = |c: &[[f32; 4]; 3]| Vec3::new(c[0][lane], c[1][lane], c[2][lane]);
        let [v0, v1, v2] = &self.corners;
        Triangle {
            v0: corner(v0),
            v1: corner(v1),
            v2: corner(v2),
            primitive: self.primitive[lane],
            flags: self.flags[lane],
            extent: self.extent[lane],
        }
    }

    /// Bit `i` is 0 where [`Triangle::intersect`] refuses triangle `i` at once; where it is 1 it has to be asked. The same
    /// operations, on four numbers at a time; what NaN makes of the least weight only leads to asking.
    #[inline(always)]
    pub fn may_be_hit(&self, ray: &Ray) -> u32 {
        let (mut certain, mut least) = ([0.0; 8], [0.0; 8]);
        for i in 0..4 {
            let t = self.triangle(i);
            let (d, s) = (ray.direction, ray.origin - t.v0);
            let (e1, e2) = (t.v1 - t.v0, t.v2 - t.v0);
            let p = d.cross(e2);
            let det = e1.dot(p);
            let sign = f32::from_bits(det.to_bits() & 0x8000_0000 | 0x3f80_0000);
            let u = s.dot(p) * sign;
            let v = d.dot(s.cross(e1)) * sign;
            let w = det.abs() - u - v;
            let length = d.max_abs();
            let distance = larger(larger(larger(s.x.abs(), s.y.abs()), s.z.abs()), t.extent);
            let largest = 8.0 * t.extent * distance * length;
            let doubt = arch::fma(largest, ROUNDING / 8.0, VANISHING * (length + distance + 1.0));
            // A step beyond, since `at_most` takes in what is equal; and infinite doubt stays below every weight.
            certain[i] = doubt * -(1.0 + f32::EPSILON);
            least[i] = larger(f32::MIN, smaller(smaller(u, v), w));
        }
        !arch::at_most(&least, &certain) & 15
    }
}

/// As [`arch::max`], but `b` where one is NaN: one instruction of a vector.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b {
        a
    } else {
        b
    }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b {
        a
    } else {
        b
    }
}

/// A ray as an axis: points are told by where they lie along it and across it.
struct Across {
    /// The direction's largest component and the two others.
    axes: [u32; 3],
    origin: Vec3,
    inverse: f64,
    /// Of the two other components to the largest.
    slope: [f64; 2],
}

/// A point along and across a ray.
#[derive(Clone, Copy)]
struct Projected {
    t: f64,
    /// In single precision.
    x: f64,
    y: f64,
}

impl Across {
    fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
        let axes = match (x >= y && x >= z, y >= z) {
            (true, _) => [0, 1, 2],
            (false, true) => [1, 2, 0],
            (false, false) => [2, 0, 1],
        };
        let inverse = 1.0 / d[axes[0]] as f64;
        let slope = [d[axes[1]] as f64 * inverse, d[axes[2]] as f64 * inverse];
        Self { axes, origin: ray.origin, inverse, slope }
    }

    fn project(&self, point: Vec3) -> Projected {
        let from_origin = |axis: u32| point[axis] as f64 - self.origin[axis] as f64;
        let along = from_origin(self.axes[0]);
        let across = |i: usize| (from_origin(self.axes[i + 1]) - self.slope[i] * along) as f32 as f64;
        Projected { t: along * self.inverse, x: across(0), y: across(1) }
    }
}

/// Twice the area between the ray and two points; of the right sign, and negated by exchanging them.
fn edge(a: Projected, b: Projected) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Whether the ray is on the inner side of an edge of a triangle with twice the area `det`; if it is on the edge,
/// whether the edge runs upwards, or level and to the right, with the triangle to its left: the neighbour sees it
/// run the other way.
fn owns(edge: f64, from: Projected, to: Projected, det: f64) -> bool {
    let turn = if det < 0.0 { -1.0 } else { 1.0 };
    let (x, y) = ((to.x - from.x) * turn, (to.y - from.y) * turn);
    edge * turn > 0.0 || (edge == 0.0 && (y > 0.0 || (y == 0.0 && x > 0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    fn unit() -> Triangle {
        Triangle::new(vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), 7, 0)
    }

    fn down(x: f32, y: f32) -> Ray {
        Ray::new(vec3(x, y, 2.0), vec3(0.0, 0.0, -1.0))
    }

    #[test]
    fn barycentrics_weigh_vertices_one_and_two() {
        let hit = unit().intersect(&down(0.5, 0.25)).unwrap();
        assert_eq!((hit.t, hit.u, hit.v, hit.primitive), (2.0, 0.5, 0.25, 7));
    }

    #[test]
    fn both_sides_are_hit() {
        let up = Ray::new(vec3(0.25, 0.25, -3.0), vec3(0.0, 0.0, 2.0));
        let hit = unit().intersect(&up).unwrap();
        assert_eq!((hit.t, hit.u, hit.v), (1.5, 0.25, 0.25));
    }

    /// The other half of the square that `unit` is a half of.
    fn other_half() -> Triangle {
        Triangle::new(vec3(1.0, 1.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(1.0, 0.0, 0.0), 8, 0)
    }

    #[test]
    fn a_shared_edge_belongs_to_one_triangle_and_beyond_is_outside() {
        for x in 1..64 {
            let ray = down(x as f32 / 64.0, 1.0 - x as f32 / 64.0);
            let hits = [unit(), other_half()].iter().filter(|t| t.intersect(&ray).is_some()).count();
            assert_eq!(hits, 1, "{ray:?}");
        }
        for (x, y) in [(-1e-6, 0.5), (0.5, -1e-6), (0.500001, 0.500001), (1.000001, 0.0)] {
            assert!(unit().intersect(&down(x, y)).is_none(), "({x}, {y})");
        }
    }

    #[test]
    fn a_shared_corner_belongs_to_one_triangle() {
        // A fan around the origin, seen from above: its middle is hit once, whichever way the triangles are wound.
        let rim = [(2.0, 1.0), (-1.0, 3.0), (-2.0, -1.0), (0.5, -2.0)].map(|(x, y)| vec3(x, y, 0.0));
        for flipped in 0..16u32 {
            let hits = (0..4).filter(|&i| {
                let (a, b) = (rim[i], rim[(i + 1) % 4]);
                let (a, b) = if flipped >> i & 1 == 0 { (a, b) } else { (b, a) };
                Triangle::new(Vec3::ZERO, a, b, 0, 0).intersect(&down(0.0, 0.0)).is_some()
            });
            assert_eq!(hits.count(), 1, "{flipped:04b}");
        }
    }

    #[test]
    fn degenerate_input_is_a_miss() {
        let point = Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 0, 0);
        assert!(point.intersect(&down(0.0, 0.0)).is_none());
        let nan = Triangle::new(vec3(f32::NAN, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), 0, 0);
        assert!(nan.intersect(&down(0.2, 0.2)).is_none());
        assert!(unit().intersect(&Ray::new(vec3(0.2, 0.2, 1.0), Vec3::ZERO)).is_none());
        assert!(unit().intersect(&down(f32::NAN, 0.2)).is_none());
        let edge_on = Ray::new(vec3(-1.0, 0.25, 0.0), vec3(1.0, 0.0, 0.0));
        assert!(unit().intersect(&edge_on).is_none());
    }
}
