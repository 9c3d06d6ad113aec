//! Mirrors and glass.

use crate::arch;
use crate::math::{clamp, Vec3};

/// The mirror direction of `incident` about `normal`; any length of `incident` is kept.
#[inline(always)]
pub fn reflect(incident: Vec3, normal: Vec3) -> Vec3 {
    normal.mul_add(-2.0 * incident.dot(normal), incident)
}

/// Snell's law: where a unit vector `incident` goes that meets a surface with unit `normal` on its own side, `eta` being
/// the index of refraction it comes from over the one it enters. None for total internal reflection.
#[inline(always)]
pub fn refract(incident: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cosine = -incident.dot(normal);
    let square = arch::fma(-eta * eta, arch::fma(-cosine, cosine, 1.0), 1.0);
    (square >= 0.0).then(|| incident.mul_add(eta, normal * arch::fma(eta, cosine, -arch::sqrt(square))))
}

/// Fresnel's reflectance of a dielectric for unpolarised light: `cosine` of the angle of incidence, `eta` as in
/// [`refract`]. 1 for total internal reflection.
#[inline(always)]
pub fn fresnel(cosine: f32, eta: f32) -> f32 {
    let cosine = clamp(cosine, 0.0, 1.0);
    let square = arch::fma(-eta * eta, arch::fma(-cosine, cosine, 1.0), 1.0);
    if square < 0.0 {
        return 1.0;
    }
    let refracted = arch::sqrt(square);
    let parallel = (cosine - eta * refracted) / (cosine + eta * refracted);
    let perpendicular = (eta * cosine - refracted) / (eta * cosine + refracted);
    0.5 * arch::fma(parallel, parallel, perpendicular * perpendicular)
}

/// Schlick's share of the way from the reflectance at normal incidence to 1: `(1 - cosine)^5`.
#[inline(always)]
pub fn schlick(cosine: f32) -> f32 {
    let x = 1.0 - clamp(cosine, 0.0, 1.0);
    let square = x * x;
    square * square * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    const UP: Vec3 = vec3(0.0, 1.0, 0.0);

    fn incident(degrees: f32) -> Vec3 {
        let angle = degrees.to_radians();
        vec3(angle.sin(), -angle.cos(), 0.0)
    }

    #[test]
    fn mirror_angle_equals_angle_of_incidence() {
        assert_eq!(reflect(vec3(3.0, -4.0, 1.0), UP), vec3(3.0, 4.0, 1.0));
    }

    #[test]
    fn snell_holds_into_and_out_of_glass() {
        for degrees in [0.0f32, 10.0, 41.0, 60.0, 89.0] {
            let inside = refract(incident(degrees), UP, 1.0 / 1.5).unwrap();
            assert!((inside.x * 1.5 - degrees.to_radians().sin()).abs() < 1e-6, "{degrees}");
            assert!((inside.length() - 1.0).abs() < 1e-6, "{degrees}");
        }
        // The critical angle of glass is asin(1 / 1.5) = 41.81 degrees.
        assert!(refract(incident(41.7), UP, 1.5).is_some());
        assert!(refract(incident(41.9), UP, 1.5).is_none());
    }

    #[test]
    fn fresnel_matches_textbook_values() {
        // ((n - 1) / (n + 1))^2 at normal incidence; no parallel part at Brewster's angle, atan(1.5) = 56.31 degrees.
        assert!((fresnel(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-6);
        assert!((fresnel(1.0, 1.5) - 0.04).abs() < 1e-6);
        let brewster = 1.5f32.atan();
        let perpendicular = (2.0 * brewster).cos().powi(2);
        assert!((fresnel(brewster.cos(), 1.0 / 1.5) - 0.5 * perpendicular).abs() < 1e-6);
        assert_eq!(fresnel(0.0, 1.0 / 1.5), 1.0);
        assert_eq!(fresnel(42.0f32.to_radians().cos(), 1.5), 1.0);
    }
}
