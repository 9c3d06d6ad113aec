//! Materials: the JSON's factors and textures to a [`Material`].
//!
//! Colours in factors are linear, those in textures sRGB. Phong's model cannot sample metallic, roughness, specular and
//! transmission textures: the mean texel of each multiplies its factor.

use ::gltf::json::extensions::material as extension;
use ::gltf::json::material::{AlphaMode as JsonAlphaMode, Material as JsonMaterial};
use ::gltf::json::texture::Info;
use ::gltf::json::validation::Checked;

use super::super::quote::quote;
use super::super::LoadError;
use super::phong::{at_most, reflectance_of, Surface};
use super::texture::{self, Slot};
use super::Reader;
use crate::srgb::srgb_to_linear;
use crate::{AlphaMode, Material, NormalMap, Texture};

/// A material that was read.
#[derive(Clone, Copy)]
pub(super) struct Known {
    /// Index in the scene's materials.
    pub index: u32,
    /// The set of texture coordinates that its meshes need.
    pub texture_set: u32,
}

/// A material of the JSON; `None` is the default one, white and rough.
pub(super) fn read(reader: &mut Reader, index: Option<usize>) -> Result<Known, LoadError> {
    if let Some(&known) = reader.cache.materials.get(&index) {
        return Ok(known);
    }
    let json = json(reader, index)?;
    let name = match (&json.name, index) {
        (Some(name), _) => name.clone(),
        (None, Some(index)) => format!("materials[{index}]"),
        (None, None) => "default".to_owned(),
    };
    let mut material = Material { name, ..Material::default() };
    convert(reader, &json, &mut material)?;
    let known = Known { index: reader.scene.materials.len() as u32, texture_set: texture_set(reader, &json)? };
    reader.scene.materials.push(material);
    reader.cache.materials.insert(index, known);
    Ok(known)
}

/// The set of texture coordinates of the base colour, else of any texture.
fn texture_set(reader: &mut Reader, json: &JsonMaterial) -> Result<u32, LoadError> {
    let mut slots: Vec<Slot> = Vec::new();
    slots.extend(base_texture(json).map(Slot::from));
    slots.extend(json.normal_texture.as_ref().map(|map| Slot::of_normal_map(reader.origin, map)).transpose()?);
    slots.extend(json.emissive_texture.as_ref().map(Slot::from));
    let set = slots.first().map_or(0, |slot| slot.set);
    if slots.iter().any(|slot| slot.set != set) {
        let name = quote(json.name.as_deref().unwrap_or_default().as_bytes());
        reader.warn(format!("material {name} uses several sets of texture coordinates: all use TEXCOORD_{set}"))?;
    }
    Ok(set)
}

fn json(reader: &Reader, index: Option<usize>) -> Result<JsonMaterial, LoadError> {
    let Some(index) = index else { return Ok(JsonMaterial::default()) };
    let materials = &reader.root.materials;
    materials.get(index).cloned().ok_or_else(|| {
        let expected = format!("an index below {}, the number of materials", materials.len());
        reader.origin.broken(format!("a primitive uses materials[{index}]"), expected)
    })
}

fn glossiness(json: &JsonMaterial) -> Option<&extension::PbrSpecularGlossiness> {
    json.extensions.as_ref()?.pbr_specular_glossiness.as_ref()
}

fn base_texture(json: &JsonMaterial) -> Option<&Info> {
    match glossiness(json) {
        Some(glossiness) => glossiness.diffuse_texture.as_ref(),
        None => json.pbr_metallic_roughness.base_color_texture.as_ref(),
    }
}

fn convert(reader: &mut Reader, json: &JsonMaterial, material: &mut Material) -> Result<(), LoadError> {
    let factor = match glossiness(json) {
        Some(glossiness) => glossiness.diffuse_factor.0,
        None => json.pbr_metallic_roughness.base_color_factor.0,
    };
    let [red, green, blue, opacity] = factor.map(unit);
    let mut surface = match glossiness(json) {
        Some(glossiness) => glossy(reader, glossiness, [red, green, blue])?,
        None => metallic(reader, json, [red, green, blue])?,
    };
    transmit(reader, json, &mut surface)?;
    surface.apply_to(material);
    material.unlit = json.extensions.as_ref().is_some_and(|extensions| extensions.unlit.is_some());
    if material.unlit {
        unlit(material, surface.base);
    }
    material.opacity = opacity;
    material.alpha = alpha_mode(json);
    material.diffuse_map = texture_of(reader, base_texture(json), true)?;
    emit(reader, json, material)?;
    if let Some(map) = &json.normal_texture {
        let slot = Slot::of_normal_map(reader.origin, map)?;
        let scale = if map.scale.is_finite() { map.scale } else { 1.0 };
        material.normal_map = texture::read(reader, &slot, false)?.map(|texture| NormalMap::Tangent { texture, scale });
    }
    Ok(())
}

fn texture_of(reader: &mut Reader, info: Option<&Info>, srgb: bool) -> Result<Option<Texture>, LoadError> {
    match info {
        Some(info) => texture::read(reader, &Slot::from(info), srgb),
        None => Ok(None),
    }
}

fn mean(reader: &mut Reader, info: Option<&Info>) -> Result<[f32; 4], LoadError> {
    match info {
        Some(info) => texture::mean(reader, &Slot::from(info)),
        None => Ok([1.0; 4]),
    }
}

fn metallic(reader: &mut Reader, json: &JsonMaterial, base: [f32; 3]) -> Result<Surface, LoadError> {
    let pbr = &json.pbr_metallic_roughness;
    let [_, roughness, metallic, _] = mean(reader, pbr.metallic_roughness_texture.as_ref())?;
    Ok(Surface {
        base,
        metallic: unit(pbr.metallic_factor.0) * metallic,
        roughness: unit(pbr.roughness_factor.0) * roughness,
        dielectric: dielectric(reader, json)?,
        transmission: 0.0,
        ior: 1.0,
    })
}

fn dielectric(reader: &mut Reader, json: &JsonMaterial) -> Result<[f32; 3], LoadError> {
    let extensions = json.extensions.as_ref();
    let normal = reflectance_of(refraction(json));
    let Some(specular) = extensions.and_then(|extensions| extensions.specular.as_ref()) else { return Ok([normal; 3]) };
    let strength = unit(specular.specular_factor.0) * mean(reader, specular.specular_texture.as_ref())?[3];
    let color = mean(reader, specular.specular_color_texture.as_ref())?;
    let factor = specular.specular_color_factor.0;
    Ok(std::array::from_fn(|c| unit(normal * strength * srgb_to_linear(color[c]) * factor[c])))
}

fn glossy(
    reader: &mut Reader,
    glossiness: &extension::PbrSpecularGlossiness,
    base: [f32; 3],
) -> Result<Surface, LoadError> {
    let mean = mean(reader, glossiness.specular_glossiness_texture.as_ref())?;
    let specular = glossiness.specular_factor.0;
    Ok(Surface {
        base,
        metallic: 0.0,
        roughness: 1.0 - unit(glossiness.glossiness_factor.0) * mean[3],
        dielectric: std::array::from_fn(|c| unit(specular[c] * srgb_to_linear(mean[c]))),
        transmission: 0.0,
        ior: 1.0,
    })
}

fn transmit(reader: &mut Reader, json: &JsonMaterial, surface: &mut Surface) -> Result<(), LoadError> {
    let Some(extensions) = &json.extensions else { return Ok(()) };
    let Some(transmission) = &extensions.transmission else { return Ok(()) };
    let share = mean(reader, transmission.transmission_texture.as_ref())?[0];
    surface.transmission = unit(transmission.transmission_factor.0) * share;
    let thick = extensions.volume.as_ref().is_some_and(|volume| volume.thickness_factor.0 > 0.0);
    surface.ior = if thick { refraction(json) } else { 1.0 };
    Ok(())
}

/// The index of refraction, 1.5 where the file is silent or senseless.
fn refraction(json: &JsonMaterial) -> f32 {
    let stated = json.extensions.as_ref().and_then(|extensions| extensions.ior.as_ref()).map(|ior| ior.ior.0);
    stated.filter(|ior| ior.is_finite() && *ior >= 1.0).unwrap_or(1.5)
}

fn unlit(material: &mut Material, base: [f32; 3]) {
    material.diffuse = base;
    material.ambient = base;
    material.specular = [0.0; 3];
    material.reflection = [0.0; 3];
    material.transmission = [0.0; 3];
    material.fresnel = false;
}

fn emit(reader: &mut Reader, json: &JsonMaterial, material: &mut Material) -> Result<(), LoadError> {
    let extensions = json.extensions.as_ref();
    let strength = extensions.and_then(|extensions| extensions.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
    material.emission = json.emissive_factor.0.map(|factor| at_most(f32::MAX, factor * strength));
    if material.emission != [0.0; 3] {
        material.emission_map = texture_of(reader, json.emissive_texture.as_ref(), true)?;
    }
    Ok(())
}

fn alpha_mode(json: &JsonMaterial) -> AlphaMode {
    match json.alpha_mode {
        Checked::Valid(JsonAlphaMode::Mask) => AlphaMode::Mask(json.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0)),
        Checked::Valid(JsonAlphaMode::Blend) => AlphaMode::Blend,
        Checked::Valid(JsonAlphaMode::Opaque) | Checked::Invalid => AlphaMode::Opaque,
    }
}

fn unit(value: f32) -> f32 {
    at_most(1.0, value)
}
