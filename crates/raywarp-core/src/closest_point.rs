//! The point of a mesh that is closest to a given one.
//!
//! A binary tree of boxes is walked nearer box first, and what is farther than the best triangle so far is left out. Which triangle is
//! found depends on the triangles alone: boxes are looked at from as far as rounding may err, and of two triangles at the same distance
//! that of the smaller instance and primitive is taken.

use crate::arch;
use crate::kernels::Thread;
use crate::math::{vec3, Vec3};
use crate::ray::{Hit, HitArrays, MISS};
use crate::stack::{Stack, Storage};
use crate::traversal::bvh2::{Child, Node, MAX_DEPTH};
use crate::traversal::Bvh2;
use crate::triangle::Triangle;
use crate::view::View;

/// Finds the closest point to each of a batch.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ClosestPoint {
    /// Over triangles in world space.
    pub tree: Bvh2,
    /// Three numbers for each point, at the beginning of its row.
    pub points: View<f32>,
    /// Numbers from the beginning of one row to the next.
    pub stride: u32,
    /// How many points there are.
    pub count: u32,
    /// What is farther is not found; may be infinite.
    pub limit: f32,
    /// One a point, written: the distance for `t`, and the weights of vertices 1 and 2.
    pub found: HitArrays,
}

impl ClosestPoint {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        if thread.x < self.count {
            let at = thread.x * self.stride;
            let point = vec3(self.points.at(at), self.points.at(at + 1), self.points.at(at + 2));
            // SAFETY: one thread a point.
            unsafe { self.found.set(thread.x, &closest_point(&self.tree, point, self.limit)) };
        }
    }
}

/// Rounding errors of distances in units of the largest coordinate that takes part: fewer than 32 roundings of 2^-24, of numbers that
/// are at most four times as large.
const SLACK: f32 = 1.0 / 131_072.0;

/// The closest point of the tree's triangles, at most `limit` away: a [`Hit`] whose `t` is the distance. There is none for a point that is
/// not finite, or so far away that squares of distances overflow.
#[inline(always)]
pub fn closest_point(tree: &Bvh2, point: Vec3, limit: f32) -> Hit {
    let largest = point.max_abs();
    // Neither holds for NaN.
    if !(largest < f32::INFINITY && limit >= 0.0) || point.x.is_nan() || point.y.is_nan() || point.z.is_nan() {
        return Hit::NONE;
    }
    let slack = (tree.reach.max_abs() + largest) * SLACK;
    let mut best = Best { square: arch::min(limit * limit, f32::MAX), u: 0.0, v: 0.0, index: MISS };
    let mut storage = Storage::<(u32, f32), { MAX_DEPTH + 1 }>::new();
    let mut aside = Stack::new(&mut storage);
    let mut next = Child::node(0);
    loop {
        if next.is_leaf() {
            for index in next.index()..next.index() + next.count() {
                best.consider(&tree.triangles, index, point);
            }
        } else {
            let node = tree.nodes.load(next.index());
            let [left, right] = [square_to(&node, 0, point, slack), square_to(&node, 1, point, slack)];
            let (near, far) = if left <= right { (0, 1) } else { (1, 0) };
            let (to_near, to_far) = if left <= right { (left, right) } else { (right, left) };
            if to_far <= best.square {
                aside.push((node.children[far].bits(), to_far));
            }
            if to_near <= best.square {
                next = node.children[near];
                continue;
            }
        }
        loop {
            let Some((link, square)) = aside.pop() else { return best.resolve(&tree.triangles) };
            if square <= best.square {
                next = Child::of_bits(link);
                break;
            }
        }
    }
}

/// Squared distance to the box of a child, at most the true one; infinite where there is no child.
#[inline(always)]
fn square_to(node: &Node, side: usize, point: Vec3, slack: f32) -> f32 {
    if !node.has_child(side) {
        return f32::INFINITY;
    }
    let (below, above) = (node.low[side] - point, point - node.high[side]);
    let out = below.max(above) - Vec3::splat(slack);
    let out = out.max(Vec3::ZERO);
    out.dot(out)
}

/// The best triangle so far.
struct Best {
    /// Squared distance; at first that of the limit.
    square: f32,
    u: f32,
    v: f32,
    /// Its place in the array; [`MISS`] for none.
    index: u32,
}

impl Best {
    #[inline(always)]
    fn consider(&mut self, triangles: &View<Triangle>, index: u32, point: Vec3) {
        let triangle = triangles.load(index);
        let (u, v, square) = closest_on(&triangle, point);
        let nearer = square < self.square || (square == self.square && self.loses_tie(triangles, &triangle));
        if nearer {
            *self = Self { square, u, v, index };
        }
    }

    /// Whether a triangle at the same distance comes before the best one.
    #[inline(always)]
    fn loses_tie(&self, triangles: &View<Triangle>, triangle: &Triangle) -> bool {
        self.index == MISS || {
            let best = triangles.item(self.index);
            (triangle.instance, triangle.primitive) < (best.instance, best.primitive)
        }
    }

    #[inline(always)]
    fn resolve(&self, triangles: &View<Triangle>) -> Hit {
        if self.index == MISS {
            return Hit::NONE;
        }
        let Triangle { primitive, instance, .. } = *triangles.item(self.index);
        Hit { t: arch::sqrt(self.square), u: self.u, v: self.v, primitive, instance }
    }
}

/// The weights of vertices 1 and 2 at the closest point of a triangle, and the squared distance to it. By the regions of Voronoi in which the
/// point may lie (Ericson, Real-Time Collision Detection, 5.1.5).
#[inline(always)]
fn closest_on(triangle: &Triangle, point: Vec3) -> (f32, f32, f32) {
    let (ab, ac, ap) = (triangle.v1 - triangle.v0, triangle.v2 - triangle.v0, point - triangle.v0);
    let (bp, cp) = (point - triangle.v1, point - triangle.v2);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    let (u, v) = weights([d1, d2, d3, d4, d5, d6]);
    let apart = ac.mul_add(-v, ab.mul_add(-u, ap));
    (u, v, apart.dot(apart))
}

#[inline(always)]
fn weights([d1, d2, d3, d4, d5, d6]: [f32; 6]) -> (f32, f32) {
    if d1 <= 0.0 && d2 <= 0.0 {
        return (0.0, 0.0);
    }
    if d3 >= 0.0 && d4 <= d3 {
        return (1.0, 0.0);
    }
    if d6 >= 0.0 && d5 <= d6 {
        return (0.0, 1.0);
    }
    let c = arch::fma(d1, d4, -(d3 * d2));
    if c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (share(d1, d1 - d3), 0.0);
    }
    let b = arch::fma(d5, d2, -(d1 * d6));
    if b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (0.0, share(d2, d2 - d6));
    }
    let a = arch::fma(d3, d6, -(d5 * d4));
    if a <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let v = share(d4 - d3, (d4 - d3) + (d5 - d6));
        return (1.0 - v, v);
    }
    let sum = a + b + c;
    (share(b, sum), share(c, sum))
}

/// A part of a sum, 0 of none: products of the smallest numbers vanish.
#[inline(always)]
fn share(part: f32, sum: f32) -> f32 {
    if sum > 0.0 {
        part / sum
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(point: Vec3) -> (f32, f32, f32) {
        let triangle = Triangle::new(Vec3::ZERO, vec3(2.0, 0.0, 0.0), vec3(0.0, 2.0, 0.0), 0, 0);
        closest_on(&triangle, point)
    }

    #[test]
    fn each_region_of_a_triangle_has_its_closest_point() {
        assert_eq!(on(vec3(-1.0, -1.0, 3.0)), (0.0, 0.0, 11.0));
        assert_eq!(on(vec3(4.0, -1.0, 0.0)), (1.0, 0.0, 5.0));
        assert_eq!(on(vec3(-1.0, 4.0, 0.0)), (0.0, 1.0, 5.0));
        assert_eq!(on(vec3(0.5, -3.0, 0.0)), (0.25, 0.0, 9.0));
        assert_eq!(on(vec3(-3.0, 0.5, 0.0)), (0.0, 0.25, 9.0));
        assert_eq!(on(vec3(2.0, 2.0, 1.0)), (0.5, 0.5, 3.0));
        assert_eq!(on(vec3(0.5, 0.5, -2.0)), (0.25, 0.25, 4.0));
    }
}
