//! Surfaces as data: the Phong model with mirror reflection and refraction.

use crate::arch;
use crate::math::{exp2, vec3, Vec3};

/// Bits of [`Material::flags`].
pub mod flags {
    /// `diffuse` is shown as it is.
    pub const UNLIT: u32 = 1;
    /// Fresnel's equations share out energy between reflection and transmission.
    pub const FRESNEL: u32 = 2;
    /// Coverage below `cutoff` is a hole, above it is full.
    pub const MASK: u32 = 4;
    /// Coverage mixes with what lies behind.
    pub const BLEND: u32 = 8;
    /// The normal map holds heights, not normals.
    pub const HEIGHT: u32 = 16;
    /// Seen from outside alone.
    pub const SINGLE_SIDED: u32 = 64;
    /// What tints `diffuse` tints `specular` and `reflection` too.
    pub const METALLIC: u32 = 128;
    /// `absorption` is not zero.
    pub const VOLUME: u32 = 256;
}

/// See `raywarp::scene::Material` for the meaning of each field.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Reflectance of the ambient light.
    pub ambient: Vec3,
    /// Phong exponent.
    pub shininess: f32,
    /// Reflectance of the cosine lobe.
    pub diffuse: Vec3,
    /// Index of refraction of the inside against the outside.
    pub ior: f32,
    /// Strength of the highlight.
    pub specular: Vec3,
    /// Coverage.
    pub opacity: f32,
    /// Radiance of its own.
    pub emission: Vec3,
    /// Threshold of the coverage, with [`flags::MASK`].
    pub cutoff: f32,
    /// Share of the mirrored radiance.
    pub reflection: Vec3,
    /// See [`flags`].
    pub flags: u32,
    /// Share of the refracted radiance.
    pub transmission: Vec3,
    /// Scale of the normal map.
    pub bump: f32,
    /// Of radiance inside, `2^(-absorption length)` is left.
    pub absorption: Vec3,
    /// Index of the texture of each kind, or `NO_TEXTURE`: diffuse.
    pub diffuse_map: u32,
    /// Specular.
    pub specular_map: u32,
    /// Emission.
    pub emission_map: u32,
    /// Opacity.
    pub opacity_map: u32,
    /// Normals or heights.
    pub normal_map: u32,
}

impl Material {
    /// What is left of radiance after some length inside, which may be infinite: Beer's law.
    #[inline(always)]
    pub fn transmittance(&self, length: f32) -> Vec3 {
        // Finite, as zero times infinity is nothing; below 2^-126 there is nothing left.
        let length = arch::min(length, f32::MAX);
        let left = |absorption: f32| exp2(-arch::min(absorption * length, 127.0));
        vec3(left(self.absorption.x), left(self.absorption.y), left(self.absorption.z))
    }
}
