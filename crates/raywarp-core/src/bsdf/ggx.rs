//! Rough surfaces of microfacets after Trowbridge and Reitz 1975 (GGX, Walter et al. 2007), with the height-correlated
//! masking and shadowing of Smith (Heitz 2014).
//!
//! `alpha` is the width of the distribution of slopes, the square of a glTF roughness.

use core::f32::consts::PI;

use crate::arch;
use crate::math::{sin_cos_of_turns, vec3, Vec3};

/// Below this width a surface is a mirror: the lobe would be narrower than single precision resolves directions.
pub const SMOOTH: f32 = 1e-3;

/// Density of microfacet normals over the area of the surface, about +z.
#[inline(always)]
pub fn distribution(half: Vec3, alpha: f32) -> f32 {
    let square = alpha * alpha;
    let across = arch::fma(half.x, half.x, half.y * half.y);
    let whole = arch::fma(square * half.z, half.z, across);
    square / (PI * whole * whole)
}

/// Share of the microfacets that is seen from a direction, Smith's G1.
#[inline(always)]
pub fn masking(direction: Vec3, alpha: f32) -> f32 {
    let cosine = direction.z;
    2.0 * cosine / (cosine + spread(cosine, alpha))
}

/// `cosine sqrt(1 + alpha^2 tan^2)`.
#[inline(always)]
fn spread(cosine: f32, alpha: f32) -> f32 {
    let square = alpha * alpha;
    arch::sqrt(arch::fma(arch::fma(-cosine, cosine, 1.0), square, cosine * cosine))
}

/// The share of microfacets seen from both sides, over four times the product of the cosines.
#[inline(always)]
pub fn visibility(view: Vec3, light: Vec3, alpha: f32) -> f32 {
    let (v, l) = (view.z, light.z);
    0.5 / arch::fma(l, spread(v, alpha), v * spread(l, alpha))
}

/// Density with which [`sample`] finds a normal, per solid angle of the normal.
#[inline(always)]
pub fn density_of_normal(view: Vec3, half: Vec3, alpha: f32) -> f32 {
    let cosine = arch::max(view.dot(half), 0.0);
    masking(view, alpha) * cosine * distribution(half, alpha) / view.z
}

/// Density with which the mirrored direction about a sampled normal is found.
#[inline(always)]
pub fn density_of_mirrored(view: Vec3, half: Vec3, alpha: f32) -> f32 {
    masking(view, alpha) * distribution(half, alpha) / (4.0 * view.z)
}

/// A microfacet normal as often as it is seen from `view` (spherical caps: Dupuy and Benyoub 2023).
#[inline(always)]
pub fn sample(view: Vec3, alpha: f32, [x, y]: [f32; 2]) -> Vec3 {
    let stretched = vec3(alpha * view.x, alpha * view.y, view.z).normalize();
    let (sine, cosine) = sin_cos_of_turns(x);
    let z = arch::fma(1.0 - y, 1.0 + stretched.z, -stretched.z);
    let radius = arch::sqrt(arch::max(arch::fma(-z, z, 1.0), 0.0));
    let half = vec3(radius * cosine, radius * sine, z) + stretched;
    vec3(alpha * half.x, alpha * half.y, arch::max(half.z, 0.0)).normalize()
}
