//! The way down a tree whose scale the ray does not know: it has been brought into the space of a mesh.

use super::binary::SLACK;
use super::bvh2::{Child, Node};
use super::Counter;
use crate::arch;
use crate::math::{vec3, Vec3};
use crate::ray::Ray;
use crate::stack::Stack;
use crate::view::View;

/// Goes down to the nearest leaf, putting the other child aside where both are entered; none where nothing is left.
#[inline(always)]
pub fn descend<const N: usize>(
    nodes: &View<Node>,
    mut next: Child,
    slabs: &Slabs,
    t_far: f32,
    stack: &mut Stack<'_, Child, N>,
    counter: &mut impl Counter,
) -> Option<Child> {
    while !next.is_leaf() {
        counter.node();
        let node = nodes.load(next.index());
        let left = slabs.enter(node.low[0], node.high[0], t_far);
        let right = slabs.enter(node.low[1], node.high[1], t_far);
        let [near, far] = node.children;
        next = match (left, right) {
            (Some(left), Some(right)) => {
                let (near, far) = if right < left { (far, near) } else { (near, far) };
                stack.push(far);
                near
            }
            (Some(_), None) => near,
            (None, Some(_)) => far,
            (None, None) => stack.pop()?,
        };
    }
    Some(next)
}

/// A ray made ready for many boxes: each plane costs one fused step.
pub struct Slabs {
    /// See [`Ray::inverse_direction`].
    pub inverse: Vec3,
    /// `-origin * inverse`, rounded towards earlier; for the planes where a box is entered.
    pub enter: Vec3,
    /// The same rounded towards later; for the planes where a box is left.
    pub leave: Vec3,
    /// Whether the ray runs backwards, axis by axis.
    pub negative: [bool; 3],
    /// Where the ray begins.
    pub t_min: f32,
}

impl Slabs {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let inverse = ray.inverse_direction();
        let shift = -(ray.origin * inverse);
        let slack = vec3(shift.x.abs(), shift.y.abs(), shift.z.abs()) * SLACK;
        Self {
            inverse,
            enter: shift - slack,
            leave: shift + slack,
            negative: [inverse.x < 0.0, inverse.y < 0.0, inverse.z < 0.0],
            t_min: ray.t_min,
        }
    }

    /// The same ray to boxes that are larger by `margin` on every side, and by some roundings of the ray's origin.
    #[inline(always)]
    pub fn widened(self, margin: f32) -> Self {
        let i = self.inverse;
        let margin = vec3(i.x.abs(), i.y.abs(), i.z.abs()) * margin;
        Self { enter: self.enter - margin, leave: self.leave + margin, ..self }
    }

    /// Where the ray enters a box, if it does before `t_far`.
    ///
    /// Conservative, after Ize 2013: the distance `plane * inverse + shift` is off by at most two roundings of itself
    /// and two of `shift`; `enter` and `leave` already hold the latter, the end holds the former. NaN, which only
    /// infinite coordinates could make, counts as no limit.
    #[inline(always)]
    pub fn enter(&self, low: Vec3, high: Vec3, t_far: f32) -> Option<f32> {
        let select = |negative: bool, a: f32, b: f32| if negative { b } else { a };
        let [nx, ny, nz] = self.negative;
        let first = arch::max(
            arch::max(
                arch::fma(select(nx, low.x, high.x), self.inverse.x, self.enter.x),
                arch::fma(select(ny, low.y, high.y), self.inverse.y, self.enter.y),
            ),
            arch::max(arch::fma(select(nz, low.z, high.z), self.inverse.z, self.enter.z), self.t_min),
        );
        let last = arch::min(
            arch::min(
                arch::fma(select(nx, high.x, low.x), self.inverse.x, self.leave.x),
                arch::fma(select(ny, high.y, low.y), self.inverse.y, self.leave.y),
            ),
            arch::min(arch::fma(select(nz, high.z, low.z), self.inverse.z, self.leave.z), t_far),
        );
        (first <= arch::fma(last.abs(), SLACK, last)).then_some(first)
    }
}
