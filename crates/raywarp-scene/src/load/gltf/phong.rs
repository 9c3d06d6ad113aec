//! From physically based parameters to Phong's.
//!
//! An approximation for the tracer of the paper; what Phong's model lacks is said here.
//! - Reflectance at normal incidence: `F0 = mix(dielectric, base, metallic)`, the dielectric's from the index of
//!   refraction and KHR_materials_specular, 0.04 where the file is silent.
//! - The highlight has the exponent `2 / alpha^2 - 2` with `alpha = roughness^2`, clamped to 1 to 2048, which gives
//!   Phong's lobe about the width of GGX's, and GGX's height at its peak, `F0 / (4 alpha^2)`, but never more than 1.
//!   Rough surfaces so have a weak one.
//! - The diffuse reflectance is `base (1 - metallic)`, and for metals `alpha base`: the lobe of a rough metal is nearly
//!   as wide as the diffuse one, and would otherwise be black without a light in its highlight.
//! - Mirror reflection is `F0 (1 - roughness)^2`, and fades to nothing between the roughnesses 0.25 and 0.5: a mirror
//!   has no blur. Fresnel's equations apply where there is any.
//! - Transmission is tinted by the base colour and taken from the diffuse reflectance. It bends rays only in a material
//!   with a volume; other surfaces are thin walls.
//! - What tints the base colour (its texture, colours of vertices) tints the highlight and the mirror of what is more
//!   metal than not; of what is less, only by the mean of the texture.
//! - Volumes absorb by Beer's law. Occlusion and anything rough about transmission is left out.

use crate::Material;

/// The parameters of a surface, each from 0 to 1.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub base: [f32; 3],
    /// Mean of what the base colour is multiplied by from point to point.
    pub tint: [f32; 3],
    pub metallic: f32,
    pub roughness: f32,
    /// Reflectance at normal incidence of what is no metal.
    pub dielectric: [f32; 3],
    pub transmission: f32,
    /// Index of refraction; 1 for thin walls.
    pub ior: f32,
}

impl Surface {
    /// Sets the colours of a material.
    pub fn apply_to(&self, material: &mut Material) {
        let alpha = self.roughness * self.roughness;
        let tinted = self.reflectance(self.tint);
        material.metallic = self.metallic > 0.5;
        let reflectance = if material.metallic { self.reflectance([1.0; 3]) } else { tinted };
        let opaque = (1.0 - self.transmission) * (1.0 - self.metallic) + self.metallic * alpha;
        material.diffuse = self.base.map(|base| base * opaque);
        material.ambient = material.diffuse;
        material.shininess = (2.0 / (alpha * alpha) - 2.0).clamp(1.0, 2048.0);
        let brightest = tinted.into_iter().fold(0.0, f32::max);
        let peak = (1.0 / (4.0 * alpha * alpha)).min(1.0 / brightest.max(f32::MIN_POSITIVE));
        material.specular = reflectance.map(|channel| channel * peak);
        let transmitted = self.transmission * (1.0 - self.metallic);
        // Where light is bent, Fresnel's equations bring the dielectric's reflection themselves; a thin wall sends
        // through what it does not reflect.
        let bends = self.ior != 1.0;
        let mirrored = if bends && transmitted > 0.0 { 0.0 } else { mirror_share(self.roughness) };
        material.reflection = reflectance.map(|channel| channel * mirrored);
        material.fresnel = material.reflection != [0.0; 3] || (bends && transmitted > 0.0);
        let share = |c: usize| transmitted * if bends { 1.0 } else { 1.0 - reflectance[c] };
        material.transmission = std::array::from_fn(|c| self.base[c] * share(c));
        material.ior = self.ior;
    }

    fn reflectance(&self, tint: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|c| self.dielectric[c] + (self.base[c] * tint[c] - self.dielectric[c]) * self.metallic)
    }
}

fn mirror_share(roughness: f32) -> f32 {
    let fade = ((0.5 - roughness) / 0.25).clamp(0.0, 1.0);
    (1.0 - roughness) * (1.0 - roughness) * fade
}

/// Reflectance at normal incidence between air and an index of refraction.
pub(super) fn reflectance_of(ior: f32) -> f32 {
    let ratio = (ior - 1.0) / (ior + 1.0);
    ratio * ratio
}

/// The value from 0 to a limit; 0 for NaN, which zero times an overflowed factor is.
pub(super) fn at_most(limit: f32, value: f32) -> f32 {
    match value > 0.0 {
        true => value.min(limit),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLASTIC: Surface = Surface {
        base: [0.5, 0.25, 1.0],
        tint: [1.0; 3],
        metallic: 0.0,
        roughness: 1.0,
        dielectric: [0.04; 3],
        transmission: 0.0,
        ior: 1.0,
    };

    fn material(surface: Surface) -> Material {
        let mut material = Material::default();
        surface.apply_to(&mut material);
        material
    }

    #[test]
    fn rough_plastic_is_nearly_diffuse() {
        let material = material(PLASTIC);
        assert_eq!(material.diffuse, [0.5, 0.25, 1.0]);
        assert_eq!(material.ambient, material.diffuse);
        assert_eq!(material.specular, [0.01; 3]);
        assert_eq!(material.shininess, 1.0);
        assert_eq!(material.reflection, [0.0; 3]);
        assert!(!material.fresnel);
    }

    #[test]
    fn polished_plastic_mirrors_a_little() {
        let material = material(Surface { roughness: 0.0, ..PLASTIC });
        assert_eq!(material.reflection, [0.04; 3]);
        assert_eq!(material.shininess, 2048.0);
        assert!(material.fresnel);
        assert!(material.specular.iter().all(|&channel| (channel - 1.0).abs() < 1e-6));
    }

    #[test]
    fn polished_metal_mirrors_its_color_and_nothing_else() {
        let material = material(Surface { metallic: 1.0, roughness: 0.0, ..PLASTIC });
        assert_eq!(material.diffuse, [0.0; 3]);
        assert_eq!(material.reflection, [0.5, 0.25, 1.0]);
    }

    #[test]
    fn metal_of_a_tint_answers_as_one_of_that_color() {
        let gold = [1.0, 0.5, 0.25];
        let metal = |base, tint| material(Surface { base, tint, metallic: 1.0, roughness: 0.3, ..PLASTIC });
        let (painted, solid) = (metal([1.0; 3], gold), metal(gold, [1.0; 3]));
        assert!(painted.metallic && solid.metallic);
        let tinted = |color: [f32; 3]| std::array::from_fn(|c| color[c] * gold[c]);
        assert_eq!((tinted(painted.specular), tinted(painted.reflection)), (solid.specular, solid.reflection));
        let half = material(Surface { base: [1.0; 3], tint: gold, metallic: 0.5, ..PLASTIC });
        assert!(!half.metallic && half.specular[0] > half.specular[2], "of half a metal the mean counts");
    }

    #[test]
    fn rough_metal_is_not_black() {
        let material = material(Surface { metallic: 1.0, ..PLASTIC });
        assert_eq!(material.diffuse, PLASTIC.base);
        assert_eq!(material.reflection, [0.0; 3]);
    }

    #[test]
    fn glass_passes_what_it_does_not_scatter() {
        let material = material(Surface { transmission: 0.75, roughness: 0.0, ior: 1.5, ..PLASTIC });
        assert_eq!(material.transmission, [0.375, 0.1875, 0.75]);
        assert_eq!(material.diffuse, [0.125, 0.0625, 0.25]);
        assert_eq!(material.ior, 1.5);
    }

    #[test]
    fn every_parameter_gives_finite_colors() {
        for roughness in [0.0, 1e-20, 0.3, 1.0] {
            for dielectric in [[0.0; 3], [1.0; 3]] {
                let material = material(Surface { roughness, dielectric, ..PLASTIC });
                assert!(material.shininess.is_finite());
                assert!(material.specular.iter().all(|channel| (0.0..=1.0).contains(channel)), "{material:?}");
            }
        }
    }

    #[test]
    fn factors_are_forced_into_range() {
        let values = [f32::NAN, -1.0, 0.5, 3.0, f32::INFINITY].map(|value| at_most(1.0, value));
        assert_eq!(values, [0.0, 0.0, 0.5, 1.0, 1.0]);
    }

    #[test]
    fn glass_reflects_a_twenty_fifth() {
        assert!((reflectance_of(1.5) - 0.04).abs() < 1e-7);
    }
}
