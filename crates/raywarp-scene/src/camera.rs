//! Viewpoints.

/// A camera, looking from `eye` at `target`.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name in the file, by which it is chosen.
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

/// The name of a direction that is an axis, such as "+Z".
pub fn axis_name(direction: [f32; 3]) -> Option<&'static str> {
    let axes = [
        ("+X", [1.0, 0.0, 0.0]),
        ("-X", [-1.0, 0.0, 0.0]),
        ("+Y", [0.0, 1.0, 0.0]),
        ("-Y", [0.0, -1.0, 0.0]),
        ("+Z", [0.0, 0.0, 1.0]),
        ("-Z", [0.0, 0.0, -1.0]),
    ];
    axes.into_iter().find(|(_, axis)| *axis == direction).map(|(name, _)| name)
}

/// Radians of an angle in degrees: one rounding, so each angle in radians is the image of some angle in degrees.
pub fn radians(degrees: f64) -> f32 {
    degrees.to_radians() as f32
}

/// An angle in degrees, as short a number as [`radians`] turns into exactly these radians.
pub fn degrees(radians: f32) -> f64 {
    let exact = f64::from(radians).to_degrees();
    let rounded = |digits: usize| format!("{exact:.digits$e}").parse().unwrap_or(exact);
    (0..17).map(rounded).find(|&degrees: &f64| self::radians(degrees) == radians).unwrap_or(exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_short_and_lead_back_to_the_same_bits() {
        assert_eq!(degrees(radians(35.0)), 35.0);
        assert_eq!(degrees(0.7), 40.107045);
        let mut bits = 1e-5f32.to_bits();
        while f32::from_bits(bits) < 3.1 {
            let angle = f32::from_bits(bits);
            let text = degrees(angle).to_string();
            assert_eq!(radians(text.parse().unwrap()), angle, "{text}");
            bits += 10_007;
        }
    }
}
