//! Materials: the JSON's factors and textures to a [`Material`].
//!
//! Colours in factors are linear, those in textures sRGB. What the file says of metal and roughness is kept for path tracing
//! (`physical`). Beside it stands Phong's model, which cannot sample metallic, roughness, specular and transmission textures:
//! the mean texel of each multiplies its factor.

use ::gltf::json::extensions::material as extension;
use ::gltf::json::material::{AlphaMode as JsonAlphaMode, Material as JsonMaterial};
use ::gltf::json::texture::Info;
use ::gltf::json::validation::Checked;

use super::super::quote::quote;
use super::super::LoadError;
use super::phong::{at_most, reflectance_of, Surface};
use super::physical;
use super::texture::{self, Slot};
use super::Reader;
use crate::srgb::srgb_to_linear;
use crate::{AlphaMode, Material, NormalMap, Texture};

/// A material that was read.
#[derive(Clone, Copy)]
pub(super) struct Known {
    /// Index in the scene's materials.
    pub index: u32,
    /// The sets of texture coordinates that its meshes need, the first and the second of raywarp's.
    pub sets: Sets,
}

/// Which TEXCOORD each of a mesh's sets is read from, if any.
pub(super) type Sets = [Option<u32>; 2];

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
    let sets = sets(reader, &json)?;
    convert(reader, &json, sets, &mut material)?;
    let known = Known { index: reader.scene.materials.len() as u32, sets };
    reader.scene.materials.push(material);
    reader.cache.materials.insert(index, known);
    Ok(known)
}

/// TEXCOORD_0, and TEXCOORD_1 where a texture reads it. A material that reads others has the first two that it reads.
fn sets(reader: &mut Reader, json: &JsonMaterial) -> Result<Sets, LoadError> {
    let mut slots: Vec<Slot> = Vec::new();
    slots.extend(base_texture(json).map(Slot::from));
    slots.extend(json.normal_texture.as_ref().map(|map| Slot::of_normal_map(reader.origin, map)).transpose()?);
    slots.extend(json.emissive_texture.as_ref().map(Slot::from));
    slots.extend(physical::maps(json).map(Slot::from));
    let mut read: Vec<u32> = Vec::new();
    for slot in slots {
        if !read.contains(&slot.set) {
            read.push(slot.set);
        }
    }
    if read.iter().all(|&set| set < 2) {
        return Ok([Some(0), read.contains(&1).then_some(1)]);
    }
    if read.len() > 2 {
        let name = quote(json.name.as_deref().unwrap_or_default().as_bytes());
        let (count, first) = (read.len(), read[0]);
        reader.warn(format!(
            "material {name} uses {count} sets of texture coordinates: all but two are taken for TEXCOORD_{first}"
        ))?;
    }
    Ok([read.first().copied(), read.get(1).copied()])
}

fn json(reader: &Reader, index: Option<usize>) -> Result<JsonMaterial, LoadError> {
    let Some(index) = index else { return Ok(JsonMaterial::default()) };
    let materials = &reader.root.materials;
    materials.get(index).cloned().ok_or_else(|| {
        let expected = format!("an index below {}, the number of materials", materials.len());
        reader.origin.broken(format!("a primitive uses materials[{index}]"), expected)
    })
}

pub(super) fn glossiness(json: &JsonMaterial) -> Option<&extension::PbrSpecularGlossiness> {
    json.extensions.as_ref()?.pbr_specular_glossiness.as_ref()
}

fn base_texture(json: &JsonMaterial) -> Option<&Info> {
    match glossiness(json) {
        Some(glossiness) => glossiness.diffuse_texture.as_ref(),
        None => json.pbr_metallic_roughness.base_color_texture.as_ref(),
    }
}

fn convert(reader: &mut Reader, json: &JsonMaterial, sets: Sets, material: &mut Material) -> Result<(), LoadError> {
    let factor = match glossiness(json) {
        Some(glossiness) => glossiness.diffuse_factor.0,
        None => json.pbr_metallic_roughness.base_color_factor.0,
    };
    let [red, green, blue, opacity] = factor.map(unit);
    // Before the means: a picture that is kept is decoded once.
    material.diffuse_map = color_texture(reader, base_texture(json), sets)?;
    let own = physical::read(reader, json, sets, [red, green, blue])?;
    let mut surface = match glossiness(json) {
        Some(glossiness) => glossy(reader, glossiness, [red, green, blue])?,
        None => metallic(reader, json, [red, green, blue])?,
    };
    transmit(reader, json, &mut surface)?;
    surface.apply_to(material);
    if material.transmission != [0.0; 3] {
        material.absorption = absorption(json);
    }
    material.unlit = json.extensions.as_ref().is_some_and(|extensions| extensions.unlit.is_some());
    if material.unlit {
        unlit(material, surface.base);
    }
    material.metallic_roughness = Some(own);
    material.opacity = opacity;
    material.alpha = alpha_mode(json);
    material.single_sided = !json.double_sided;
    emit(reader, json, sets, material)?;
    if let Some(map) = &json.normal_texture {
        let slot = Slot::of_normal_map(reader.origin, map)?;
        let scale = if map.scale.is_finite() { map.scale } else { 1.0 };
        let texture = texture::read_data(reader, &slot, sets)?;
        material.normal_map = texture.map(|texture| NormalMap::Tangent { texture, scale });
    }
    Ok(())
}

fn color_texture(reader: &mut Reader, info: Option<&Info>, sets: Sets) -> Result<Option<Texture>, LoadError> {
    match info {
        Some(info) => texture::read_color(reader, &Slot::from(info), sets),
        None => Ok(None),
    }
}

pub(super) fn mean(reader: &mut Reader, info: Option<&Info>) -> Result<[f32; 4], LoadError> {
    match info {
        Some(info) => texture::mean(reader, &Slot::from(info)),
        None => Ok([1.0; 4]),
    }
}

fn metallic(reader: &mut Reader, json: &JsonMaterial, base: [f32; 3]) -> Result<Surface, LoadError> {
    let pbr = &json.pbr_metallic_roughness;
    let [_, roughness, metallic, _] = mean(reader, pbr.metallic_roughness_texture.as_ref())?;
    let metallic = unit(pbr.metallic_factor.0) * metallic;
    Ok(Surface {
        base,
        tint: if metallic > 0.0 { mean_color(reader, pbr.base_color_texture.as_ref())? } else { [1.0; 3] },
        metallic,
        roughness: unit(pbr.roughness_factor.0) * roughness,
        dielectric: dielectric(reader, json)?,
        transmission: 0.0,
        ior: 1.0,
    })
}

/// The mean of a picture of colours, linear.
fn mean_color(reader: &mut Reader, info: Option<&Info>) -> Result<[f32; 3], LoadError> {
    let [red, green, blue, _] = mean(reader, info)?;
    Ok([red, green, blue].map(srgb_to_linear))
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
        tint: [1.0; 3],
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
    surface.ior = if volume(json).is_some() { refraction(json) } else { 1.0 };
    Ok(())
}

/// What fills the closed surface; thin walls have nothing inside.
pub(super) fn volume(json: &JsonMaterial) -> Option<&extension::Volume> {
    let volume = json.extensions.as_ref()?.volume.as_ref()?;
    (volume.thickness_factor.0 > 0.0).then_some(volume)
}

/// Beer's law as KHR_materials_volume writes it: `color^(d / distance)` is left after a length `d`. Black would be
/// infinite: of it nothing is left that a float can hold.
fn absorption(json: &JsonMaterial) -> [f32; 3] {
    let Some(volume) = volume(json) else { return [0.0; 3] };
    let distance = volume.attenuation_distance.0;
    let of = |color: f32| at_most(f32::MAX, -unit(color).max(f32::MIN_POSITIVE).ln() / distance);
    volume.attenuation_color.0.map(of)
}

/// The index of refraction, 1.5 where the file is silent or senseless.
pub(super) fn refraction(json: &JsonMaterial) -> f32 {
    let stated = json.extensions.as_ref().and_then(|extensions| extensions.ior.as_ref()).map(|ior| ior.ior.0);
    stated.filter(|ior| ior.is_finite() && *ior >= 1.0).unwrap_or(1.5)
}

fn unlit(material: &mut Material, base: [f32; 3]) {
    material.diffuse = base;
    material.ambient = base;
    material.specular = [0.0; 3];
    material.reflection = [0.0; 3];
    material.transmission = [0.0; 3];
    material.absorption = [0.0; 3];
    material.fresnel = false;
    material.metallic = false;
}

fn emit(reader: &mut Reader, json: &JsonMaterial, sets: Sets, material: &mut Material) -> Result<(), LoadError> {
    let extensions = json.extensions.as_ref();
    let strength = extensions.and_then(|extensions| extensions.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
    material.emission = json.emissive_factor.0.map(|factor| at_most(f32::MAX, factor * strength));
    if material.emission != [0.0; 3] {
        material.emission_map = color_texture(reader, json.emissive_texture.as_ref(), sets)?;
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

pub(super) fn unit(value: f32) -> f32 {
    at_most(1.0, value)
}
