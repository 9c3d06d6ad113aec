//! Axis-aligned boxes.

use raywarp_core::math::Vec3;
pub(super) use raywarp_core::triangle::MARGIN;
use raywarp_core::triangle::{padded, Triangle};

/// From `low` to `high`, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: [f32; 3],
    pub high: [f32; 3],
}

impl Bounds {
    /// Of nothing: inverted, and neutral to [`join`](Self::join).
    pub const EMPTY: Self = Self { low: [f32::MAX; 3], high: [-f32::MAX; 3] };

    /// The origin alone.
    pub const POINT: Self = Self { low: [0.0; 3], high: [0.0; 3] };

    /// Of every finite point.
    pub const ALL: Self = Self { low: [-f32::MAX; 3], high: [f32::MAX; 3] };

    /// See [`Triangle::bounds`].
    pub fn of(triangle: &Triangle) -> Self {
        let (low, high) = triangle.bounds();
        Self { low: low.to_array(), high: high.to_array() }
    }

    /// With the margin for a triangle of some extent, all or part of which is between two corners.
    pub fn padded(low: [f32; 3], high: [f32; 3], extent: f32) -> Self {
        let (low, high) = padded(low.into(), high.into(), extent);
        Self { low: low.to_array(), high: high.to_array() }
    }

    /// Around the corners, without any margin.
    pub fn of_corners(triangle: &Triangle) -> Self {
        let [low, high] =
            [Vec3::min, Vec3::max].map(|pick| pick(pick(triangle.v0, triangle.v1), triangle.v2).to_array());
        Self { low, high }
    }

    /// The smallest box around both.
    #[inline(always)]
    pub fn join(&self, other: &Self) -> Self {
        Self {
            low: [0, 1, 2].map(|i| lesser(self.low[i], other.low[i])),
            high: [0, 1, 2].map(|i| greater(self.high[i], other.high[i])),
        }
    }

    /// What both have in common, or this where that is nothing.
    pub fn within(&self, other: &Self) -> Self {
        let common = self.meet(other);
        if (0..3).all(|i| common.low[i] <= common.high[i]) {
            common
        } else {
            *self
        }
    }

    /// What both contain; inverted on some axis where that is nothing.
    pub fn meet(&self, other: &Self) -> Self {
        Self {
            low: [0, 1, 2].map(|i| greater(self.low[i], other.low[i])),
            high: [0, 1, 2].map(|i| lesser(self.high[i], other.high[i])),
        }
    }

    /// Halved before they are added, lest large coordinates overflow.
    #[inline(always)]
    pub fn centre(&self) -> [f32; 3] {
        [0, 1, 2].map(|i| 0.5 * self.low[i] + 0.5 * self.high[i])
    }

    /// Half the surface, in double precision: boxes as large as single precision allows keep a finite one.
    #[inline(always)]
    pub fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|i| (f64::from(self.high[i]) - f64::from(self.low[i])).max(0.0));
        x * y + y * z + z * x
    }

    /// Surface in units of that of `whole`, which contains this; 1 where neither has any.
    pub fn area_within(&self, whole: &Self) -> f64 {
        let whole = whole.half_area();
        if whole > 0.0 {
            self.half_area() / whole
        } else {
            1.0
        }
    }

    /// Whether every point of `other` is in this.
    pub fn contains(&self, other: &Self) -> bool {
        (0..3).all(|i| self.low[i] <= other.low[i] && other.high[i] <= self.high[i])
    }

    pub fn corners(&self) -> [Vec3; 2] {
        [self.low.into(), self.high.into()]
    }
}

/// Of numbers, never NaN: unlike `f32::min` this is one instruction.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b {
        a
    } else {
        b
    }
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b {
        a
    } else {
        b
    }
}
