//! Rays and what they hit.

use crate::arch;
use crate::math::{vec3, Vec3};
use crate::view::ViewMut;

/// The `primitive` and `instance` of a miss.
pub const MISS: u32 = u32::MAX;

/// A half-line, or a piece of it: `origin + t direction` for `t_min <= t <= t_max`.
///
/// The direction need not be a unit vector; `t` is in units of its length. Both ends belong to the ray, and `t_min` may
/// be negative: then what lies behind the origin is hit too.
///
/// Any floats are legal. A ray hits nothing that has NaN anywhere, an origin or a direction with an infinite coordinate,
/// a direction of zero, or `t_min > t_max`. Queries ask for a direction whose largest component is from 2^-100 to 2^100,
/// and others hit nothing.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is 0.
    pub origin: Vec3,
    /// Hits before this are ignored.
    pub t_min: f32,
    /// Where it goes.
    pub direction: Vec3,
    /// Hits behind this are ignored; may be infinite.
    pub t_max: f32,
}

impl Ray {
    /// From `origin` to infinity.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
    }

    /// The point at `t`.
    #[inline(always)]
    pub fn at(&self, t: f32) -> Vec3 {
        self.direction.mul_add(t, self.origin)
    }

    /// The same ray as queries take it: its ends are finite, for what overflows to infinity is no hit, and a direction
    /// so short or so long that distances would lose their digits is zero. NaN stays: such a ray hits nothing.
    #[inline(always)]
    pub fn within_range(&self) -> Self {
        let t_min = if self.t_min < -f32::MAX { -f32::MAX } else { self.t_min };
        let t_max = if self.t_max > f32::MAX { f32::MAX } else { self.t_max };
        let length = self.direction.max_abs();
        let usable = (SHORTEST..=LONGEST).contains(&length);
        let direction = if usable { self.direction } else { Vec3::ZERO };
        Self { origin: self.origin, t_min, direction, t_max }
    }

    /// The piece of the ray where hits after `previous` are.
    #[inline(always)]
    pub(crate) fn after(&self, previous: &Hit) -> Self {
        // Not `max`, which would lose a NaN.
        let t_min = if previous.t > self.t_min { previous.t } else { self.t_min };
        Self { t_min, ..*self }
    }

    /// One over each component of the direction, always finite: a component too small to divide by counts as 2^-80 of
    /// the largest, with its own sign, so that a plane through the origin is reached at 0 and never at NaN.
    ///
    /// Directions whose largest component is below 2^-126 come out too short, and those above 2^125 may come out as zero.
    #[inline(always)]
    pub fn inverse_direction(&self) -> Vec3 {
        let d = self.direction;
        let smallest = arch::max(d.max_abs() * NEGLIGIBLE, f32::MIN_POSITIVE);
        vec3(finite_inverse(d.x, smallest), finite_inverse(d.y, smallest), finite_inverse(d.z, smallest))
    }
}

/// 2^-100 and 2^100: with coordinates of 10^6 no distance overflows, with those of 10^-6 the margin of boxes does not
/// vanish.
const SHORTEST: f32 = f32::from_bits((127 - 100) << 23);
const LONGEST: f32 = f32::from_bits((127 + 100) << 23);

/// 2^-80.
const NEGLIGIBLE: f32 = f32::from_bits((127 - 80) << 23);

#[inline(always)]
fn finite_inverse(x: f32, smallest: f32) -> f32 {
    arch::reciprocal(if x.abs() < smallest { smallest.copysign(x) } else { x })
}

/// Where a ray meets a triangle. A miss has `t = inf` and `primitive = instance = `[`MISS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// Barycentric weight of vertex 1.
    pub u: f32,
    /// Barycentric weight of vertex 2; vertex 0 weighs `1 - u - v`.
    pub v: f32,
    /// Index of the triangle in its mesh.
    pub primitive: u32,
    /// Index of the instance in the scene.
    pub instance: u32,
}

impl Hit {
    /// Nothing was hit.
    pub const NONE: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, primitive: MISS, instance: MISS };

    /// Whether nothing was hit.
    #[inline(always)]
    pub fn is_miss(&self) -> bool {
        self.primitive == MISS
    }

    /// Whether this comes before `other` along the ray. Of two at the same `t` that of the smaller instance is first,
    /// and within an instance that of the smaller primitive, so that every structure and machine picks the same.
    #[inline(always)]
    pub fn precedes(&self, other: &Hit) -> bool {
        self.t < other.t || (self.t == other.t && self.id() < other.id())
    }

    /// What tells the triangle from all others of the scene.
    #[inline(always)]
    pub(crate) fn id(&self) -> (u32, u32) {
        (self.instance, self.primitive)
    }
}

/// Where the hits of a batch of rays go: four words and one, so that neighbours are written side by side.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct HitArrays {
    /// All but the instance, one a hit.
    pub hits: ViewMut<MeshHit>,
    /// The instance, one a hit; empty where nobody wants to know.
    pub instances: ViewMut<u32>,
}

/// A [`Hit`] without its instance.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit {
    /// As of the hit.
    pub t: f32,
    /// As of the hit.
    pub u: f32,
    /// As of the hit.
    pub v: f32,
    /// As of the hit.
    pub primitive: u32,
}

impl MeshHit {
    /// The hit, of an instance.
    #[inline(always)]
    pub fn of_instance(self, instance: u32) -> Hit {
        let Self { t, u, v, primitive } = self;
        Hit { t, u, v, primitive, instance }
    }
}

impl HitArrays {
    /// Writes a hit.
    ///
    /// # Safety
    /// No other thread has this index.
    #[inline(always)]
    pub unsafe fn set(&self, index: u32, hit: &Hit) {
        let &Hit { t, u, v, primitive, instance } = hit;
        // SAFETY: the caller's promise.
        unsafe {
            self.hits.set(index, MeshHit { t, u, v, primitive });
            self.instances.set(index, instance);
        }
    }
}
