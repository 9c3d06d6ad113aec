//! What is known of a pixel besides its radiance, as colours.

use crate::arch;
use crate::display::{byte, srgb_byte};
use crate::kernels::FirstHit;
use crate::math::Vec3;
use crate::sample::combine;
use crate::traversal::Tests;

/// Shown where the camera ray meets nothing.
pub const NOTHING: [u8; 3] = [0; 3];

/// A unit normal: x, y, z as red, green, blue, grey for 0.
#[inline(always)]
pub fn normal(n: Vec3) -> [u8; 3] {
    [byte(0.5 * n.x + 0.5), byte(0.5 * n.y + 0.5), byte(0.5 * n.z + 0.5)]
}

/// A depth as a share of the range that is seen: white in front, dark grey at the far end.
#[inline(always)]
pub fn depth(share: f32) -> [u8; 3] {
    [byte(1.0 - 0.85 * share); 3]
}

/// A diffuse colour.
#[inline(always)]
pub fn albedo(color: Vec3) -> [u8; 3] {
    [srgb_byte(color.x), srgb_byte(color.y), srgb_byte(color.z)]
}

/// A colour for a triangle of an instance.
#[inline(always)]
pub fn triangle(instance: u32, primitive: u32) -> [u8; 3] {
    index(primitive ^ instance.rotate_right(8))
}

/// A colour that neighbouring indices do not share, never near black.
#[inline(always)]
pub fn index(index: u32) -> [u8; 3] {
    let bits = combine(0x9e37_79b9, index);
    let channel = |bits: u32| 64 + (bits & 0xff) as u8 / 4 * 3;
    [channel(bits), channel(bits >> 8), channel(bits >> 16)]
}

/// What `value` is of the range from `low` to `high`; 0 of an empty range.
#[inline(always)]
pub fn share(value: f32, low: f32, high: f32) -> f32 {
    let extent = high - low;
    if extent > 0.0 {
        (value - low) / extent
    } else {
        0.0
    }
}

/// What a pixel cost: nodes and triangles together.
#[inline(always)]
pub fn cost(tests: &Tests) -> u64 {
    tests.nodes as u64 + tests.triangles as u64
}

/// The colours of equal steps of [`heat`], sRGB: the ten anchors of matplotlib's "inferno" (Smith and van der Walt 2015),
/// whose lightness grows evenly.
pub const HEAT: [[u8; 3]; 10] = [
    [0x00, 0x00, 0x04],
    [0x1b, 0x0c, 0x42],
    [0x4b, 0x0c, 0x6b],
    [0x78, 0x1c, 0x6d],
    [0xa5, 0x2c, 0x60],
    [0xcf, 0x44, 0x46],
    [0xed, 0x69, 0x25],
    [0xfb, 0x9a, 0x06],
    [0xf7, 0xd0, 0x3c],
    [0xfc, 0xff, 0xa4],
];

/// The colour of a share of a cost: twice as bright is about twice as much.
#[inline(always)]
pub fn heat(share: f32) -> [u8; 3] {
    let place = crate::math::clamp(share, 0.0, 1.0) * (HEAT.len() - 1) as f32;
    let below = place as usize;
    let below = if below > HEAT.len() - 2 { HEAT.len() - 2 } else { below };
    let weight = place - below as f32;
    let (a, b) = (HEAT[below], HEAT[below + 1]);
    let mix = |a: u8, b: u8| arch::floor(a as f32 + weight * (b as f32 - a as f32) + 0.5) as u8;
    [mix(a[0], b[0]), mix(a[1], b[1]), mix(a[2], b[2])]
}

/// Whether the camera ray met nothing.
#[inline(always)]
pub fn is_miss(first_hit: &FirstHit) -> bool {
    first_hit.primitive == FirstHit::NONE.primitive
}
