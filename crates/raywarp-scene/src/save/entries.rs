//! What is written, key by key, in the order of the file. `load::toml` reads it.

use serde::Serialize;

use super::changes::Changes;
use super::number::{Color, Number, Vector};
use crate::settings::{AccelKind, Quality, ToneMap};
use crate::{Background, Camera, Light, LightKind, Projection, RenderDefaults, Transform};

#[derive(Serialize)]
pub struct File {
    version: i64,
    base: Base,
    #[serde(skip_serializing_if = "Option::is_none")]
    ambient: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    background: Option<Sky>,
    #[serde(skip_serializing_if = "Render::is_empty")]
    render: Render,
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

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Render {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[u32; 2]>,
    #[serde(rename = "samples", skip_serializing_if = "Option::is_none")]
    pub spp: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_depth: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shadows: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tone_map: Option<ToneMap>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accel: Option<AccelKind>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tree: Option<Quality>,
}

impl Render {
    pub fn new(defaults: &RenderDefaults) -> Self {
        Self {
            size: defaults.size,
            spp: defaults.spp,
            max_depth: defaults.max_depth,
            shadows: defaults.shadows,
            seed: defaults.seed,
            exposure: defaults.exposure.map(Number::new),
            tone_map: defaults.tone_map,
            accel: defaults.accel,
            tree: defaults.tree,
        }
    }

    pub fn is_empty(&self) -> bool {
        *self == Self::default()
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
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    position: Option<Vector>,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<Vector>,
    color: Color,
    #[serde(skip_serializing_if = "Option::is_none")]
    attenuation: Option<Vector>,
    #[serde(skip_serializing_if = "Option::is_none")]
    range: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    outer: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inner: Option<Number>,
}

impl From<&Light> for LightEntry {
    fn from(light: &Light) -> Self {
        let usual = Light::default();
        let attenuation = Number::each(light.attenuation);
        let mut entry = Self {
            name: light.name.clone(),
            kind: "point",
            position: None,
            direction: None,
            color: Color::new(light.color),
            attenuation: (attenuation != Number::each(usual.attenuation)).then_some(attenuation),
            range: Some(Number::new(light.range)).filter(|range| !range.is(usual.range)),
            outer: None,
            inner: None,
        };
        match light.kind {
            LightKind::Point { position } => entry.position = Some(Number::each(position)),
            LightKind::Directional { direction } => {
                entry.kind = "directional";
                entry.direction = Some(Number::each(direction));
                // Light from far away ignores both, and a scene file refuses them.
                (entry.attenuation, entry.range) = (None, None);
            }
            LightKind::Spot { position, direction, inner, outer } => {
                entry.kind = "spot";
                entry.position = Some(Number::each(position));
                entry.direction = Some(Number::each(direction));
                (entry.inner, entry.outer) = (Some(Number::degrees(inner)), Some(Number::degrees(outer)));
            }
        }
        entry
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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diffuse: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specular: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shininess: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflection: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmission: Option<Color>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ior: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fresnel: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opacity: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cutoff: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unlit: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diffuse_map: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specular_map: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission_map: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opacity_map: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_map: Option<bool>,
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
