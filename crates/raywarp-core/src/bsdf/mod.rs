//! How a surface scatters light: lobes that can be evaluated, sampled, and asked for their density, a file each.
//!
//! Within a lobe directions are in a frame whose z axis is the shading normal on the side that is seen, and point away from
//! the surface: `view` to where the light is looked at from, `light` to where it comes from. What a lobe answers is the
//! scattering function times the cosine of `light`.

pub mod dielectric;
pub mod diffuse;
pub mod ggx;
pub mod material;
mod metallic_roughness;

pub use material::{flags, MetallicRoughness, PointMaterial};
pub use metallic_roughness::{Bsdf, Inside};

use crate::math::{vec3, Vec3};

/// What a function says of a pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// The scattering function times the cosine of the light's direction.
    pub value: Vec3,
    /// Probability per solid angle with which sampling finds this direction of the light.
    pub density: f32,
}

impl Evaluation {
    /// Nothing, which is never found.
    pub const NONE: Self = Self { value: Vec3::ZERO, density: 0.0 };
}

/// A direction that was found by chance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Unit vector to the light.
    pub light: Vec3,
    /// The function times the cosine over the probability.
    pub weight: Vec3,
    /// Probability per solid angle; infinite for the one direction of a smooth surface.
    pub density: f32,
}

/// Orthonormal vectors.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    x: Vec3,
    y: Vec3,
    z: Vec3,
}

impl Frame {
    /// About a unit vector, without a branch (Duff et al. 2017).
    #[inline(always)]
    pub fn about(z: Vec3) -> Self {
        let sign = 1f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        let x = vec3(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
        let y = vec3(b, sign + z.y * z.y * a, -z.y);
        Self { x, y, z }
    }

    /// A direction of the world in the frame.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        vec3(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// A direction of the frame in the world.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z * v.z))
    }
}

#[cfg(test)]
mod tests;
