//! The material of glTF 2.0, appendix B: metal, or what is no metal, under GGX's lobe.
//!
//! `metallic * M + (1 - metallic) * D` with `M = F_metal * specular`, and `D` of the parts that KHR_materials_transmission
//! and KHR_materials_volume name: an opaque dielectric `mix(diffuse, specular, F)`, of which a share lets light through instead
//! of being matt (a thin wall: without being bent, as rough as the mirrored lobe), or, with a volume, rough glass. Fresnel's
//! reflectance is Schlick's on the half vector, as the specification has it; that of glass, which must know total
//! reflection, is exact. No lobe gives back what bounces between microfacets.

use super::{dielectric, diffuse, ggx, Evaluation, PointMaterial, Sample};
use crate::arch;
use crate::math::{vec3, Vec3};
use crate::shade::optics::{reflect, schlick};
use crate::texture::luminance;

/// What lies behind a surface that encloses a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inside {
    /// Index of refraction on the side that is seen over that on the other.
    pub eta: f32,
}

/// A material at a point, seen from a direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    view: Vec3,
    material: PointMaterial,
    alpha: f32,
    /// Of a volume; 1 for thin walls.
    eta: f32,
    volume: f32,
    choice: Choice,
}

/// Probabilities of the lobes; they sum to 1, or are all 0 for a surface that is black.
#[derive(Clone, Copy, Debug)]
struct Choice {
    specular: f32,
    diffuse: f32,
    thin: f32,
    glass: f32,
}

impl Bsdf {
    /// Of a material seen from `view`, whose z is above 0; with what lies inside, if it encloses a volume.
    #[inline(always)]
    pub fn new(view: Vec3, material: PointMaterial, inside: Option<Inside>) -> Self {
        let eta = match inside {
            Some(Inside { eta }) => eta,
            None => 1.0,
        };
        let mut bsdf = Self {
            view,
            material,
            alpha: material.roughness * material.roughness,
            eta,
            volume: if inside.is_some() { material.transmission } else { 0.0 },
            choice: Choice { specular: 0.0, diffuse: 0.0, thin: 0.0, glass: 0.0 },
        };
        bsdf.choice = bsdf.choose();
        bsdf
    }

    /// Whether all light that the surface scatters goes one way, so that it is never found by looking for lights.
    #[inline(always)]
    pub fn is_smooth(&self) -> bool {
        self.alpha < ggx::SMOOTH
    }

    /// The same of its glass: rough or not, it bends nothing where both sides are alike.
    #[inline(always)]
    fn is_clear(&self) -> bool {
        self.is_smooth() || (self.eta - 1.0).abs() < 1e-3
    }

    /// Whether looking for lights can find anything.
    #[inline(always)]
    pub fn has_density(&self) -> bool {
        self.choice.diffuse > 0.0 || !self.is_smooth()
    }

    /// Each lobe about as often as it is bright from here.
    #[inline(always)]
    fn choose(&self) -> Choice {
        let whole = self.whole(self.view.z);
        let specular = luminance(whole.specular);
        let (diffuse, thin) = (luminance(whole.diffuse), luminance(whole.thin));
        let glass = (1.0 - self.material.metallic) * self.volume;
        let sum = specular + diffuse + thin + glass;
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Choice { specular: specular * scale, diffuse: diffuse * scale, thin: thin * scale, glass: glass * scale }
    }

    /// What the lobes are multiplied by where the half vector has a cosine; that of glass is its own.
    #[inline(always)]
    fn whole(&self, cosine: f32) -> Whole {
        let PointMaterial { base_color, metallic, reflectance, grazing, transmission, .. } = self.material;
        let toward = schlick(cosine);
        let dielectric = (Vec3::splat(grazing) - reflectance).mul_add(toward, reflectance);
        let metal = (Vec3::ONE - base_color).mul_add(toward, base_color);
        let opaque = (1.0 - metallic) * (1.0 - self.volume);
        let below = base_color * (opaque * (1.0 - dielectric.max_abs()));
        let thin = if self.volume > 0.0 { 0.0 } else { transmission };
        Whole {
            specular: metal.mul_add(metallic, dielectric * opaque),
            diffuse: below * (1.0 - thin),
            thin: below * thin,
        }
    }

    /// The function towards a direction, without what goes one way only.
    #[inline(always)]
    pub fn eval(&self, light: Vec3) -> Evaluation {
        let mut all = Evaluation::NONE;
        let rough = !self.is_smooth();
        // A thin wall sends through what it would mirror.
        let mirrored = vec3(light.x, light.y, light.z.abs());
        let half = (self.view + mirrored).normalize();
        let whole = self.whole(self.view.dot(half));
        let mut add = |share: Vec3, probability: f32, lobe: Evaluation| {
            all.value += share * lobe.value;
            all.density = arch::fma(probability, lobe.density, all.density);
        };
        if light.z > 0.0 {
            add(whole.diffuse, self.choice.diffuse, diffuse::eval(light));
        }
        if rough && light.z != 0.0 {
            let lobe = self.mirrored_lobe(mirrored, half);
            if light.z > 0.0 {
                add(whole.specular, self.choice.specular, lobe);
            } else {
                add(whole.thin, self.choice.thin, lobe);
            }
        }
        if !self.is_clear() && self.choice.glass > 0.0 && light.z != 0.0 {
            let lobe = dielectric::eval(self.view, light, self.alpha, self.eta, self.material.base_color);
            add(Vec3::splat((1.0 - self.material.metallic) * self.volume), self.choice.glass, lobe);
        }
        all
    }

    #[inline(always)]
    fn mirrored_lobe(&self, light: Vec3, half: Vec3) -> Evaluation {
        let facets = ggx::distribution(half, self.alpha);
        let value = facets * ggx::visibility(self.view, light, self.alpha) * light.z;
        let density = ggx::density_of_mirrored(self.view, half, self.alpha);
        Evaluation { value: Vec3::splat(value), density }
    }

    /// A direction by a point of the unit square and a number that chooses the lobe; none where the light ends here.
    #[inline(always)]
    pub fn sample(&self, at: [f32; 2], lobe: f32) -> Option<Sample> {
        let Choice { specular, diffuse, thin, glass } = self.choice;
        let smooth = self.is_smooth();
        let light = if lobe < diffuse {
            diffuse::sample(at)
        } else if lobe < diffuse + specular + thin {
            let through = lobe >= diffuse + specular;
            if smooth {
                return Some(self.one_way(through));
            }
            let half = ggx::sample(self.view, self.alpha, at);
            let light = reflect(-self.view, half).normalize();
            if light.z <= 0.0 {
                return None;
            }
            if through {
                vec3(light.x, light.y, -light.z)
            } else {
                light
            }
        } else if glass > 0.0 {
            let rest = arch::max(lobe - (1.0 - glass), 0.0) / glass;
            if self.is_clear() {
                return self.clear(rest);
            }
            dielectric::sample(self.view, self.alpha, self.eta, at, rest)?
        } else {
            return None;
        };
        let Evaluation { value, density } = self.eval(light);
        (density > 0.0).then(|| Sample { light, weight: value / density, density })
    }

    /// Mirrored, or through a smooth thin wall.
    #[inline(always)]
    fn one_way(&self, through: bool) -> Sample {
        let whole = self.whole(self.view.z);
        let (light, share, probability) = if through {
            (-self.view, whole.thin, self.choice.thin)
        } else {
            (vec3(-self.view.x, -self.view.y, self.view.z), whole.specular, self.choice.specular)
        };
        Sample { light, weight: share / probability, density: f32::INFINITY }
    }

    /// Mirrored or bent by smooth glass.
    #[inline(always)]
    fn clear(&self, lobe: f32) -> Option<Sample> {
        let light = dielectric::straight(self.view, self.eta, lobe);
        let share = (1.0 - self.material.metallic) * self.volume / self.choice.glass;
        let tint = if light.z > 0.0 { Vec3::ONE } else { self.material.base_color * (self.eta * self.eta) };
        Some(Sample { light, weight: tint * share, density: f32::INFINITY })
    }
}

/// What multiplies the lobes.
struct Whole {
    specular: Vec3,
    diffuse: Vec3,
    thin: Vec3,
}
