//! Materials, textures and images as the kernels read them.

use std::f32::consts::LOG2_E;

use raywarp_core::bsdf::MetallicRoughness;
use raywarp_core::material::{flags, Material};
use raywarp_core::texture::{mode, Texture, NO_TEXTURE};

use super::lighting::Ambient;
use super::metallic_roughness::glow;
use crate::render::path::Openings;
use crate::scene::srgb::srgb_to_linear_precise;
use crate::scene::{self, AlphaMode, Channel, Filter, Image, NormalMap, Scene, UvSet, Wrap};

/// Materials and the textures that they refer to.
pub(crate) struct Surfaces {
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    /// What path tracing reads beside, one a material.
    pub metallic_roughness: Vec<MetallicRoughness>,
    /// Mean luminance that each material sends out.
    pub glow: Vec<f32>,
    /// What stands in the way of rays beside closed triangles.
    pub openings: Openings,
}

/// All materials of a scene, for ambient light of its own or for the built-in one.
pub(super) fn ready(materials: &[scene::Material], images: &[Image], ambient: Ambient) -> Surfaces {
    let mut first = 0;
    let places = images.iter().map(|image| {
        let whole = image.texels.len() as u64 == image.width as u64 * image.height as u64;
        let place = Place { first, width: image.width, height: image.height, whole };
        first += image.texels.len() as u32;
        place
    });
    let mut list = List { places: places.collect(), textures: Vec::new(), ambient };
    let phong = materials.iter().map(|m| list.material(m)).collect();
    let metallic_roughness = materials.iter().map(|m| list.metallic_roughness(m)).collect();
    let glow = materials.iter().map(|material| glow(material, images)).collect();
    let openings = Openings::of(materials);
    Surfaces { materials: phong, textures: list.textures, metallic_roughness, glow, openings }
}

/// All images, one after the other.
pub(super) fn texels(scene: &Scene) -> Vec<u32> {
    let texels = |image: &Image| image.texels.iter().map(|&rgba| u32::from_le_bytes(rgba)).collect::<Vec<_>>();
    scene.images.iter().flat_map(texels).collect()
}

/// Linear value of each sRGB byte.
pub(super) fn srgb_table() -> Vec<f32> {
    (0..256).map(|byte| srgb_to_linear_precise(byte as f64 / 255.0) as f32).collect()
}

/// Where an image lies among the texels.
#[derive(Clone, Copy)]
struct Place {
    first: u32,
    width: u32,
    height: u32,
    /// It has as many texels as its size says, and some.
    whole: bool,
}

pub(super) struct List {
    places: Vec<Place>,
    textures: Vec<Texture>,
    ambient: Ambient,
}

impl List {
    fn material(&mut self, material: &scene::Material) -> Material {
        let mut bits = 0;
        bits |= if material.unlit { flags::UNLIT } else { 0 };
        bits |= if material.fresnel { flags::FRESNEL } else { 0 };
        let (alpha, cutoff) = match material.alpha {
            AlphaMode::Opaque => (0, 0.0),
            AlphaMode::Mask(cutoff) => (flags::MASK, cutoff),
            AlphaMode::Blend => (flags::BLEND, 0.0),
        };
        let (height, bump, normal_map) = match material.normal_map {
            None => (0, 0.0, NO_TEXTURE),
            Some(NormalMap::Tangent { texture, scale }) => (0, scale, self.texture(Some(&texture))),
            Some(NormalMap::Height { texture, scale }) => (flags::HEIGHT, scale, self.texture(Some(&texture))),
        };
        bits |= if material.metallic { flags::METALLIC } else { 0 };
        let transmits = material.transmission != [0.0; 3];
        bits |= if material.single_sided && !transmits { flags::SINGLE_SIDED } else { 0 };
        bits |= if transmits && material.absorption != [0.0; 3] { flags::VOLUME } else { 0 };
        Material {
            ambient: match self.ambient {
                Ambient::Own => material.ambient.into(),
                Ambient::BuiltIn => material.diffuse.into(),
            },
            shininess: material.shininess.max(0.0),
            diffuse: material.diffuse.into(),
            ior: if material.ior > 0.0 { material.ior } else { 1.0 },
            specular: material.specular.into(),
            opacity: material.opacity,
            emission: material.emission.into(),
            cutoff,
            reflection: material.reflection.into(),
            flags: bits | alpha | height,
            transmission: material.transmission.into(),
            bump,
            // Kernels raise 2 to powers.
            absorption: material.absorption.map(|a| (a.max(0.0) * LOG2_E).min(f32::MAX)).into(),
            diffuse_map: self.texture(material.diffuse_map.as_ref()),
            specular_map: self.texture(material.specular_map.as_ref()),
            emission_map: self.texture(material.emission_map.as_ref()),
            opacity_map: self.texture(material.opacity_map.as_ref()),
            normal_map,
        }
    }

    /// Index of the texture; none for one whose image is not there.
    pub(super) fn texture(&mut self, texture: Option<&scene::Texture>) -> u32 {
        let place = texture.and_then(|texture| Some((texture, *self.places.get(texture.image as usize)?)));
        let Some((texture, place)) = place.filter(|(_, place)| place.whole && place.width > 0 && place.height > 0)
        else {
            return NO_TEXTURE;
        };
        let [u_row, v_row] = texture.transform.map(Into::into);
        self.textures.push(Texture {
            first: place.first,
            width: place.width,
            height: place.height,
            mode: mode_of(texture),
            u_row,
            v_row,
            base: texture.base,
            gain: texture.gain,
        });
        self.textures.len() as u32 - 1
    }
}

fn mode_of(texture: &scene::Texture) -> u32 {
    let wrap = |wrap: Wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::Clamp => mode::CLAMP_U,
        Wrap::Mirror => mode::MIRROR_U,
    };
    let channel = match texture.channel {
        Channel::Rgb => 0,
        Channel::Red => 1,
        Channel::Green => 2,
        Channel::Blue => 3,
        Channel::Alpha => 4,
        Channel::Luminance => 5,
    };
    wrap(texture.wrap[0])
        | wrap(texture.wrap[1]) << 2
        | if texture.filter == Filter::Nearest { mode::NEAREST } else { 0 }
        | if texture.srgb { mode::SRGB } else { 0 }
        | if texture.uv_set == UvSet::Second { mode::SECOND_UVS } else { 0 }
        | channel << mode::CHANNEL_SHIFT
}
