//! KHR_lights_punctual: lights shine along the negative z axis of their node.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use ::gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type};
use ::gltf::json::validation::Checked;
use glam::{DAffine3, DVec3};

use super::super::quote::quote;
use super::super::LoadError;
use super::phong::at_most;
use super::Reader;
use crate::{Light, LightKind};

/// Adds a light under the node's name, else its own. One without a direction or a place is left out with a warning.
///
/// A surface of reflectance `rho` that faces a light of `I` candela at distance `d` sends back `rho / pi * I / d^2`, so
/// [`Light::color`] is `I / pi`; for directional lights, in lux, likewise. The scale of the node does not matter.
pub(super) fn read(
    reader: &mut Reader,
    index: usize,
    node_name: Option<&str>,
    world: DAffine3,
) -> Result<(), LoadError> {
    let extensions = reader.root.extensions.as_ref();
    let lights = extensions.and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    let lights = lights.map_or(&[][..], |extension| &extension.lights);
    let json = lights.get(index).ok_or_else(|| {
        let expected = format!("an index below {}, the number of lights", lights.len());
        reader.origin.broken(format!("a node uses lights[{index}]"), expected)
    })?;
    let place_in_file = format!("lights[{index}]");
    let name = reader.copy_name(node_name.or(json.name.as_deref()).unwrap_or(&place_in_file))?;
    let Some(kind) = kind(json, world) else {
        return reader
            .warn(format!("light {} has no usable type or placement and is left out", quote(name.as_bytes())));
    };
    let directional = matches!(kind, LightKind::Directional { .. });
    reader.scene.lights.push(Light {
        name,
        kind,
        color: json.color.map(|channel| at_most(f32::MAX, channel * json.intensity / PI)),
        attenuation: if directional { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] },
        range: json.range.filter(|&range| range > 0.0 && !directional).unwrap_or(f32::INFINITY),
    });
    Ok(())
}

fn kind(json: &JsonLight, world: DAffine3) -> Option<LightKind> {
    let position = world.translation.to_array().map(|value| value as f32);
    if position.iter().any(|coordinate| !coordinate.is_finite()) {
        return None;
    }
    let direction = world.transform_vector3(DVec3::NEG_Z).try_normalize();
    let direction = direction.map(|direction| direction.to_array().map(|value| value as f32));
    match json.type_ {
        Checked::Valid(Type::Point) => Some(LightKind::Point { position }),
        Checked::Valid(Type::Directional) => Some(LightKind::Directional { direction: direction? }),
        Checked::Valid(Type::Spot) => {
            let angles =
                json.spot.as_ref().map_or((0.0, FRAC_PI_4), |spot| (spot.inner_cone_angle, spot.outer_cone_angle));
            let (inner, outer) = cone(angles.0, angles.1);
            Some(LightKind::Spot { position, direction: direction?, inner, outer })
        }
        Checked::Invalid => None,
    }
}

/// Angles of a cone, forced to `0 <= inner < outer <= pi/2`.
fn cone(inner: f32, outer: f32) -> (f32, f32) {
    let outer = outer.clamp(1e-3, FRAC_PI_2);
    (inner.clamp(0.0, outer * 0.999), outer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_are_never_empty() {
        assert_eq!(cone(0.1, 0.5), (0.1, 0.5));
        for (inner, outer) in [(0.5, 0.5), (-1.0, -1.0), (9.0, 9.0), (0.0, 0.0)] {
            let (inner, outer) = cone(inner, outer);
            assert!(0.0 <= inner && inner < outer && outer <= FRAC_PI_2);
        }
    }
}
