//! Vectors, and the few transcendental functions that both machines must round alike.

use core::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub};

use crate::arch;

mod trigonometry;
pub use trigonometry::{acos, atan2, sin_cos_of_turns};

/// Three components: a point, a direction or a linear colour.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3 {
    /// Or red.
    pub x: f32,
    /// Or green.
    pub y: f32,
    /// Or blue.
    pub z: f32,
}

/// Shorthand for [`Vec3::new`].
#[inline(always)]
pub const fn vec3(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3 { x, y, z }
}

impl Vec3 {
    /// The origin, no direction, black.
    pub const ZERO: Self = Self::splat(0.0);
    /// White.
    pub const ONE: Self = Self::splat(1.0);

    /// From components.
    #[inline(always)]
    pub const fn new(x: f32, y: f32, z: f32) -> Self {
        Self { x, y, z }
    }

    /// The same in all three.
    #[inline(always)]
    pub const fn splat(value: f32) -> Self {
        Self { x: value, y: value, z: value }
    }

    /// Scalar product, by two fused steps.
    #[inline(always)]
    pub fn dot(self, other: Self) -> f32 {
        arch::fma(self.x, other.x, arch::fma(self.y, other.y, self.z * other.z))
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            arch::fma(self.y, other.z, -(self.z * other.y)),
            arch::fma(self.z, other.x, -(self.x * other.z)),
            arch::fma(self.x, other.y, -(self.y * other.x)),
        )
    }

    /// Euclidean length.
    #[inline(always)]
    pub fn length(self) -> f32 {
        arch::sqrt(self.dot(self))
    }

    /// The unit vector of the same direction; zero stays zero.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        // Scaled first, or squares of very small or large components would vanish or overflow.
        // Twice for the smallest: one over a subnormal number is infinite.
        let this = if self.max_abs() < 1e-30 { self * 1e30 } else { self };
        let largest = this.max_abs();
        if largest > 0.0 && largest < f32::INFINITY {
            let scaled = this / largest;
            scaled / scaled.length()
        } else {
            Self::ZERO
        }
    }

    /// `self * scale + other`, fused.
    #[inline(always)]
    pub fn mul_add(self, scale: f32, other: Self) -> Self {
        Self::new(
            arch::fma(self.x, scale, other.x),
            arch::fma(self.y, scale, other.y),
            arch::fma(self.z, scale, other.z),
        )
    }

    /// Absolute value of the largest component.
    #[inline(always)]
    pub fn max_abs(self) -> f32 {
        arch::max(arch::max(self.x.abs(), self.y.abs()), self.z.abs())
    }

    /// Component-wise minimum.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self::new(arch::min(self.x, other.x), arch::min(self.y, other.y), arch::min(self.z, other.z))
    }

    /// Component-wise maximum.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self::new(arch::max(self.x, other.x), arch::max(self.y, other.y), arch::max(self.z, other.z))
    }

    /// Whether every component is exactly zero.
    #[inline(always)]
    pub fn is_zero(self) -> bool {
        self.x == 0.0 && self.y == 0.0 && self.z == 0.0
    }

    /// As an array.
    #[inline(always)]
    pub const fn to_array(self) -> [f32; 3] {
        [self.x, self.y, self.z]
    }
}

impl From<[f32; 3]> for Vec3 {
    #[inline(always)]
    fn from([x, y, z]: [f32; 3]) -> Self {
        Self { x, y, z }
    }
}

macro_rules! componentwise {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for Vec3 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::new(self.x $operator other.x, self.y $operator other.y, self.z $operator other.z)
            }
        }
    )*};
}

componentwise!(Add add +, Sub sub -, Mul mul *);

impl Mul<f32> for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, scale: f32) -> Self {
        Self::new(self.x * scale, self.y * scale, self.z * scale)
    }
}

impl Div<f32> for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn div(self, divisor: f32) -> Self {
        self * (1.0 / divisor)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl AddAssign for Vec3 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Index<u32> for Vec3 {
    type Output = f32;
    #[inline(always)]
    fn index(&self, axis: u32) -> &f32 {
        match axis {
            0 => &self.x,
            1 => &self.y,
            _ => &self.z,
        }
    }
}

/// `a` where `t` is 0, `b` where it is 1.
#[inline(always)]
pub fn mix(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    (b - a).mul_add(t, a)
}

/// A value or edge number in `low..=high`; NaN becomes `low`.
#[inline(always)]
pub fn clamp(value: f32, low: f32, high: f32) -> f32 {
    arch::min(arch::max(value, low), high)
}

/// `base` to the power of `exponent`, for `base` from 0 to 1 and `exponent` of 0 or more: Phong's highlight.
///
/// `0^0` is 1. The relative error is below 2e-6 times the exponent's size over the range that shows: see the test.
#[inline(always)]
pub fn power(base: f32, exponent: f32) -> f32 {
    if exponent == 0.0 {
        return 1.0;
    }
    if base <= 0.0 {
        return 0.0;
    }
    exp2(exponent * log2(base))
}

/// Logarithm to base 2 of a positive, normal number, to within 2e-7 of the result or absolutely.
///
/// The mantissa m is brought to [sqrt(1/2), sqrt(2)); there ln m = 2 atanh(s) with s = (m - 1) / (m + 1), whose series
/// in s^2 <= 0.0295 is cut after four terms.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let shifted = bits.wrapping_sub(0x3f35_04f3) as i32 >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub((shifted as u32) << 23));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let square = s * s;
    let series = arch::fma(square, arch::fma(square, arch::fma(square, 0.142_857_15, 0.2), 0.333_333_34), 1.0);
    arch::fma(series * s, 2.0 * core::f32::consts::LOG2_E, shifted as f32)
}

/// 2 to the power of `x`; 0 below -126, infinity from 128 on.
///
/// 2^x = 2^n e^(f ln 2) with |f| <= 1/2 and the exponential's series cut after seven terms.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    if x < -126.0 {
        return 0.0;
    }
    if x >= 128.0 {
        return f32::INFINITY;
    }
    let whole = arch::floor(x + 0.5);
    let y = (x - whole) * core::f32::consts::LN_2;
    let mut sum = 1.0 / 720.0;
    for coefficient in [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        sum = arch::fma(sum, y, coefficient);
    }
    // `sum` lies in [0.7, 1.42]: doubling once more by multiplication keeps 2^127.x finite.
    let half = whole as i32 >> 1;
    sum * power_of_two(half) * power_of_two(whole as i32 - half)
}

#[inline(always)]
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_agree_with_double_precision() {
        for i in 1..=1000 {
            let base = i as f32 / 1000.0;
            for exponent in [0.25f32, 1.0, 2.0, 10.0, 100.0, 1000.0] {
                let exact = (base as f64).powf(exponent as f64);
                let error = (power(base, exponent) as f64 - exact).abs();
                assert!(error <= 2e-6 * exact * (1.0 + exponent as f64) + 1e-37, "{base}^{exponent}: {error}");
            }
        }
        assert_eq!(power(0.0, 0.0), 1.0);
        assert_eq!(power(0.0, 3.0), 0.0);
    }

    #[test]
    fn exponentials_agree_with_double_precision() {
        for i in -1259..1279 {
            let x = i as f32 / 10.0;
            let exact = (x as f64).exp2();
            assert!((exp2(x) as f64 - exact).abs() <= 4e-7 * exact, "2^{x}");
        }
        assert_eq!(exp2(-200.0), 0.0);
        assert_eq!(exp2(128.0), f32::INFINITY);
    }

    #[test]
    fn unit_vectors_survive_extreme_lengths() {
        for scale in [1e-39f32, 1e-30, 1e-3, 1.0, 1e30] {
            let unit = (vec3(1.0, -2.0, 2.0) * scale).normalize();
            assert!((unit.length() - 1.0).abs() < 1e-6, "{scale}");
        }
        assert_eq!(Vec3::ZERO.normalize(), Vec3::ZERO);
    }
}
