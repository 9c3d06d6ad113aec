//! Light sources, infinitely small or infinitely far.

use crate::arch;
use crate::math::{clamp, Vec3};

/// Kinds of [`Light::kind`].
pub mod kind {
    /// Everywhere from a point.
    pub const POINT: u32 = 0;
    /// Parallel.
    pub const DIRECTIONAL: u32 = 1;
    /// A cone.
    pub const SPOT: u32 = 2;
}

/// A light, made ready.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// World position; unused for a directional light.
    pub position: Vec3,
    /// See [`kind`].
    pub kind: u32,
    /// Unit vector along which the light travels; unused for a point light.
    pub direction: Vec3,
    /// No light from this distance on; may be infinite.
    pub range: f32,
    /// Colour times intensity.
    pub color: Vec3,
    /// Cosine of the half angle from which a spot is dark.
    pub cos_outer: f32,
    /// Constant, linear and quadratic attenuation.
    pub attenuation: Vec3,
    /// One over the difference of the cosines of a spot's inner and outer half angles.
    pub cone_scale: f32,
}

/// What arrives from a light where nothing stands in the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// Unit vector to the light.
    pub towards: Vec3,
    /// How far the light is; infinite for a directional one.
    pub distance: f32,
    /// Colour after attenuation.
    pub color: Vec3,
}

impl Light {
    /// What arrives at a point; black out of reach.
    #[inline(always)]
    pub fn at(&self, point: Vec3) -> Illumination {
        if self.kind == kind::DIRECTIONAL {
            return Illumination { towards: -self.direction, distance: f32::INFINITY, color: self.color };
        }
        let offset = self.position - point;
        let distance = offset.length();
        let towards = offset.normalize();
        let a = self.attenuation;
        let mut share = 1.0 / arch::fma(arch::fma(a.z, distance, a.y), distance, a.x);
        share *= window(distance / self.range);
        if self.kind == kind::SPOT {
            // KHR_lights_punctual: linear in the cosine between the cones, squared.
            let cosine = -towards.dot(self.direction);
            let inside = clamp((cosine - self.cos_outer) * self.cone_scale, 0.0, 1.0);
            share *= inside * inside;
        }
        let reached = share > 0.0 && share < f32::INFINITY;
        Illumination { towards, distance, color: if reached { self.color * share } else { Vec3::ZERO } }
    }
}

/// Fades out towards the end of a light's range, as KHR_lights_punctual recommends: `1 - r^4`, at least 0.
#[inline(always)]
fn window(share_of_range: f32) -> f32 {
    let square = share_of_range * share_of_range;
    clamp(1.0 - square * square, 0.0, 1.0)
}
