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

/// Bound of the rounding error of each determinant below, in units of `|d| |s| |e|` in the maximum norm: six products
/// of three factors, each factor and product and sum rounded, which is at most 6 * 7 roundings of 2^-24.
const ROUNDING: f32 = 42.0 / 16_777_216.0;

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
    /// u, v or w is too close to zero to trust its sign, [`decide`](Self::decide) does: there neighbours compute the
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
        let doubt = ROUNDING * d.max_abs() * self.extent * arch::max(s.max_abs(), self.extent);
        let least = arch::min(arch::min(u, v), w);
        if least < -doubt {
            return None;
        }
        if least > doubt {
            let inverse = 1.0 / det.abs();
            let t = e2.dot(q) * sign * inverse;
            return Some(Hit { t, u: u * inverse, v: v * inverse, primitive: self.primitive });
        }
        // Copies, so that only this rare case has the two in memory and not in registers.
        let (triangle, ray) = (*self, *ray);
        triangle.decide(&ray)
    }

    /// The same question in double precision, symmetrically: each edge function is a determinant of the direction and
    /// the two ends seen from the origin, so that the neighbour's is its exact negative, and zero counts as inside.
    #[cold]
    #[inline(never)]
    fn decide(&self, ray: &Ray) -> Option<Hit> {
        let d = double(ray.direction);
        let [a, b, c] = [self.v0, self.v1, self.v2].map(|v| subtract(double(v), double(ray.origin)));
        let (u, v, w) = (triple(d, c, b), triple(d, a, c), triple(d, b, a));
        let det = u + v + w;
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        if !inside || det == 0.0 {
            return None;
        }
        let (u, v, w) = (u / det, v / det, w / det);
        let point = [0, 1, 2].map(|i| u * a[i] + v * b[i] + w * c[i]);
        let t = (dot(point, d) / dot(d, d)) as f32;
        (t.abs() < f32::INFINITY).then_some(Hit { t, u: v as f32, v: w as f32, primitive: self.primitive })
    }
}

type Double = [f64; 3];

#[inline(always)]
fn double(v: Vec3) -> Double {
    [v.x as f64, v.y as f64, v.z as f64]
}

#[inline(always)]
fn subtract(a: Double, b: Double) -> Double {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: Double, b: Double) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `d . (a x b)`, without fused operations: exchanging `a` and `b` then negates it exactly.
#[inline(always)]
fn triple(d: Double, a: Double, b: Double) -> f64 {
    dot(d, [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
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

    #[test]
    fn edges_and_corners_are_inside_and_beyond_is_outside() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.0, 0.5)] {
            assert!(unit().intersect(&down(x, y)).is_some(), "({x}, {y})");
        }
        for (x, y) in [(-1e-6, 0.5), (0.5, -1e-6), (0.500001, 0.500001), (1.000001, 0.0)] {
            assert!(unit().intersect(&down(x, y)).is_none(), "({x}, {y})");
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
