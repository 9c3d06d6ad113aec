//! Metal and roughness as the file says them, each slot with a texture, texture coordinates and a transform of its own.
//!
//! KHR_materials_pbrSpecularGlossiness becomes what it is in this model: no metal, with the specular colour as the tint of a
//! reflection of 100 %, and the mean of its texture. The textures of KHR_materials_specular count by their means too.

use ::gltf::json::material::Material as JsonMaterial;
use ::gltf::json::texture::Info;

use super::super::LoadError;
use super::material::{glossiness, mean, refraction, unit, volume, Sets};
use super::texture::{self, Slot};
use super::Reader;
use crate::srgb::srgb_to_linear;
use crate::{Channel, MetallicRoughness, Texture};

/// Textures of numbers that a material may have.
pub(super) fn maps(json: &JsonMaterial) -> impl Iterator<Item = &Info> {
    let metal = match glossiness(json) {
        Some(_) => None,
        None => json.pbr_metallic_roughness.metallic_roughness_texture.as_ref(),
    };
    metal.into_iter().chain(transmission_map(json))
}

fn transmission_map(json: &JsonMaterial) -> Option<&Info> {
    json.extensions.as_ref()?.transmission.as_ref()?.transmission_texture.as_ref()
}

/// The parameters of a material, whose base colour without its texture is known.
pub(super) fn read(
    reader: &mut Reader,
    json: &JsonMaterial,
    sets: Sets,
    base_color: [f32; 3],
) -> Result<MetallicRoughness, LoadError> {
    let mut own = MetallicRoughness { base_color, ior: refraction(json), ..MetallicRoughness::default() };
    match glossiness(json) {
        Some(_) => glossy(reader, json, &mut own)?,
        None => metallic(reader, json, sets, &mut own)?,
    }
    let Some(extensions) = &json.extensions else { return Ok(own) };
    if let Some(specular) = &extensions.specular {
        own.specular = unit(specular.specular_factor.0) * mean(reader, specular.specular_texture.as_ref())?[3];
        let color = mean(reader, specular.specular_color_texture.as_ref())?;
        let factor = specular.specular_color_factor.0;
        own.specular_color = std::array::from_fn(|c| factor[c].clamp(0.0, f32::MAX) * srgb_to_linear(color[c]));
    }
    if let Some(transmission) = &extensions.transmission {
        own.transmission = unit(transmission.transmission_factor.0);
        own.transmission_map = data(reader, transmission_map(json), sets, Channel::Red)?;
        own.thin = volume(json).is_none();
    }
    Ok(own)
}

fn metallic(
    reader: &mut Reader,
    json: &JsonMaterial,
    sets: Sets,
    own: &mut MetallicRoughness,
) -> Result<(), LoadError> {
    let pbr = &json.pbr_metallic_roughness;
    let map = pbr.metallic_roughness_texture.as_ref();
    own.metallic = unit(pbr.metallic_factor.0);
    own.roughness = unit(pbr.roughness_factor.0);
    own.metallic_map = data(reader, map, sets, Channel::Blue)?;
    own.roughness_map = own.metallic_map.map(|map| Texture { channel: Channel::Green, ..map });
    Ok(())
}

fn glossy(reader: &mut Reader, json: &JsonMaterial, own: &mut MetallicRoughness) -> Result<(), LoadError> {
    let Some(glossiness) = glossiness(json) else { return Ok(()) };
    let mean = mean(reader, glossiness.specular_glossiness_texture.as_ref())?;
    let specular = glossiness.specular_factor.0;
    own.roughness = 1.0 - unit(glossiness.glossiness_factor.0) * mean[3];
    // An index of refraction at which 4 % are reflected.
    own.ior = 1.5;
    own.specular_color = std::array::from_fn(|c| unit(specular[c] * srgb_to_linear(mean[c])) / 0.04);
    Ok(())
}

fn data(reader: &mut Reader, info: Option<&Info>, sets: Sets, channel: Channel) -> Result<Option<Texture>, LoadError> {
    let Some(info) = info else { return Ok(None) };
    let texture = texture::read_data(reader, &Slot::from(info), sets)?;
    Ok(texture.map(|texture| Texture { channel, ..texture }))
}
