//! Light from all around.

use std::sync::Arc;

/// What lies beyond the scene as a picture all around, in longitude and latitude. Its middle is seen towards +x, its right edge
/// towards -x past +z, its upper edge upwards; with another direction upwards it is turned along, so that +x stays.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The picture.
    pub picture: Arc<Radiance>,
    /// Turns it about the direction upwards, in radians, counter-clockwise as seen from above.
    pub rotation: f32,
    /// Multiplies its radiance, 0 or more.
    pub strength: f32,
}

/// A picture of radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Radiance {
    /// Where it comes from, for messages.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Linear red, green and blue, row by row from the upper left one; finite and not negative.
    pub texels: Vec<[f32; 3]>,
}
