//! Cameras look along the negative z axis of their node, y up.

use std::f32::consts::PI;

use ::gltf::json::camera::{self, Type};
use ::gltf::json::validation::Checked;
use glam::{DAffine3, DVec3};

use super::super::quote::quote;
use super::super::LoadError;
use super::Reader;
use crate::{Camera, Projection};

/// Adds a camera under the node's name, else its own. One that no picture can be taken with is left out with a warning.
pub(super) fn read(
    reader: &mut Reader,
    index: usize,
    node_name: Option<&str>,
    world: DAffine3,
) -> Result<(), LoadError> {
    let cameras = &reader.root.cameras;
    let json = cameras.get(index).ok_or_else(|| {
        let expected = format!("an index below {}, the number of cameras", cameras.len());
        reader.origin.broken(format!("a node uses cameras[{index}]"), expected)
    })?;
    let place_in_file = format!("cameras[{index}]");
    let name = reader.copy_name(node_name.or(json.name.as_deref()).unwrap_or(&place_in_file))?;
    let view = world.transform_vector3(DVec3::NEG_Z).try_normalize();
    let up = world.transform_vector3(DVec3::Y).try_normalize();
    let (Some(projection), Some(view), Some(up), true) = (projection(json), view, up, world.translation.is_finite())
    else {
        return reader
            .warn(format!("camera {} has no usable projection or placement and is left out", quote(name.as_bytes())));
    };
    let narrow = |vector: DVec3| vector.to_array().map(|value| value as f32);
    reader.scene.cameras.push(Camera {
        name,
        eye: narrow(world.translation),
        // Where glTF looks has no distance: one unit ahead.
        target: narrow(world.translation + view),
        up: narrow(up),
        projection,
    });
    Ok(())
}

fn projection(json: &camera::Camera) -> Option<Projection> {
    match (&json.type_, &json.perspective, &json.orthographic) {
        (Checked::Valid(Type::Perspective), Some(perspective), _) => {
            let fov_y = perspective.yfov;
            (fov_y > 0.0 && fov_y < PI).then_some(Projection::Perspective { fov_y })
        }
        (Checked::Valid(Type::Orthographic), _, Some(orthographic)) => {
            let height = 2.0 * orthographic.ymag.abs();
            (height > 0.0 && height.is_finite()).then_some(Projection::Orthographic { height })
        }
        _ => None,
    }
}
