//! Cameras made ready for the kernels.

use glam::Vec3;
use raywarp_core::camera as kernel;
use raywarp_core::math;

use super::RenderError;
use crate::scene::{Camera, Projection};
use crate::Ray;

/// The camera for pictures of a size.
pub(crate) fn kernel_camera(camera: &Camera, [width, height]: [u32; 2]) -> Result<kernel::Camera, RenderError> {
    let refuse = |problem| Err(RenderError::Camera { name: camera.name.clone(), problem });
    let (eye, axes) = (camera.eye.into(), axes(camera)?);
    match camera.projection {
        Projection::Perspective { fov_y } if fov_y > 0.0 && fov_y < std::f32::consts::PI => {
            Ok(kernel::Camera::pinhole(eye, axes, (0.5 * fov_y).tan(), width, height))
        }
        Projection::Orthographic { height: extent } if extent > 0.0 && extent.is_finite() => {
            Ok(kernel::Camera::orthographic(eye, axes, extent, width, height))
        }
        Projection::Perspective { .. } => refuse("has a field of view that is not between 0 and 180 degrees"),
        Projection::Orthographic { .. } => refuse("has no height"),
    }
}

/// The ray through a point of a picture, in pixels from its upper left corner; of unit direction. Through the middle of a
/// pixel, at a half each way, it is the one that [`Tracer::layers`](super::Tracer::layers) traces.
///
/// # Errors
/// [`RenderError::Camera`] for a camera that cannot be rendered from.
pub fn ray(camera: &Camera, size: [u32; 2], [x, y]: [f32; 2]) -> Result<Ray, RenderError> {
    Ok(kernel_camera(camera, size)?.ray(x, y))
}

/// Right, up and forward of a camera, orthonormal: a pinhole's ray through the middle of the picture goes forward.
///
/// # Errors
/// [`RenderError::Camera`] for a camera without a direction or at no finite place.
pub fn axes(camera: &Camera) -> Result<[math::Vec3; 3], RenderError> {
    let refuse = |problem| Err(RenderError::Camera { name: camera.name.clone(), problem });
    let eye = Vec3::from(camera.eye);
    let view = Vec3::from(camera.target) - eye;
    if !eye.is_finite() || !view.is_finite() || !Vec3::from(camera.up).is_finite() {
        return refuse("is not at a finite place");
    }
    let Some(forward) = unit(view) else { return refuse("stands on its own target") };
    let right = [Vec3::from(camera.up), Vec3::Y, Vec3::Z].into_iter().find_map(|up| {
        let up = unit(up)?;
        unit_above(forward.cross(up), 1e-4)
    });
    let Some(right) = right else { return refuse("has no upward direction") };
    Ok([right, right.cross(forward), forward].map(|axis| axis.to_array().into()))
}

/// The unit vector, however short or long; none for zero.
fn unit(v: Vec3) -> Option<Vec3> {
    let largest = v.abs().max_element();
    (largest > 0.0).then(|| (v / largest).normalize())
}

fn unit_above(v: Vec3, least: f32) -> Option<Vec3> {
    if v.length() > least {
        unit(v)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(projection: Projection) -> Camera {
        Camera { name: "c".into(), eye: [0.0, 0.0, 5.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], projection }
    }

    #[test]
    fn the_centre_looks_at_the_target_and_the_edges_span_the_angle() {
        let fov_y = 1.0f32;
        let ready = kernel_camera(&camera(Projection::Perspective { fov_y }), [200, 100]).unwrap();
        let centre = ready.ray(100.0, 50.0).direction;
        assert!((centre.z + 1.0).abs() < 1e-6 && centre.x.abs() < 1e-6);
        let top = ready.ray(100.0, 0.0).direction;
        assert!(((top.y / -top.z) - (0.5 * fov_y).tan()).abs() < 1e-5 && top.y > 0.0);
        let left = ready.ray(0.0, 50.0).direction;
        assert!(((left.x / left.z) - 2.0 * (0.5 * fov_y).tan()).abs() < 1e-5 && left.x < 0.0);
    }

    #[test]
    fn parallel_rays_start_side_by_side() {
        let ready = kernel_camera(&camera(Projection::Orthographic { height: 4.0 }), [100, 100]).unwrap();
        let corner = ready.ray(0.0, 0.0);
        assert!((corner.origin.x + 2.0).abs() < 1e-5 && (corner.origin.y - 2.0).abs() < 1e-5);
        assert_eq!(corner.direction, ready.ray(80.0, 3.0).direction);
    }

    #[test]
    fn looking_along_up_still_gives_a_picture_and_no_direction_does_not() {
        let mut c = camera(Projection::Perspective { fov_y: 1.0 });
        c.up = [0.0, 0.0, 1.0];
        assert!(kernel_camera(&c, [10, 10]).is_ok());
        c.target = c.eye;
        let message = kernel_camera(&c, [10, 10]).unwrap_err().to_string();
        assert!(message.contains("stands on its own target"), "{message}");
        assert!(kernel_camera(&camera(Projection::Perspective { fov_y: 4.0 }), [10, 10]).is_err());
    }
}
