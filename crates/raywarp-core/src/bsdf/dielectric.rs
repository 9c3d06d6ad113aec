//! Rough glass: light that is reflected and refracted by microfacets (Walter et al. 2007).
//!
//! `eta` is the index of refraction on the side of `view` over that on the other side. Radiance is scaled by `eta^2` where it
//! passes.

use super::{ggx, Evaluation};
use crate::arch;
use crate::math::{vec3, Vec3};
use crate::shade::optics::{fresnel, reflect, refract};

/// Of both lobes, where `tint` is the share of what passes.
#[inline(always)]
pub fn eval(view: Vec3, light: Vec3, alpha: f32, eta: f32, tint: Vec3) -> Evaluation {
    let mirrored = light.z > 0.0;
    let half = if mirrored { (view + light).normalize() } else { half_of_refraction(view, light, eta) };
    let (v, l) = (view.dot(half), light.dot(half));
    if half.z <= 0.0 || v <= 0.0 || (l < 0.0) == mirrored {
        return Evaluation::NONE;
    }
    let reflected = fresnel(v, eta);
    let seen = ggx::density_of_normal(view, half, alpha);
    if mirrored {
        let density = reflected * seen / (4.0 * v);
        return Evaluation { value: Vec3::splat(density * ggx::masking(light, alpha)), density };
    }
    // By which the solid angle of the normal becomes that of the direction: Walter's equation 17.
    let sum = arch::fma(eta, v, l);
    let density = (1.0 - reflected) * seen * -l / (sum * sum);
    Evaluation { value: tint * (density * ggx::masking(-light, alpha) * eta * eta), density }
}

/// The normal by which light is bent from one direction to the other, on the side of `view`; none where the two go straight on.
#[inline(always)]
fn half_of_refraction(view: Vec3, light: Vec3, eta: f32) -> Vec3 {
    let half = view.mul_add(eta, light).normalize();
    if half.z < 0.0 {
        -half
    } else {
        half
    }
}

/// A direction: mirrored or refracted by a microfacet, as Fresnel's equations say by chance. None where it leaves the
/// surface on the wrong side.
#[inline(always)]
pub fn sample(view: Vec3, alpha: f32, eta: f32, at: [f32; 2], lobe: f32) -> Option<Vec3> {
    let half = ggx::sample(view, alpha, at);
    let light = if lobe < fresnel(view.dot(half), eta) {
        Some(reflect(-view, half)).filter(|light| light.z > 0.0)
    } else {
        refract(-view, half, eta).filter(|light| light.z < 0.0)
    };
    light.map(Vec3::normalize)
}

/// The same of a smooth surface.
#[inline(always)]
pub fn straight(view: Vec3, eta: f32, lobe: f32) -> Vec3 {
    let up = vec3(0.0, 0.0, 1.0);
    let bent = if lobe < fresnel(view.z, eta) { None } else { refract(-view, up, eta) };
    match bent {
        Some(light) => light.normalize(),
        None => reflect(-view, up),
    }
}
