//! Viewpoints.

/// A camera, looking from `eye` at `target`.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name in the file, for `--camera`.
    pub name: String,
    /// World position of the pinhole.
    pub eye: [f32; 3],
    /// World point in the middle of the picture.
    pub target: [f32; 3],
    /// Which way is up in the picture; need not be a unit vector nor at right angles to the view.
    pub up: [f32; 3],
    /// How space is projected.
    pub projection: Projection,
}

/// The projection of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pinhole.
    Perspective {
        /// Vertical field of view, in radians, between 0 and pi.
        fov_y: f32,
    },
    /// Parallel rays.
    Orthographic {
        /// Height of the picture, in scene units.
        height: f32,
    },
}

/// Radians of an angle in degrees: one rounding, so each angle in radians is the image of some angle in degrees.
pub fn radians(degrees: f64) -> f32 {
    degrees.to_radians() as f32
}
