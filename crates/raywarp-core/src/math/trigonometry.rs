//! Sines, cosines and their inverses, from series whose order of operations is fixed.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::arch;

/// Sine and cosine of an angle in whole turns, of a size up to 2^20: absolutely to within 2e-7.
///
/// The angle is brought to an eighth of a turn about a multiple of a quarter, which loses nothing; there the Taylor series
/// are cut after five and six terms.
#[inline(always)]
pub fn sin_cos_of_turns(turns: f32) -> (f32, f32) {
    let quarter = arch::floor(arch::fma(turns, 4.0, 0.5));
    let x = arch::fma(quarter, -0.25, turns) * (2.0 * PI);
    let square = x * x;
    let series = |coefficients: [f32; 5]| {
        let mut sum = coefficients[0];
        for coefficient in &coefficients[1..] {
            sum = arch::fma(sum, square, *coefficient);
        }
        sum
    };
    let sine = x * series([1.0 / 362_880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0]);
    let tail = series([-1.0 / 3_628_800.0, 1.0 / 40_320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5]);
    let cosine = arch::fma(tail, square, 1.0);
    match quarter as i32 & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// The angle of the point (x, y) from the x axis, in radians from -pi to pi; 0 for the origin. To within 4e-7.
///
/// The tangent is brought to at most tan(pi/8), where the series of the arc tangent is cut after nine terms.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = (arch::min(ax, ay), arch::max(ax, ay));
    if large == 0.0 {
        return 0.0;
    }
    let tangent = small / large;
    let beyond = tangent > 0.414_213_57;
    let t = if beyond { (tangent - 1.0) / (tangent + 1.0) } else { tangent };
    let square = t * t;
    let mut sum = 1.0 / 17.0;
    for coefficient in [-1.0 / 15.0, 1.0 / 13.0, -1.0 / 11.0, 1.0 / 9.0, -1.0 / 7.0, 1.0 / 5.0, -1.0 / 3.0, 1.0] {
        sum = arch::fma(sum, square, coefficient);
    }
    let mut angle = sum * t + if beyond { FRAC_PI_4 } else { 0.0 };
    angle = if ay > ax { FRAC_PI_2 - angle } else { angle };
    angle = if x < 0.0 { PI - angle } else { angle };
    if y < 0.0 {
        -angle
    } else {
        angle
    }
}

/// The angle from 0 to pi whose cosine this is, in radians; what lies beyond -1 and 1 counts as these. To within 5e-7.
#[inline(always)]
pub fn acos(cosine: f32) -> f32 {
    let sine = arch::sqrt(arch::max((1.0 - cosine) * (1.0 + cosine), 0.0));
    atan2(sine, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_agree_with_double_precision() {
        for i in -40_000..40_000 {
            let turns = i as f32 / 10_000.0;
            let exact = (turns as f64 * std::f64::consts::TAU).sin_cos();
            let (sine, cosine) = sin_cos_of_turns(turns);
            assert!((sine as f64 - exact.0).abs() < 2e-7, "sine of {turns} turns: {sine}");
            assert!((cosine as f64 - exact.1).abs() < 2e-7, "cosine of {turns} turns: {cosine}");
        }
        assert_eq!([0.0, 0.25, 0.5, 0.75].map(sin_cos_of_turns), [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)]);
    }

    #[test]
    fn arc_tangents_agree_with_double_precision_in_all_quadrants() {
        for i in 0..10_000 {
            let angle = (i as f64 / 10_000.0 - 0.5) * std::f64::consts::TAU;
            for length in [1e-20, 1.0, 1e20] {
                let (y, x) = ((angle.sin() * length) as f32, (angle.cos() * length) as f32);
                let exact = (y as f64).atan2(x as f64);
                assert!((atan2(y, x) as f64 - exact).abs() < 4e-7, "atan2({y}, {x}): {} {exact}", atan2(y, x));
            }
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
    }

    #[test]
    fn arc_cosines_agree_with_double_precision() {
        for i in -10_000..=10_000 {
            let cosine = i as f32 / 10_000.0;
            assert!((acos(cosine) as f64 - (cosine as f64).acos()).abs() < 5e-7, "acos({cosine})");
        }
        assert_eq!((acos(1.5), acos(-2.0)), (0.0, PI));
    }
}
