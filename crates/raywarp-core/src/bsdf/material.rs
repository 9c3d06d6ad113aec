//! Surfaces as data: the metallic-roughness model of glTF 2.0.

use crate::math::Vec3;

/// Bits of [`MetallicRoughness::flags`].
pub mod flags {
    /// The surface encloses a volume: light that passes is bent. Else it is a thin wall.
    pub const VOLUME: u32 = 1;
    /// Light that meets the surface ends there, and what it shows is its colour.
    pub const UNLIT: u32 = 2;
    /// The surface sends out light.
    pub const EMISSIVE: u32 = 4;
}

/// What path tracing reads of a material beside [`Material`](crate::material::Material), whose emission, coverage, normal
/// map, absorption and map of the base colour it shares. See `raywarp::scene::MetallicRoughness` for the meaning of each
/// field.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// Base colour.
    pub base_color: Vec3,
    /// Share of metal.
    pub metallic: f32,
    /// Reflectance of what is no metal, seen from the front.
    pub reflectance: Vec3,
    /// Square root of the width of the distribution of slopes.
    pub roughness: f32,
    /// Share of what is neither metal nor reflected that passes through.
    pub transmission: f32,
    /// Reflectance of what is no metal at grazing angles.
    pub grazing: f32,
    /// Index of refraction of the inside against the outside.
    pub ior: f32,
    /// See [`flags`].
    pub flags: u32,
    /// Index of the texture that multiplies each, or `NO_TEXTURE`: metallic.
    pub metallic_map: u32,
    /// Roughness.
    pub roughness_map: u32,
    /// Transmission.
    pub transmission_map: u32,
    /// Makes 64 bytes.
    pub unused: u32,
}

/// The same at a point, with all textures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMaterial {
    /// Base colour.
    pub base_color: Vec3,
    /// Share of metal.
    pub metallic: f32,
    /// Reflectance of what is no metal, seen from the front.
    pub reflectance: Vec3,
    /// Square root of the width of the distribution of slopes.
    pub roughness: f32,
    /// Reflectance of what is no metal at grazing angles.
    pub grazing: f32,
    /// Share of what is neither metal nor reflected that passes through.
    pub transmission: f32,
}
