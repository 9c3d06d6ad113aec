//! Light sources.

use crate::schema::{Described, Kind, PanelRow, Parameter, Usual, Value};

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

impl Described for Light {
    fn parameters() -> impl Iterator<Item = &'static Parameter<Self>> {
        LIGHT.iter()
    }
}

/// In the order of a saved file and of the panel: the kind comes first, as the others depend on it.
const LIGHT: &[Parameter<Light>] = &[
    Parameter {
        name: "kind",
        alias: None,
        kind: Kind::Words(&["point", "directional", "spot"]),
        meaning: "What it is",
        default: Usual::Words("required"),
        panel: None,
        read: |light| {
            Some(Value::Word(match light.kind {
                LightKind::Point { .. } => "point",
                LightKind::Directional { .. } => "directional",
                LightKind::Spot { .. } => "spot",
            }))
        },
        write: |light, value| {
            let (position, direction) = ([0.0; 3], [0.0, -1.0, 0.0]);
            light.kind = match value {
                Value::Word("point") => LightKind::Point { position },
                Value::Word("directional") => LightKind::Directional { direction },
                Value::Word("spot") => {
                    let outer = std::f32::consts::FRAC_PI_4;
                    LightKind::Spot { position, direction, inner: 0.8 * outer, outer }
                }
                _ => light.kind,
            };
        },
    },
    Parameter {
        name: "color",
        alias: None,
        kind: Kind::Color,
        meaning: "Colour",
        default: Usual::Value(|| Value::Triple([1.0; 3])),
        panel: Some(PanelRow::ranged("Colour", [0.0, 1.0], 0.0)),
        read: |light| Some(Value::Triple(light.color)),
        write: |light, value| {
            if let Value::Triple(color) = value {
                light.color = color;
            }
        },
    },
    Parameter {
        name: "position",
        alias: None,
        kind: Kind::Vector,
        meaning: "Place of a point or a spot",
        default: Usual::Words("required there"),
        panel: Some(PanelRow::new("Position")),
        read: |light| match light.kind {
            LightKind::Point { position } | LightKind::Spot { position, .. } => Some(Value::Triple(position)),
            LightKind::Directional { .. } => None,
        },
        write: |light, value| {
            use LightKind::{Point, Spot};
            if let (Point { position } | Spot { position, .. }, Value::Triple(to)) = (&mut light.kind, value) {
                *position = to;
            }
        },
    },
    Parameter {
        name: "direction",
        alias: None,
        kind: Kind::Vector,
        meaning: "The way the light travels, of a directional light or a spot",
        default: Usual::Words("required there, but for a spot with a `target`"),
        panel: Some(PanelRow::ranged("Direction", [0.0, 1.0], 0.05)),
        read: |light| match light.kind {
            LightKind::Directional { direction } | LightKind::Spot { direction, .. } => Some(Value::Triple(direction)),
            LightKind::Point { .. } => None,
        },
        write: |light, value| {
            use LightKind::{Directional, Spot};
            if let (Directional { direction } | Spot { direction, .. }, Value::Triple(to)) = (&mut light.kind, value) {
                *direction = to;
            }
        },
    },
    Parameter {
        name: "attenuation",
        alias: None,
        kind: Kind::Terms,
        meaning: "`[a0, a1, a2]`: at distance d the light is divided by `a0 + a1 d + a2 d²`; not all 0, and not for a \
                  directional light",
        default: Usual::Value(|| Value::Triple([1.0, 0.0, 0.0])),
        panel: None,
        read: |light| has_place(light).then_some(Value::Triple(light.attenuation)),
        write: |light, value| {
            if let (true, Value::Triple(terms)) = (has_place(light), value) {
                light.attenuation = terms;
            }
        },
    },
    Parameter {
        name: "range",
        alias: None,
        kind: Kind::Positive,
        meaning: "Beyond this distance the light is dark; not for a directional light",
        default: Usual::Words("none"),
        panel: None,
        read: |light| (has_place(light) && light.range.is_finite()).then_some(Value::Number(light.range)),
        write: |light, value| {
            if let (true, Value::Number(range)) = (has_place(light), value) {
                light.range = range;
            }
        },
    },
    Parameter {
        name: "outer",
        alias: None,
        kind: Kind::Angle,
        meaning: "Half angle of a spot from which it is dark",
        default: Usual::Words("45"),
        panel: None,
        read: |light| match light.kind {
            LightKind::Spot { outer, .. } => Some(Value::Number(outer)),
            _ => None,
        },
        write: |light, value| {
            if let (LightKind::Spot { outer, .. }, Value::Number(angle)) = (&mut light.kind, value) {
                *outer = angle;
            }
        },
    },
    Parameter {
        name: "inner",
        alias: None,
        kind: Kind::Angle,
        meaning: "Half angle of a spot up to which it is full, less than `outer`",
        default: Usual::Words("0.8 × `outer`"),
        panel: None,
        read: |light| match light.kind {
            LightKind::Spot { inner, .. } => Some(Value::Number(inner)),
            _ => None,
        },
        write: |light, value| {
            if let (LightKind::Spot { inner, .. }, Value::Number(angle)) = (&mut light.kind, value) {
                *inner = angle;
            }
        },
    },
];

/// Light from far away neither falls off nor ends.
fn has_place(light: &Light) -> bool {
    !matches!(light.kind, LightKind::Directional { .. })
}
