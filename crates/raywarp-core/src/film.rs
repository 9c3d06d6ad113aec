//! Where the samples of a pixel add up.

use crate::math::Vec3;

/// Sum over the samples of a pixel so far.
///
/// Samples are added one after the other in their own order, so that the sum does not depend on how a frame is cut
/// into launches.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Radiance.
    pub radiance: Vec3,
    /// Camera rays that hit something.
    pub hits: f32,
}

impl Pixel {
    /// Mean radiance over so many samples; nothing where it is infinite or NaN.
    #[inline(always)]
    pub fn mean(&self, samples: f32) -> Option<Vec3> {
        let mean = self.radiance / samples;
        (mean.x.is_finite() && mean.y.is_finite() && mean.z.is_finite()).then_some(mean)
    }
}
