//! Physically based surfaces: the metallic-roughness model of glTF 2.0.

use crate::{Material, Texture};

/// How a surface answers light by the model of glTF 2.0, appendix B, with KHR_materials_ior, KHR_materials_specular,
/// KHR_materials_transmission and KHR_materials_volume. What it does not say is said by its [`Material`]: emission, coverage,
/// normal map, absorption, sidedness, and [`Material::diffuse_map`], which multiplies the base colour.
#[derive(Clone, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// Diffuse reflectance of what is no metal, and reflectance of metal seen from the front.
    pub base_color: [f32; 3],
    /// Share of metal, from 0 to 1.
    pub metallic: f32,
    /// From 0, a mirror, to 1; the slopes of its microfacets are about as large as its square.
    pub roughness: f32,
    /// Strength of the reflection of what is no metal, from 0 to 1.
    pub specular: f32,
    /// Tint of that reflection seen from the front, 0 or more.
    pub specular_color: [f32; 3],
    /// Index of refraction of the inside against the outside, 1 or more: 1.5 reflects 4 % from the front.
    pub ior: f32,
    /// Share of light that passes through what is neither metal nor reflecting, tinted by the base colour, from 0 to 1.
    pub transmission: f32,
    /// It is the wall of nothing: light that passes is not bent. Else it encloses a volume.
    pub thin: bool,
    /// Multiplies `metallic`.
    pub metallic_map: Option<Texture>,
    /// Multiplies `roughness`.
    pub roughness_map: Option<Texture>,
    /// Multiplies `transmission`.
    pub transmission_map: Option<Texture>,
    /// Share of light that arrives from all around where an approximation needs it; path tracing finds that out by itself.
    pub occlusion_map: Option<Texture>,
}

impl Default for MetallicRoughness {
    /// That of glTF: white, metal and rough, but for [`metallic`](Self::metallic), which is 0 here.
    fn default() -> Self {
        Self {
            base_color: [1.0; 3],
            metallic: 0.0,
            roughness: 1.0,
            specular: 1.0,
            specular_color: [1.0; 3],
            ior: 1.5,
            transmission: 0.0,
            thin: true,
            metallic_map: None,
            roughness_map: None,
            transmission_map: None,
            occlusion_map: None,
        }
    }
}

impl MetallicRoughness {
    /// What stands for Phong's model:
    /// - Mirror reflection is a smooth layer that reflects so much from the front, and more at grazing angles.
    /// - Without it, a highlight is GGX's lobe of the width `sqrt(2 / (shininess + 2))`, which is about as wide; a `specular` of
    ///   1 reflects 8 % from the front, 0 nothing at any angle.
    /// - Transmission is that of glass with the material's index of refraction, or of a thin wall where that is 1. What lets
    ///   through more than half has the colour of its transmission.
    /// - The rest is matt.
    pub fn of_phong(material: &Material) -> Self {
        let largest = |color: [f32; 3]| color.into_iter().fold(0.0f32, f32::max);
        let mirrors = largest(material.reflection) > 0.0;
        let transmission = largest(material.transmission).min(1.0);
        let width = (2.0 / (material.shininess.max(0.0) + 2.0)).sqrt();
        let clear = transmission > 0.5;
        let reflectance = if mirrors { material.reflection } else { material.specular.map(|channel| 0.08 * channel) };
        Self {
            base_color: match clear {
                true => material.transmission.map(|channel| channel / largest(material.transmission)),
                false => material.diffuse,
            },
            roughness: if mirrors || clear { 0.0 } else { width.sqrt() },
            specular: if largest(reflectance) > 0.0 { 1.0 } else { 0.0 },
            // Of an index of refraction of 1.5.
            specular_color: reflectance.map(|channel| channel / 0.04),
            ior: if transmission > 0.0 && material.ior != 1.0 { material.ior } else { 1.5 },
            transmission,
            thin: material.ior == 1.0,
            ..Self::default()
        }
    }

    /// All of its textures.
    pub(crate) fn maps_mut(&mut self) -> [&mut Option<Texture>; 4] {
        [&mut self.metallic_map, &mut self.roughness_map, &mut self.transmission_map, &mut self.occlusion_map]
    }

    /// Reflectance from the front of what is no metal.
    pub fn reflectance(&self) -> [f32; 3] {
        let ratio = (self.ior - 1.0) / (self.ior + 1.0);
        self.specular_color.map(|tint| (ratio * ratio * tint).clamp(0.0, 1.0) * self.specular)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_reflects_from_the_front_follows_from_the_index_of_refraction() {
        let glass = MetallicRoughness::default();
        assert!(glass.reflectance().iter().all(|r| (r - 0.04).abs() < 1e-6));
        let tinted = MetallicRoughness { specular: 0.5, specular_color: [1.0, 0.0, 100.0], ..glass.clone() };
        let [red, green, blue] = tinted.reflectance();
        assert!((red - 0.02).abs() < 1e-6 && green == 0.0 && blue == 0.5);
        assert_eq!(MetallicRoughness { ior: 1.0, ..glass }.reflectance(), [0.0; 3]);
    }

    #[test]
    fn phong_is_matt_unless_it_shines_mirrors_or_lets_light_through() {
        let of = |material: Material| MetallicRoughness::of_phong(&material);
        let matt = of(Material::default());
        assert_eq!((matt.base_color, matt.reflectance()), ([0.7; 3], [0.0; 3]));
        let shiny = of(Material { specular: [0.5; 3], shininess: 198.0, ..Material::default() });
        assert!((shiny.roughness.powi(4) - 0.01).abs() < 1e-6 && (shiny.reflectance()[0] - 0.04).abs() < 1e-6);
        let mirror = of(Material { reflection: [0.9, 0.8, 0.7], ..Material::default() });
        assert!(mirror.roughness == 0.0 && (mirror.reflectance()[1] - 0.8).abs() < 1e-6);
        let glass = of(Material { transmission: [0.8, 0.4, 0.8], ior: 1.3, ..Material::default() });
        assert_eq!((glass.base_color, glass.ior, glass.thin), ([1.0, 0.5, 1.0], 1.3, false));
        assert!(of(Material { transmission: [0.8; 3], ..Material::default() }).thin);
    }
}
