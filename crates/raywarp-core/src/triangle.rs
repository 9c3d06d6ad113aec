//! The ray-triangle test: the determinants of Möller and Trumbore 1997, made watertight after Woop, Benthin and Wald 2013.
//!
//! Möller and Trumbore solve `origin + t direction = (1 - u - v) v0 + u v1 + v v2` by Cramer's rule. In single precision
//! two triangles round the determinants of a shared edge differently, and a ray passes between them. Here the corners are
//! first sheared along the ray and rounded, each by itself, so that every triangle of a mesh sees the same ones. The ray
//! is then the axis `x = y = 0`, each determinant is the difference of two products, and its sign is found exactly: the
//! mesh of rounded corners has no gaps.

use crate::arch;
use crate::math::{vec3, Vec3};
use crate::ray::{Hit, Ray};

/// What a triangle lets through, as bits of [`Triangle::flags`].
pub mod flags {
    /// Some of it may be missing (cut out by a texture): a hit must ask the material whether it counts.
    pub const CUTOUT: u32 = 1;
    /// It lets light through: a shadow ray that meets it is filtered, not stopped.
    pub const TRANSPARENT: u32 = 2;
}

/// A ray as an axis, without ends: it is made once and asked about many triangles.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
pub struct RayShear {
    /// Where the ray begins.
    pub(crate) origin: Vec3,
    /// Give the two coordinates across the ray of a point relative to its origin.
    x: Vec3,
    y: Vec3,
    /// Gives the coordinate along it, in units of the direction.
    along: Vec3,
}

impl RayShear {
    /// Shears along the largest component of the direction. A direction that is zero, infinite or NaN meets nothing.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let (ax, ay, az) = (d.x.abs(), d.y.abs(), d.z.abs());
        let along_x = ax >= ay && ax >= az;
        let along_y = !along_x && ay >= az;
        let select = |x, y, z| {
            if along_x {
                x
            } else if along_y {
                y
            } else {
                z
            }
        };
        let largest: f32 = select(d.x, d.y, d.z);
        let inverse = if largest.abs() < f32::INFINITY { arch::reciprocal(largest) } else { f32::NAN };
        let (a, b) = (-select(d.y, d.z, d.x) * inverse, -select(d.z, d.x, d.y) * inverse);
        Self {
            origin: ray.origin,
            x: vec3(select(a, 0.0, 1.0), select(1.0, a, 0.0), select(0.0, 1.0, a)),
            y: vec3(select(b, 1.0, 0.0), select(0.0, b, 1.0), select(1.0, 0.0, b)),
            along: vec3(select(inverse, 0.0, 0.0), select(0.0, inverse, 0.0), select(0.0, 0.0, inverse)),
        }
    }
}

impl RayShear {
    /// Of a point relative to the ray's origin.
    #[inline(always)]
    pub(crate) fn flatten(&self, point: Vec3) -> Flat {
        Flat { x: point.dot(self.x), y: point.dot(self.y) }
    }
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
    /// Index of the triangle in its mesh.
    pub primitive: u32,
    /// See [`flags`].
    pub flags: u32,
    /// Index of the instance in the scene, for a triangle in world space; of no meaning in the space of a mesh.
    pub instance: u32,
}

/// An edge function closer to zero than this may have lost its sign to underflow: below it a product is not rounded
/// relative to itself.
pub(crate) const TINY: f32 = f32::MIN_POSITIVE;

/// Sums of edge functions from here on are no longer sure to have a normal inverse.
const LARGE: f32 = f32::from_bits((127 + 125) << 23);

/// What a box leaves around a triangle, in units of its extent.
pub const MARGIN: f32 = 4.0 / 16_777_216.0;

/// A box with the margin for a triangle of some extent, all or part of which is in it.
#[inline(always)]
pub fn padded(low: Vec3, high: Vec3, extent: f32) -> (Vec3, Vec3) {
    let margin = extent * MARGIN;
    let down = |x: f32| arch::max(arch::min(x - margin, x.next_down()), -f32::MAX);
    let up = |x: f32| arch::min(arch::max(x + margin, x.next_up()), f32::MAX);
    (vec3(down(low.x), down(low.y), down(low.z)), vec3(up(high.x), up(high.y), up(high.z)))
}

impl Triangle {
    /// From its corners, of instance 0; any floats are legal, a triangle with NaN or without area is never hit.
    pub fn new(v0: Vec3, v1: Vec3, v2: Vec3, primitive: u32, flags: u32) -> Self {
        Self { v0, v1, v2, primitive, flags, instance: 0 }
    }

    /// Largest component of any edge: the scale by which boxes are padded.
    #[inline(always)]
    pub fn extent(&self) -> f32 {
        let edges = [self.v1 - self.v0, self.v2 - self.v0, self.v2 - self.v1];
        arch::max(arch::max(edges[0].max_abs(), edges[1].max_abs()), edges[2].max_abs())
    }

    /// Low and high corner of the box around every point where a ray may be found to hit the triangle; finite, whatever
    /// the triangle.
    ///
    /// That is a little more than its corners: the test rounds them, by up to 2^-23 of the triangle's extent across the
    /// ray. And it makes every box contain its faces beyond doubt, so that a ray which runs in one enters it.
    #[inline(always)]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let (low, high) = (self.v0.min(self.v1).min(self.v2), self.v0.max(self.v1).max(self.v2));
        padded(low, high, self.extent())
    }

    /// Where the ray meets the triangle, from either side, whatever the ray's `t_min` and `t_max`.
    ///
    /// A ray that runs exactly through an edge or a corner belongs to one of the triangles on both sides, as a point
    /// does when polygons are filled: it is filtered, mixed and counted once.
    #[inline(always)]
    pub fn intersect(&self, shear: &RayShear) -> Option<Hit> {
        let mut met = None;
        self.if_hit(shear, |hit| met = Some(hit));
        met
    }

    /// Gives `then` what [`intersect`](Self::intersect) answers, if it is a hit. For loops over triangles: most are missed,
    /// and an answer that says so would be moved between registers for each.
    #[inline(always)]
    pub fn if_hit(&self, shear: &RayShear, then: impl FnOnce(Hit)) {
        let origin = shear.origin;
        let (p, q, r) = (self.v0 - origin, self.v1 - origin, self.v2 - origin);
        let (a, b, c) = (shear.flatten(p), shear.flatten(q), shear.flatten(r));
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        // As integers: the smallest, or of negative ones that closest to zero; the largest, or the most negative.
        let (low, high) = (least(least(u, v), w), greatest(greatest(u, v), w));
        // One branch, or two where nothing is left undecided: hence no `&&`.
        if (low < -TINY) & (high > TINY) {
            return;
        }
        let certain = ((low > TINY) | ((low < -TINY) & (high < 0.0))) & ((u + v + w).abs() < LARGE);
        let (u, v, w, inverse);
        if certain {
            // Needles need every bit: their edge functions are small beside the products.
            (u, v, w) = (exact_edge(c, b), exact_edge(a, c), exact_edge(b, a));
            inverse = arch::reciprocal(u + v + w);
        } else if let Some(edges) = decide(a, b, c) {
            [u, v, w] = edges;
            inverse = 1.0 / (u + v + w);
        } else {
            return;
        }
        // Weights first: they are at most 1, whatever the units.
        let (u, v, w) = (u * inverse, v * inverse, w * inverse);
        let along = |v: Vec3| v.dot(shear.along);
        let t = arch::fma(u, along(p), arch::fma(v, along(q), w * along(r)));
        then(Hit { t, u: v, v: w, primitive: self.primitive, instance: self.instance });
    }

    /// Möller and Trumbore's own form, as in the paper: Cramer's rule on `s = t(-d) + u e1 + v e2`.
    ///
    /// It differs from [`intersect`](Self::intersect) by roundings, which for a small triangle far away are large, and
    /// rays slip through edges. Kept as the paper's and as a check; nothing renders with it.
    pub fn moller_trumbore(&self, ray: &Ray) -> Option<Hit> {
        let (d, s) = (ray.direction, ray.origin - self.v0);
        let (e1, e2) = (self.v1 - self.v0, self.v2 - self.v0);
        let p = d.cross(e2);
        let q = s.cross(e1);
        let inverse = 1.0 / e1.dot(p);
        let (u, v) = (s.dot(p) * inverse, d.dot(q) * inverse);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        let (primitive, instance) = (self.primitive, self.instance);
        inside.then(|| Hit { t: e2.dot(q) * inverse, u, v, primitive, instance })
    }
}

/// A corner in the plane across the ray.
#[derive(Clone, Copy)]
pub(crate) struct Flat {
    x: f32,
    y: f32,
}

/// Twice the area between the ray and two corners. As the difference of two rounded products it is zero or has the sign
/// of the exact one.
#[inline(always)]
pub(crate) fn edge(a: Flat, b: Flat) -> f32 {
    a.x * b.y - a.y * b.x
}

/// The edge functions where one of them is zero, has vanished or has overflowed; none where the ray is outside.
#[cold]
#[inline(always)]
fn decide(a: Flat, b: Flat, c: Flat) -> Option<[f32; 3]> {
    let largest = [a, b, c].iter().fold(0.0, |m, p| arch::max(m, arch::max(p.x.abs(), p.y.abs())));
    let finite = [a, b, c].iter().all(|p| p.x.abs() < f32::INFINITY && p.y.abs() < f32::INFINITY);
    if !finite {
        return None;
    }
    // A power of two that brings the largest coordinate close to 1: nothing that counts vanishes or overflows then.
    let exponent = largest.to_bits() >> 23;
    let scale = f32::from_bits((if exponent < 253 { 254 - exponent } else { 1 }) << 23);
    let [a, b, c] = [a, b, c].map(|p| Flat { x: p.x * scale, y: p.y * scale });
    let (u, v, w) = (exact_edge(c, b), exact_edge(a, c), exact_edge(b, a));
    let det = u + v + w;
    let inside = owns(u, c, b, det) && owns(v, a, c, det) && owns(w, b, a, det);
    (inside && det != 0.0).then_some([u, v, w])
}

/// An edge function with what the products were rounded by: right to its last bits, and zero only on the edge.
#[inline(always)]
fn exact_edge(a: Flat, b: Flat) -> f32 {
    let (p, q) = (a.x * b.y, a.y * b.x);
    (p - q) + (arch::fma(a.x, b.y, -p) - arch::fma(a.y, b.x, -q))
}

/// Whether the ray is on the inner side of an edge of a triangle with twice the area `det`; if it is on the edge,
/// whether the edge runs downwards, or level and to the left, with the triangle to its left: the neighbour sees it
/// run the other way.
#[inline(always)]
fn owns(edge: f32, from: Flat, to: Flat, det: f32) -> bool {
    let turn = |x: f32| if det < 0.0 { -x } else { x };
    let (edge, x, y) = (turn(edge), turn(to.x - from.x), turn(to.y - from.y));
    edge > 0.0 || (edge == 0.0 && (y > 0.0 || (y == 0.0 && x > 0.0)))
}

#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    f32::from_bits((a.to_bits() as i32).min(b.to_bits() as i32) as u32)
}

#[inline(always)]
fn greatest(a: f32, b: f32) -> f32 {
    f32::from_bits((a.to_bits() as i32).max(b.to_bits() as i32) as u32)
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
        let hit = unit().intersect(&RayShear::new(&down(0.5, 0.25))).unwrap();
        assert_eq!((hit.t, hit.u, hit.v, hit.primitive), (2.0, 0.5, 0.25, 7));
    }

    #[test]
    fn both_sides_are_hit() {
        let up = Ray::new(vec3(0.25, 0.25, -3.0), vec3(0.0, 0.0, 2.0));
        let hit = unit().intersect(&RayShear::new(&up)).unwrap();
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
            let hits = [unit(), other_half()].iter().filter(|t| t.intersect(&RayShear::new(&ray)).is_some()).count();
            assert_eq!(hits, 1, "{ray:?}");
        }
        for (x, y) in [(-1e-6, 0.5), (0.5, -1e-6), (0.500001, 0.500001), (1.000001, 0.0)] {
            assert!(unit().intersect(&RayShear::new(&down(x, y))).is_none(), "({x}, {y})");
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
                Triangle::new(Vec3::ZERO, a, b, 0, 0).intersect(&RayShear::new(&down(0.0, 0.0))).is_some()
            });
            assert_eq!(hits.count(), 1, "{flipped:04b}");
        }
    }

    #[test]
    fn degenerate_input_is_a_miss() {
        let point = Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 0, 0);
        assert!(point.intersect(&RayShear::new(&down(0.0, 0.0))).is_none());
        let nan = Triangle::new(vec3(f32::NAN, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), 0, 0);
        assert!(nan.intersect(&RayShear::new(&down(0.2, 0.2))).is_none());
        assert!(unit().intersect(&RayShear::new(&Ray::new(vec3(0.2, 0.2, 1.0), Vec3::ZERO))).is_none());
        assert!(unit().intersect(&RayShear::new(&down(f32::NAN, 0.2))).is_none());
        let edge_on = Ray::new(vec3(-1.0, 0.25, 0.0), vec3(1.0, 0.0, 0.0));
        assert!(unit().intersect(&RayShear::new(&edge_on)).is_none());
    }
}
