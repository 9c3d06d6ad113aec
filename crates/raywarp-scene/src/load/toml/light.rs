//! Lights, cameras and the sky of a scene file.

use toml::Spanned;

use super::complaint::Complaint;
use super::file::{self, Up};
use crate::{radians, Background, Camera, Light, LightKind, Projection};

/// A light as the file places it.
pub fn light(entry: &Spanned<file::Light>) -> Result<Light, Complaint> {
    let at = entry.span().start;
    let entry = entry.get_ref();
    let wrong = |read: &str, expected: &str| Err(Complaint::new(at, read, expected));
    let position = entry.position.map(plain);
    let kind = match entry.kind {
        file::LightKind::Point => {
            if entry.direction.is_some() || entry.target.is_some() {
                return wrong("a point light with a direction", "kind = \"spot\", or a position alone");
            }
            let Some(position) = position else {
                return wrong("a point light without position", "position = [x, y, z]");
            };
            LightKind::Point { position }
        }
        file::LightKind::Directional => {
            if position.is_some() || entry.attenuation.is_some() || entry.range.is_some() {
                return wrong("a directional light with a position, attenuation or range", "a direction alone");
            }
            LightKind::Directional { direction: direction(entry, [0.0; 3], at)? }
        }
        file::LightKind::Spot => {
            let Some(position) = position else {
                return wrong("a spot light without position", "position = [x, y, z]");
            };
            let (inner, outer) = cone(entry, at)?;
            LightKind::Spot { position, direction: direction(entry, position, at)?, inner, outer }
        }
    };
    if entry.kind != file::LightKind::Spot && (entry.inner.is_some() || entry.outer.is_some()) {
        return wrong("inner or outer without a cone", "them on a spot light alone");
    }
    let usual = Light::default();
    let attenuation = entry.attenuation.map_or(usual.attenuation, |terms| terms.map(|term| term.0));
    if attenuation == [0.0; 3] {
        return wrong("an attenuation of [0, 0, 0]", "at least one term above 0");
    }
    let intensity = entry.intensity.map_or(1.0, |number| number.0);
    let color = entry.color.map_or(usual.color, |color| color.0).map(|channel| channel * intensity);
    let range = entry.range.map_or(usual.range, |number| number.0);
    Ok(Light { name: entry.name.clone().unwrap_or_default(), kind, color, attenuation, range })
}

fn plain(vector: file::Vector) -> [f32; 3] {
    vector.map(|number| number.0)
}

/// The way that the light travels, given as such or by a point that it passes on its way from `from`.
fn direction(entry: &file::Light, from: [f32; 3], at: usize) -> Result<[f32; 3], Complaint> {
    let direction = match (entry.direction, entry.target, entry.kind) {
        (Some(direction), None, _) => plain(direction),
        (None, Some(target), file::LightKind::Spot) => {
            let target = plain(target);
            [0, 1, 2].map(|axis| target[axis] - from[axis])
        }
        (_, _, file::LightKind::Spot) => {
            return Err(Complaint::new(at, "a spot light without one way to shine", "direction or target"));
        }
        _ => return Err(Complaint::new(at, "a directional light without direction", "direction = [x, y, z]")),
    };
    if direction == [0.0; 3] {
        return Err(Complaint::new(at, "a light whose direction is zero", "a direction"));
    }
    Ok(direction)
}

/// Half angles in radians.
fn cone(entry: &file::Light, at: usize) -> Result<(f32, f32), Complaint> {
    let outer = entry.outer.map_or(45.0, |angle| angle.0);
    let inner = entry.inner.map_or(0.8 * outer, |angle| angle.0);
    let (inner_radians, outer_radians) = (radians(inner), radians(outer));
    if inner_radians >= outer_radians {
        let read = format!("a spot light with inner = {inner} and outer = {outer} degrees");
        return Err(Complaint::new(at, read, "inner below outer"));
    }
    Ok((inner_radians, outer_radians))
}

/// Vertical field of view of a camera that says none, in degrees.
const USUAL_FIELD_OF_VIEW: f64 = 45.0;

/// A camera as the file places it.
pub fn camera(entry: &Spanned<file::Camera>, up: Up) -> Result<Camera, Complaint> {
    let at = entry.span().start;
    let entry = entry.get_ref();
    let projection = match (entry.fov, entry.height) {
        (Some(_), Some(_)) => {
            return Err(Complaint::new(at, "a camera with fov and height", "one of them"));
        }
        (None, Some(height)) => Projection::Orthographic { height: height.0 },
        (fov, None) => Projection::Perspective { fov_y: radians(fov.map_or(USUAL_FIELD_OF_VIEW, |angle| angle.0)) },
    };
    let usual_up = if up == Up::Z { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
    let (eye, target) = (plain(entry.eye), plain(entry.target));
    let up = entry.up.map_or(usual_up, plain);
    if eye == target {
        return Err(Complaint::new(at, "a camera that looks at its own place", "a target other than eye"));
    }
    if up == [0.0; 3] {
        return Err(Complaint::new(at, "a camera whose up is zero", "a direction"));
    }
    Ok(Camera { name: entry.name.clone().unwrap_or_default(), eye, target, up, projection })
}

/// The sky.
pub fn background(entry: &file::Background) -> Background {
    match entry {
        file::Background::Constant(radiance) => Background::constant(*radiance),
        file::Background::Sky(sky) => Background { zenith: sky.zenith.0, horizon: sky.horizon.0, ground: sky.ground.0 },
    }
}
