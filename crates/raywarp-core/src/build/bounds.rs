//! Boxes as builders handle them: no number is NaN, and no zero is negative.

use crate::math::{vec3, Vec3};
use crate::triangle::Triangle;

/// From `low` to `high`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// The corner with the least coordinates.
    pub low: Vec3,
    /// The corner with the largest ones.
    pub high: Vec3,
}

impl Bounds {
    /// [`Triangle::bounds`], where a zero is positive: which of two zeros is smaller is not the same on every machine.
    #[inline(always)]
    pub fn of(triangle: &Triangle) -> Self {
        let (low, high) = triangle.bounds();
        Self { low: low + Vec3::ZERO, high: high + Vec3::ZERO }
    }

    /// The smallest box around both.
    #[inline(always)]
    pub fn join(&self, other: &Self) -> Self {
        let (a, b) = (self, other);
        Self {
            low: vec3(lesser(a.low.x, b.low.x), lesser(a.low.y, b.low.y), lesser(a.low.z, b.low.z)),
            high: vec3(greater(a.high.x, b.high.x), greater(a.high.y, b.high.y), greater(a.high.z, b.high.z)),
        }
    }

    /// Halved before they are added, lest large coordinates overflow.
    #[inline(always)]
    pub fn centre(&self) -> Vec3 {
        self.low * 0.5 + self.high * 0.5
    }

    /// Half the surface; infinite where that overflows.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        half_area(self.high.x - self.low.x, self.high.y - self.low.y, self.high.z - self.low.z)
    }
}

/// Half the surface of a box with sides of these lengths; infinite where it overflows.
#[inline(always)]
pub fn half_area(x: f32, y: f32, z: f32) -> f32 {
    let area = x * y + y * z + z * x;
    if area < f32::INFINITY {
        area
    } else {
        f32::INFINITY
    }
}

/// Of numbers, never NaN.
#[inline(always)]
pub fn lesser(a: f32, b: f32) -> f32 {
    if a < b {
        a
    } else {
        b
    }
}

/// Of numbers, never NaN.
#[inline(always)]
pub fn greater(a: f32, b: f32) -> f32 {
    if a > b {
        a
    } else {
        b
    }
}

/// A number whose order is that of the finite numbers that they stand for; above zero.
#[inline(always)]
pub fn ordered(x: f32) -> u32 {
    let bits = (x + 0.0).to_bits();
    if bits >> 31 != 0 {
        !bits
    } else {
        bits | 1 << 31
    }
}

/// The number that [`ordered`] was given.
#[inline(always)]
pub fn of_ordered(order: u32) -> f32 {
    f32::from_bits(if order >> 31 != 0 { order & !(1 << 31) } else { !order })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_that_of_numbers() {
        let numbers = [-f32::MAX, -1.0, -1e-45, 0.0, 1e-45, 1.0, f32::MAX];
        assert!(numbers.windows(2).all(|pair| 0 < ordered(pair[0]) && ordered(pair[0]) < ordered(pair[1])));
        assert!(numbers.iter().all(|&x| of_ordered(ordered(x)) == x));
        assert_eq!(ordered(-0.0), ordered(0.0));
    }

    #[test]
    fn surfaces_that_overflow_are_infinite() {
        assert_eq!(half_area(f32::INFINITY, 0.0, 1.0), f32::INFINITY);
        assert_eq!(half_area(1e30, 1e30, 0.0), f32::INFINITY);
        assert_eq!(half_area(1.0, 2.0, 3.0), 11.0);
    }
}
