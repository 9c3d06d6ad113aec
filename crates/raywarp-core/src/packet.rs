//! Four triangles side by side, for the vector instructions of a CPU.

use crate::arch;
use crate::math::Vec3;
use crate::triangle::{edge, RayShear, Triangle, TINY};

/// Four triangles, a component of all four after the other.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrianglePacket {
    /// x, y and z of the four vertices 0, then of vertices 1 and 2.
    pub corners: [[[f32; 4]; 3]; 3],
    /// See [`Triangle::primitive`].
    pub primitive: [u32; 4],
    /// See [`flags`](crate::triangle::flags).
    pub flags: [u32; 4],
    /// See [`Triangle::instance`].
    pub instance: [u32; 4],
}

impl TrianglePacket {
    /// Of up to four triangles. Places that are left have points of primitive [`MISS`](crate::ray::MISS).
    pub fn new(triangles: &[Triangle]) -> Self {
        let mut packet =
            Self { corners: [[[0.0; 4]; 3]; 3], primitive: [crate::ray::MISS; 4], flags: [0; 4], instance: [0; 4] };
        for (lane, triangle) in triangles.iter().take(4).enumerate() {
            for (corner, vertex) in [triangle.v0, triangle.v1, triangle.v2].into_iter().enumerate() {
                (0..3).for_each(|axis| packet.corners[corner][axis][lane] = vertex.to_array()[axis]);
            }
            packet.primitive[lane] = triangle.primitive;
            packet.flags[lane] = triangle.flags;
            packet.instance[lane] = triangle.instance;
        }
        packet
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
            instance: self.instance[lane],
        }
    }

    /// Bit `i` is 0 where the ray is for certain on the outer side of an edge of triangle `i`, which
    /// [`Triangle::intersect`] then refuses; where it is 1 it has to be asked. The same operations, on four at a time.
    #[inline(always)]
    pub fn may_be_hit(&self, shear: &RayShear) -> u32 {
        let (mut low, mut high) = ([0.0; 8], [0.0; 8]);
        for i in 0..4 {
            let t = self.triangle(i);
            let origin = shear.origin;
            let a = shear.flatten(t.v0 - origin);
            let b = shear.flatten(t.v1 - origin);
            let c = shear.flatten(t.v2 - origin);
            let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
            low[i] = smaller(smaller(u, v), w);
            high[i] = larger(larger(u, v), w);
        }
        // Twice as far from zero: what is equal is still asked.
        !(arch::at_most(&low, &[-2.0 * TINY; 8]) & arch::at_most(&[2.0 * TINY; 8], &high)) & 15
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
