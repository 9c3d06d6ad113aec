//! Physically based materials as the kernels read them.

use raywarp_core::bsdf::{flags, MetallicRoughness};
use raywarp_core::texture::luminance;

use super::materials::List;
use crate::render::path::Openings;
use crate::scene::srgb::srgb_to_linear;
use crate::scene::{self, AlphaMode, Image, Material, Texture};

impl List {
    /// The record of a material; where it has Phong's parameters alone, of [what stands for
    /// them](scene::MetallicRoughness::of_phong).
    pub fn metallic_roughness(&mut self, material: &Material) -> MetallicRoughness {
        let phong;
        let own = match &material.metallic_roughness {
            Some(own) => own,
            None => {
                phong = scene::MetallicRoughness::of_phong(material);
                &phong
            }
        };
        let unit = |value: f32| if value > 0.0 { value.min(1.0) } else { 0.0 };
        let mut bits = if own.transmission > 0.0 && !own.thin { flags::VOLUME } else { 0 };
        bits |= if material.unlit { flags::UNLIT } else { 0 };
        bits |= if material.emission != [0.0; 3] && !material.unlit { flags::EMISSIVE } else { 0 };
        MetallicRoughness {
            base_color: own.base_color.map(unit).into(),
            metallic: unit(own.metallic),
            reflectance: own.reflectance().map(unit).into(),
            roughness: unit(own.roughness),
            transmission: unit(own.transmission),
            grazing: unit(own.specular),
            ior: if own.ior > 0.0 { own.ior } else { 1.0 },
            flags: bits,
            metallic_map: self.texture(own.metallic_map.as_ref()),
            roughness_map: self.texture(own.roughness_map.as_ref()),
            transmission_map: self.texture(own.transmission_map.as_ref()),
            unused: 0,
        }
    }
}

/// Mean luminance that a material sends out.
pub fn glow(material: &Material, images: &[Image]) -> f32 {
    let own = luminance(material.emission.into());
    let map = material.emission_map.as_ref().filter(|_| own > 0.0 && !material.unlit);
    let share = map.and_then(|map| Some(mean(map, images.get(map.image as usize)?))).unwrap_or(1.0);
    if own > 0.0 && !material.unlit {
        own * share
    } else {
        0.0
    }
}

/// Mean luminance of a texture over all of its image, as one says it that holds colours.
fn mean(texture: &Texture, image: &Image) -> f32 {
    let linear: Vec<f64> = (0..=255u8)
        .map(|byte| {
            let value = f32::from(byte) / 255.0;
            f64::from(if texture.srgb { srgb_to_linear(value) } else { value })
        })
        .collect();
    let of = |texel: &[u8; 4]| {
        let [r, g, b] = [texel[0], texel[1], texel[2]].map(|byte| linear[byte as usize]);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let sum: f64 = image.texels.iter().map(of).sum();
    let mean = (sum / image.texels.len().max(1) as f64) as f32;
    (texture.base + texture.gain * mean).max(0.0)
}

impl Openings {
    /// Of all materials of a scene.
    pub fn of(materials: &[Material]) -> Self {
        Self {
            holes: materials.iter().any(|material| material.alpha != AlphaMode::Opaque),
            sides: materials.iter().any(|material| material.single_sided && material.transmission == [0.0; 3]),
        }
    }
}
