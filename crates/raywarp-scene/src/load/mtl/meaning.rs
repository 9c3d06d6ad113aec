//! From a definition to a [`Material`].
//!
//! Values are linear, pictures of colours are sRGB, all other pictures are linear.
//!
//! | illum   | what counts                                                            |
//! |---------|------------------------------------------------------------------------|
//! | 0       | the diffuse colour, unlit                                              |
//! | 1       | diffuse                                                                |
//! | 2, none | diffuse and specular                                                   |
//! | 3, 8    | and mirror reflection, by Ks                                           |
//! | 4, 9    | and transmission                                                       |
//! | 5       | as 3, by Fresnel's equations                                           |
//! | 6       | as 4                                                                   |
//! | 7       | as 6, by Fresnel's equations                                           |
//! | 10      | as 2                                                                   |
//!
//! `d` below 1 lets `Tf (1 - d)` through where there is transmission, bent by `Ni`; elsewhere it is coverage. With `d` at
//! 1 or left out a surface is opaque, whatever `Tf` says, but where `illum` (6, 7) and `Ni` both ask for refraction.
//!
//! `Ns` below 1, or left out, weakens the highlight by as much: programs write 0 for none, and Phong's lobe of exponent 0
//! would cover the half space.
//!
//! `Pm`, `Pr` and their maps are for path tracing: where there is one of them, `Kd` is the base colour, and what is no metal
//! reflects 8 % of `Ks` from the front, of 0.5 where it is left out. Their maps multiply them.

use std::path::Path;

use super::definition::Definition;
use super::map::Map;
use super::texels::{has_alpha, is_cutout, is_grey};
use crate::load::images::is_fallback;
use crate::load::{LoadError, Sources};
use crate::{AlphaMode, Channel, Material, MetallicRoughness, NormalMap, Scene, Texture};

/// Where a cut-out begins.
const CUTOUT: f32 = 0.5;

/// The material, its pictures added to the scene.
pub(super) fn material(
    path: &Path,
    definition: Definition,
    scene: &mut Scene,
    sources: &mut Sources,
) -> Result<Material, LoadError> {
    let mut material = values(&definition);
    let mut texture =
        |map: &Option<Map>, srgb| map.as_ref().map(|map| map.texture(path, srgb, scene, sources)).transpose();
    material.diffuse_map = texture(&definition.diffuse_map, true)?;
    material.specular_map = texture(&definition.specular_map, false)?;
    material.emission_map = texture(&definition.emission_map, true)?;
    let (metallic, roughness) = (texture(&definition.metallic_map, false)?, texture(&definition.roughness_map, false)?);
    let opacity = texture(&definition.opacity_map, false)?;
    let normal = texture(&definition.normal_map, false)?;
    let bump = texture(&definition.bump_map, false)?;

    if definition.is_physical() {
        // Nothing can stand in for numbers.
        let there = |texture: &Texture| !is_fallback(&scene.images[texture.image as usize]);
        material.metallic_roughness = Some(MetallicRoughness {
            metallic_map: metallic.filter(there),
            roughness_map: roughness.filter(there),
            ..physical(&definition, &material)
        });
    }
    if let Some(texture) = opacity {
        cover(&mut material, &definition, texture, scene);
    }
    let normal = normal.zip(definition.normal_map.as_ref()).and_then(|(texture, map)| tangent(texture, map, scene));
    let bump = bump.zip(definition.bump_map.as_ref()).and_then(|(texture, map)| bumps(texture, map, scene));
    material.normal_map = normal.or(bump);
    check_ambient_map(path, &definition, sources)?;
    Ok(material)
}

/// All but the maps. A colour that is left out is white where a map gives it.
fn values(definition: &Definition) -> Material {
    let defaults = Material::default();
    let model = Model::of(definition.illum.unwrap_or(2));
    let with_map = |value: Option<[f32; 3]>, map: &Option<Map>, without| {
        value.unwrap_or(if map.is_some() { [1.0; 3] } else { without })
    };
    let diffuse = with_map(definition.diffuse, &definition.diffuse_map, defaults.diffuse);
    let specular = with_map(definition.specular, &definition.specular_map, defaults.specular);
    let opacity = opacity(definition);
    let shininess = definition.shininess.unwrap_or(defaults.shininess);
    // 0 is what programs write that do not know.
    let ior = definition.ior.filter(|&ior| ior > 0.0).unwrap_or(defaults.ior);
    Material {
        name: definition.name.clone(),
        ambient: definition.ambient.unwrap_or(diffuse),
        diffuse,
        specular: if model.highlight { specular.map(|x| x * shininess.min(1.0)) } else { [0.0; 3] },
        shininess,
        emission: with_map(definition.emission, &definition.emission_map, defaults.emission),
        reflection: if model.mirror { specular } else { [0.0; 3] },
        transmission: if model.transmits {
            transmission(definition, opacity, model.refracts && ior != 1.0)
        } else {
            [0.0; 3]
        },
        ior,
        fresnel: model.fresnel,
        opacity: if model.transmits { 1.0 } else { opacity },
        alpha: if opacity < 1.0 && !model.transmits { AlphaMode::Blend } else { AlphaMode::Opaque },
        unlit: model.unlit,
        ..defaults
    }
}

/// Metal and roughness without maps: 0 and 1, but 1 where a map gives it.
fn physical(definition: &Definition, material: &Material) -> MetallicRoughness {
    let metallic = if definition.metallic_map.is_some() { 1.0 } else { 0.0 };
    let specular = definition.specular.unwrap_or([0.5; 3]);
    MetallicRoughness {
        base_color: material.diffuse,
        metallic: definition.metallic.unwrap_or(metallic).min(1.0),
        roughness: definition.roughness.unwrap_or(1.0).min(1.0),
        specular: if specular == [0.0; 3] { 0.0 } else { 1.0 },
        ior: 1.5,
        specular_color: specular.map(|channel| 2.0 * channel),
        ..MetallicRoughness::of_phong(material)
    }
}

/// What an `illum` switches on.
struct Model {
    unlit: bool,
    highlight: bool,
    mirror: bool,
    transmits: bool,
    refracts: bool,
    fresnel: bool,
}

impl Model {
    fn of(illum: i64) -> Self {
        Self {
            unlit: illum == 0,
            highlight: illum >= 2,
            mirror: (3..=9).contains(&illum),
            transmits: matches!(illum, 4 | 6 | 7 | 9),
            refracts: matches!(illum, 6 | 7),
            fresnel: matches!(illum, 5 | 7),
        }
    }
}

fn opacity(definition: &Definition) -> f32 {
    if definition.is_hidden_by_tr() {
        return 1.0;
    }
    let opacity = definition.dissolve.or(definition.transparency.map(|transparency| 1.0 - transparency));
    opacity.unwrap_or(1.0).clamp(0.0, 1.0)
}

/// What passes a surface that may transmit. Opaque by `d`, it still does where it bends light and has a `Tf`.
fn transmission(definition: &Definition, opacity: f32, bends: bool) -> [f32; 3] {
    match definition.filter {
        filter if opacity < 1.0 => filter.unwrap_or([1.0; 3]).map(|filter| filter * (1.0 - opacity)),
        Some(filter) if bends => filter,
        _ => [0.0; 3],
    }
}

/// `map_d`. The channel is alpha where the picture has one, luminance elsewhere; what has nearly no values between is a
/// cut-out, such as a leaf.
fn cover(material: &mut Material, definition: &Definition, mut texture: Texture, scene: &Scene) {
    let image = &scene.images[texture.image as usize];
    if is_fallback(image) {
        return;
    }
    let channel = definition.opacity_map.as_ref().and_then(|map| map.channel);
    texture.channel = channel.unwrap_or(if has_alpha(image) { Channel::Alpha } else { Channel::Luminance });
    let cut_out = material.opacity >= 1.0 && is_cutout(image, texture.channel);
    material.alpha = if cut_out { AlphaMode::Mask(CUTOUT) } else { AlphaMode::Blend };
    // The alpha of the diffuse map counts already: the same channel of the same picture is not to count twice.
    let counted =
        material.diffuse_map.is_some_and(|diffuse| texture.channel == Channel::Alpha && same_alpha(&diffuse, &texture));
    material.opacity_map = (!counted).then_some(texture);
}

fn same_alpha(a: &Texture, b: &Texture) -> bool {
    a.image == b.image && a.wrap == b.wrap && a.transform == b.transform
}

/// `norm`: normals in tangent space.
fn tangent(mut texture: Texture, map: &Map, scene: &Scene) -> Option<NormalMap> {
    texture.channel = Channel::Rgb;
    let usable = !is_fallback(&scene.images[texture.image as usize]);
    usable.then_some(NormalMap::Tangent { texture, scale: map.bump })
}

/// `bump`: heights, but normals in tangent space if the picture has colours.
fn bumps(mut texture: Texture, map: &Map, scene: &Scene) -> Option<NormalMap> {
    let image = &scene.images[texture.image as usize];
    if is_fallback(image) {
        return None;
    }
    if map.channel.is_none() && !is_grey(image) {
        return tangent(texture, map, scene);
    }
    texture.channel = map.channel.unwrap_or(Channel::Luminance);
    Some(NormalMap::Height { texture, scale: map.bump })
}

/// The diffuse map colours ambient light too: one of its own is lost.
fn check_ambient_map(path: &Path, definition: &Definition, sources: &mut Sources) -> Result<(), LoadError> {
    let Some(ambient) = &definition.ambient_map else { return Ok(()) };
    if definition.diffuse_map.as_ref().is_some_and(|diffuse| diffuse.name == ambient.name) {
        return Ok(());
    }
    let message = "'map_Ka' is skipped, as 'map_Kd' names another image or none; ambient light is coloured by 'map_Kd'";
    sources.warn(path, Some(ambient.line), message)
}
