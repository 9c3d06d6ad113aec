//! Lights, cameras and the sky of a scene file.

use toml::Spanned;

use super::complaint::Complaint;
use super::file::{self, Up};
use crate::{radians, Background, Camera, Light, LightKind, Projection};

/// A light as the file places it.
pub fn light(entry: &Spanned<file::Light>) -> Result<Light, Complaint> {
    let at = entry.span().start;
    let file::Light { given, others } = entry.get_ref();
    let mut light = Light { name: others.name.clone().unwrap_or_default(), ..Light::default() };
    given.apply(&mut light);
    match given.get("kind") {
        Some("point") => check_point(entry, at)?,
        Some("directional") => {
            check_directional(entry, at)?;
            light.kind = LightKind::Directional { direction: direction(entry.get_ref(), None, at)? };
        }
        Some(_) => light.kind = spot(entry.get_ref(), at)?,
        None => return wrong(at, "the key 'kind' is missing", "\"point\", \"directional\" or \"spot\""),
    }
    if !matches!(light.kind, LightKind::Spot { .. }) && (others.inner.is_some() || others.outer.is_some()) {
        return wrong(at, "inner or outer without a cone", "them on a spot light alone");
    }
    if light.attenuation == [0.0; 3] {
        return wrong(at, "an attenuation of [0, 0, 0]", "at least one term above 0");
    }
    let intensity = others.intensity.map_or(1.0, |number| number.0);
    light.color = light.color.map(|channel| channel * intensity);
    Ok(light)
}

fn wrong<T>(at: usize, read: &str, expected: &str) -> Result<T, Complaint> {
    Err(Complaint::new(at, read, expected))
}

fn plain(vector: file::Vector) -> [f32; 3] {
    vector.map(|number| number.0)
}

fn check_point(entry: &Spanned<file::Light>, at: usize) -> Result<(), Complaint> {
    let file::Light { given, others } = entry.get_ref();
    if given.get::<[f32; 3]>("direction").is_some() || others.target.is_some() {
        return wrong(at, "a point light with a direction", "kind = \"spot\", or a position alone");
    }
    match given.get::<[f32; 3]>("position") {
        Some(_) => Ok(()),
        None => wrong(at, "a point light without position", "position = [x, y, z]"),
    }
}

fn check_directional(entry: &Spanned<file::Light>, at: usize) -> Result<(), Complaint> {
    let given = &entry.get_ref().given;
    let placed = given.get::<[f32; 3]>("position").is_some() || given.get::<[f32; 3]>("attenuation").is_some();
    if placed || given.get::<f32>("range").is_some() {
        return wrong(at, "a directional light with a position, attenuation or range", "a direction alone");
    }
    Ok(())
}

fn spot(entry: &file::Light, at: usize) -> Result<LightKind, Complaint> {
    let Some(position) = entry.given.get("position") else {
        return wrong(at, "a spot light without position", "position = [x, y, z]");
    };
    let (inner, outer) = cone(&entry.others, at)?;
    Ok(LightKind::Spot { position, direction: direction(entry, Some(position), at)?, inner, outer })
}

/// The way that the light travels, given as such or, for a spot at a position, by a point that it passes on its way.
fn direction(entry: &file::Light, spot: Option<[f32; 3]>, at: usize) -> Result<[f32; 3], Complaint> {
    let direction = match (entry.given.get("direction"), entry.others.target, spot) {
        (Some(direction), None, _) => direction,
        (None, Some(target), Some(from)) => {
            let target = plain(target);
            [0, 1, 2].map(|axis| target[axis] - from[axis])
        }
        (_, _, Some(_)) => return wrong(at, "a spot light without one way to shine", "direction or target"),
        _ => return wrong(at, "a directional light without direction", "direction = [x, y, z]"),
    };
    if direction == [0.0; 3] {
        return wrong(at, "a light whose direction is zero", "a direction");
    }
    Ok(direction)
}

/// Half angles in radians. Compared in degrees as they are written.
fn cone(entry: &file::LightKeys, at: usize) -> Result<(f32, f32), Complaint> {
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
