//! The perfectly matt lobe of Lambert: the same radiance in all directions.

use core::f32::consts::FRAC_1_PI;

use super::Evaluation;
use crate::math::Vec3;
use crate::sampling::warp;

/// For a reflectance of 1; times that, the value is the lobe's.
#[inline(always)]
pub fn eval(light: Vec3) -> Evaluation {
    if light.z <= 0.0 {
        return Evaluation::NONE;
    }
    let share = light.z * FRAC_1_PI;
    Evaluation { value: Vec3::splat(share), density: share }
}

/// A direction with the density that [`eval`] says.
#[inline(always)]
pub fn sample(at: [f32; 2]) -> Vec3 {
    warp::cosine_hemisphere(at)
}
