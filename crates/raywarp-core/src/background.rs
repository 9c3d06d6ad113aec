//! What a ray sees that leaves the scene.

use crate::arch;
use crate::math::{mix, Vec3};

/// A sky, linear in the sine of the elevation.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Background {
    /// Radiance straight up.
    pub zenith: Vec3,
    /// Radiance at the horizon.
    pub horizon: Vec3,
    /// Radiance straight down.
    pub ground: Vec3,
    /// Unit vector to the zenith.
    pub up: Vec3,
}

impl Background {
    /// Radiance from a direction, which is a unit vector.
    #[inline(always)]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let sine = direction.dot(self.up);
        let pole = if sine < 0.0 { self.ground } else { self.zenith };
        mix(self.horizon, pole, arch::min(sine.abs(), 1.0))
    }
}
