//! From radiance to the bytes of a screen.

use crate::arch;
use crate::math::{clamp, power, Vec3};

/// How radiance becomes a displayed colour.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// Radiance is multiplied by this.
    pub gain: f32,
    /// One of [`curve`].
    pub curve: u32,
}

/// What happens to radiance that a screen cannot show.
pub mod curve {
    /// Everything above 1 is 1.
    pub const CLAMP: u32 = 0;
    /// The ACES curve as fitted by Narkowicz (2015).
    pub const FILMIC: u32 = 1;
}

/// Shown for radiance that is no number: seen at once.
const NOT_A_NUMBER: [u8; 3] = [255, 0, 255];

impl Tone {
    /// The displayed colour of a radiance, sRGB. Infinite radiance is white, NaN magenta.
    #[inline(always)]
    pub fn color(&self, radiance: Vec3) -> [u8; 3] {
        let Vec3 { x, y, z } = radiance;
        if x.is_nan() || y.is_nan() || z.is_nan() {
            return NOT_A_NUMBER;
        }
        [self.channel(x), self.channel(y), self.channel(z)]
    }

    #[inline(always)]
    fn channel(&self, x: f32) -> u8 {
        // Beyond this every curve is flat, and infinities would make NaN of the filmic one.
        let x = clamp(x * self.gain, 0.0, 1e6);
        srgb_byte(match self.curve {
            curve::FILMIC => (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14),
            _ => x,
        })
    }
}

/// The byte of a display-linear value, rounded (IEC 61966-2-1).
#[inline(always)]
pub fn srgb_byte(linear: f32) -> u8 {
    let linear = clamp(linear, 0.0, 1.0);
    byte(if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * power(linear, 1.0 / 2.4) - 0.055 })
}

/// A share from 0 to 1 as a byte, rounded.
#[inline(always)]
pub fn byte(share: f32) -> u8 {
    arch::floor(255.0 * clamp(share, 0.0, 1.0) + 0.5) as u8
}

/// A pixel of a screen: red in the lowest byte, then green, blue and full coverage.
#[inline(always)]
pub fn rgba([r, g, b]: [u8; 3]) -> u32 {
    r as u32 | (g as u32) << 8 | (b as u32) << 16 | 0xff << 24
}
