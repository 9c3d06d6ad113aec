//! Maps from the unit square that carry equal areas to equal probabilities.

use crate::arch;
use crate::math::{sin_cos_of_turns, vec3, Vec3};

/// A direction about +z as often as its cosine is large: a point of the unit disk, lifted (Malley's method).
#[inline(always)]
pub fn cosine_hemisphere([x, y]: [f32; 2]) -> Vec3 {
    let (sine, cosine) = sin_cos_of_turns(x);
    let radius = arch::sqrt(y);
    vec3(radius * cosine, radius * sine, arch::sqrt(1.0 - y))
}

/// Weights of the second and the third corner of a point of a triangle, evenly over it.
#[inline(always)]
pub fn triangle([x, y]: [f32; 2]) -> [f32; 2] {
    let root = arch::sqrt(x);
    [root * (1.0 - y), root * y]
}
