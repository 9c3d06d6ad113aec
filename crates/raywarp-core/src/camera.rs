//! Rays from a viewpoint.

use crate::math::{vec3, Vec3};
use crate::ray::Ray;

/// A camera made ready: a ray is `eye + shift` towards `forward + x right + y down`, with `x` and `y` in pixels.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where rays start for the picture's upper left corner.
    pub eye: Vec3,
    /// Direction of the ray through the picture's upper left corner.
    pub corner: Vec3,
    /// Change of the direction from a pixel to its right neighbour.
    pub right: Vec3,
    /// Change of the direction from a pixel to its lower neighbour.
    pub down: Vec3,
    /// Change of the start from a pixel to its right neighbour; zero for a pinhole.
    pub eye_right: Vec3,
    /// Change of the start from a pixel to its lower neighbour; zero for a pinhole.
    pub eye_down: Vec3,
}

impl Camera {
    /// A pinhole at `eye`, looking along `forward`, for a picture of `width` x `height` pixels that spans the vertical
    /// angle with tangent of its half `tan_half_fov`. The three directions are orthonormal, `right` x `up` = `-forward`.
    pub fn pinhole(eye: Vec3, [right, up, forward]: [Vec3; 3], tan_half_fov: f32, width: u32, height: u32) -> Self {
        let pixel = 2.0 * tan_half_fov / height as f32;
        let (right, down) = (right * pixel, up * -pixel);
        let corner = forward - right * (0.5 * width as f32) - down * (0.5 * height as f32);
        Self { eye, corner, right, down, eye_right: Vec3::ZERO, eye_down: Vec3::ZERO }
    }

    /// Parallel rays along `forward` for a picture `extent` scene units high.
    pub fn orthographic(eye: Vec3, [right, up, forward]: [Vec3; 3], extent: f32, width: u32, height: u32) -> Self {
        let pixel = extent / height as f32;
        let (right, down) = (right * pixel, up * -pixel);
        let corner = eye - right * (0.5 * width as f32) - down * (0.5 * height as f32);
        let zero = Vec3::ZERO;
        Self { eye: corner, corner: forward, right: zero, down: zero, eye_right: right, eye_down: down }
    }

    /// The ray through a point of the picture, in pixels from its upper left corner; of unit direction.
    #[inline(always)]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let along = |corner: Vec3, right: Vec3, down: Vec3| right.mul_add(x, down.mul_add(y, corner));
        let direction = along(self.corner, self.right, self.down).normalize();
        Ray::new(along(self.eye, self.eye_right, self.eye_down), direction)
    }
}

/// The middle of a pixel.
#[inline(always)]
pub fn pixel_centre(x: u32, y: u32) -> Vec3 {
    vec3(x as f32 + 0.5, y as f32 + 0.5, 0.0)
}
