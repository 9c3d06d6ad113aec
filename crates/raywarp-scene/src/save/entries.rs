//! What is written, key by key, in the order of the file. `load::toml` reads it.

use std::collections::BTreeMap;

use serde::Serialize;

use super::changes::Changes;
use super::number::{Color, Number, Vector};
use super::parameters::Keys;
use crate::{Background, Camera, Light, Projection, Transform};

#[derive(Serialize)]
pub struct File {
    version: i64,
    base: Base,
    #[serde(skip_serializing_if = "Option::is_none")]
    ambient: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    background: Option<Sky>,
    #[serde(skip_serializing_if = "Keys::is_empty")]
    render: Keys,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cameras: Vec<CameraEntry>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    lights: Vec<LightEntry>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    materials: Vec<MaterialEntry>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    moves: Vec<Move>,
}

impl File {
    pub fn new(base: Base, changes: Changes) -> Self {
        Self {
            version: 1,
            base,
            ambient: changes.ambient.added,
            background: changes.background.added,
            render: changes.render.added.unwrap_or_default(),
            cameras: changes.cameras.added.unwrap_or_default(),
            lights: changes.lights.added.unwrap_or_default(),
            materials: changes.materials,
            moves: changes.moves,
        }
    }
}

/// The original: its name alone where all of it comes along.
#[derive(Serialize)]
#[serde(untagged)]
pub enum Base {
    Whole(String),
    Part(BaseTable),
}

#[derive(Serialize)]
pub struct BaseTable {
    file: String,
    #[serde(skip_serializing_if = "is_true")]
    lights: bool,
    #[serde(skip_serializing_if = "is_true")]
    cameras: bool,
    #[serde(skip_serializing_if = "is_true")]
    background: bool,
    #[serde(skip_serializing_if = "is_true")]
    ambient: bool,
    #[serde(skip_serializing_if = "is_true")]
    render: bool,
}

fn is_true(value: &bool) -> bool {
    *value
}

impl Base {
    pub fn new(file: String, changes: &Changes) -> Self {
        let (lights, cameras) = (!changes.lights.dropped, !changes.cameras.dropped);
        let (background, ambient) = (!changes.background.dropped, !changes.ambient.dropped);
        let render = !changes.render.dropped;
        match lights && cameras && background && ambient && render {
            true => Self::Whole(file),
            false => Self::Part(BaseTable { file, lights, cameras, background, ambient, render }),
        }
    }
}

/// A sky: one colour where it is the same all around.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Sky {
    Constant(Color),
    Graded { zenith: Color, horizon: Color, ground: Color },
}

impl Sky {
    pub fn new(sky: &Background) -> Self {
        let [zenith, horizon, ground] = [sky.zenith, sky.horizon, sky.ground].map(Color::new);
        match zenith == horizon && horizon == ground {
            true => Self::Constant(zenith),
            false => Self::Graded { zenith, horizon, ground },
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraEntry {
    #[serde(skip_serializing_if = "String::is_empty")]
    name: String,
    eye: Vector,
    target: Vector,
    #[serde(skip_serializing_if = "is_usual_up")]
    up: Vector,
    #[serde(skip_serializing_if = "Option::is_none")]
    fov: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<Number>,
}

fn is_usual_up(up: &Vector) -> bool {
    *up == Number::each([0.0, 1.0, 0.0])
}

impl From<&Camera> for CameraEntry {
    fn from(camera: &Camera) -> Self {
        let (fov, height) = match camera.projection {
            Projection::Perspective { fov_y } => (Some(Number::degrees(fov_y)), None),
            Projection::Orthographic { height } => (None, Some(Number::new(height))),
        };
        let [eye, target, up] = [camera.eye, camera.target, camera.up].map(Number::each);
        Self { name: camera.name.clone(), eye, target, up, fov, height }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightEntry {
    #[serde(skip_serializing_if = "String::is_empty")]
    name: String,
    #[serde(flatten)]
    keys: Keys,
}

impl From<&Light> for LightEntry {
    fn from(light: &Light) -> Self {
        Self { name: light.name.clone(), keys: Keys::unusual(light) }
    }
}

/// One of a list: by its name where that is its own, else by its number.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Which {
    Named(String),
    Numbered(usize),
}

#[derive(Clone, Debug, Serialize)]
pub struct MaterialEntry {
    pub replaces: Which,
    #[serde(flatten)]
    pub keys: MaterialKeys,
}

/// What is different about a material.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MaterialKeys {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    #[serde(flatten)]
    pub parameters: Keys,
    /// Textures that are taken away.
    #[serde(flatten)]
    pub maps: BTreeMap<&'static str, bool>,
}

#[derive(Clone, Debug, Serialize)]
pub struct Move {
    instance: Which,
    #[serde(skip_serializing_if = "Option::is_none")]
    translate: Option<Vector>,
    #[serde(skip_serializing_if = "Option::is_none")]
    matrix: Option<[[Number; 4]; 3]>,
}

impl Move {
    /// To where a transform puts it.
    pub fn new(instance: Which, transform: &Transform) -> Self {
        let translation = Number::each(transform.translation);
        if transform.columns.map(Number::each) == Transform::IDENTITY.columns.map(Number::each) {
            return Self { instance, translate: Some(translation), matrix: None };
        }
        let row = |axis: usize| {
            let [x, y, z] = transform.columns.map(|column| Number::new(column[axis]));
            [x, y, z, translation[axis]]
        };
        Self { instance, translate: None, matrix: Some([row(0), row(1), row(2)]) }
    }
}
