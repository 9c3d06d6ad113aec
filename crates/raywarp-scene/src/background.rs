//! What lies beyond the scene.

/// A sky: linear from the horizon to the zenith and to the ground, by the sine of the elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Background {
    /// Radiance straight up.
    pub zenith: [f32; 3],
    /// Radiance at the horizon.
    pub horizon: [f32; 3],
    /// Radiance straight down.
    pub ground: [f32; 3],
}

impl Background {
    /// The same radiance everywhere.
    pub fn constant(radiance: [f32; 3]) -> Self {
        Self { zenith: radiance, horizon: radiance, ground: radiance }
    }
}
