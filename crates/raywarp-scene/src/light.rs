//! Light sources.

/// A light of the paper's tracer: infinitely small or infinitely far.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name in the file.
    pub name: String,
    /// Where it is and where it shines.
    pub kind: LightKind,
    /// Colour times intensity, linear. A surface that faces the light at attenuation 1 sends back `diffuse * color`.
    pub color: [f32; 3],
    /// Constant, linear and quadratic terms: the light is divided by `a0 + a1 d + a2 d^2` at distance `d`.
    /// Directional lights ignore it. `[1, 0, 0]` does not fall off, `[0, 0, 1]` is the inverse square.
    pub attenuation: [f32; 3],
    /// Beyond this distance the light is dark (KHR_lights_punctual's window); infinite for none.
    pub range: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: LightKind::Directional { direction: [0.0, -1.0, 0.0] },
            color: [1.0; 3],
            attenuation: [1.0, 0.0, 0.0],
            range: f32::INFINITY,
        }
    }
}

/// Geometry of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Shines everywhere from a point.
    Point {
        /// World position.
        position: [f32; 3],
    },
    /// Parallel rays.
    Directional {
        /// The way that the light travels; need not be a unit vector.
        direction: [f32; 3],
    },
    /// A cone.
    Spot {
        /// World position.
        position: [f32; 3],
        /// The cone's axis, away from the light; need not be a unit vector.
        direction: [f32; 3],
        /// Half angle, in radians, up to which the light is full.
        inner: f32,
        /// Half angle, in radians, from which the light is dark; larger than `inner`, at most pi/2.
        outer: f32,
    },
}
