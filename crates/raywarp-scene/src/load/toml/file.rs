//! What a scene file can say, key by key. `docs/scene-file.md` describes it for people.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::Deserialize;
use toml::Spanned;

use super::base::Base;
use super::edits::{Move, Which};
use super::parameters::{Others, Table};
use super::place::Rows;
use super::texture::Texture;
use super::values::{Color, Coordinate, FieldOfView, Finite, NonNegative, PerAxis, Positive, SpotAngle};
use crate::RenderDefaults;

/// A name, and where it stands.
pub type Name = Spanned<String>;

/// Three coordinates.
pub type Vector = [Finite; 3];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    pub version: Spanned<i64>,
    pub base: Option<Spanned<Base>>,
    #[serde(default)]
    pub up: Up,
    #[serde(default)]
    pub meshes: Vec<Spanned<Mesh>>,
    #[serde(default)]
    pub instances: Vec<Spanned<Instance>>,
    #[serde(default)]
    pub moves: Vec<Spanned<Move>>,
    #[serde(default)]
    pub materials: Vec<Spanned<Material>>,
    #[serde(default)]
    pub lights: Vec<Spanned<Light>>,
    #[serde(default)]
    pub cameras: Vec<Spanned<Camera>>,
    #[serde(default)]
    pub paths: Vec<Spanned<super::path::Path>>,
    pub background: Option<Background>,
    pub environment: Option<Spanned<Environment>>,
    pub ambient: Option<Color>,
    #[serde(default)]
    pub render: Table<RenderDefaults>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Environment {
    pub file: String,
    /// In degrees.
    pub rotation: Option<Finite>,
    pub strength: Option<NonNegative>,
}

#[derive(Clone, Copy, Default, Deserialize, PartialEq)]
pub enum Up {
    #[default]
    #[serde(rename = "+Y")]
    Y,
    #[serde(rename = "+Z")]
    Z,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    pub name: Option<Name>,
    pub file: Option<Name>,
    pub vertices: Option<Vec<[Coordinate; 3]>>,
    #[serde(default)]
    pub faces: Vec<Spanned<Vec<i64>>>,
    #[serde(default)]
    pub uvs: Vec<[Finite; 2]>,
    pub normals: Option<Normals>,
    pub material: Option<Name>,
    #[serde(default = "yes")]
    pub lights: bool,
    #[serde(default = "yes")]
    pub cameras: bool,
}

fn yes() -> bool {
    true
}

/// Where shading normals come from.
pub enum Normals {
    File,
    Flat,
    Smooth,
    Given(Vec<Vector>),
}

impl<'de> Deserialize<'de> for Normals {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NormalsVisitor)
    }
}

struct NormalsVisitor;

impl<'de> Visitor<'de> for NormalsVisitor {
    type Value = Normals;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"file\", \"flat\", \"smooth\", or an array of one normal a vertex")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Normals, E> {
        match text {
            "file" => Ok(Normals::File),
            "flat" => Ok(Normals::Flat),
            "smooth" => Ok(Normals::Smooth),
            _ => Err(E::unknown_variant(text, &["file", "flat", "smooth"])),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, normals: A) -> Result<Normals, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(normals)).map(Normals::Given)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instance {
    pub mesh: Name,
    pub name: Option<String>,
    pub translate: Option<[Coordinate; 3]>,
    pub rotate: Option<Rotation>,
    pub scale: Option<PerAxis<3>>,
    pub matrix: Option<Rows>,
    pub material: Option<Name>,
}

/// A turn.
pub enum Rotation {
    /// By degrees about x, then y, then z.
    Euler(Vector),
    About(AxisAngle),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisAngle {
    pub axis: Vector,
    pub degrees: Finite,
}

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RotationVisitor)
    }
}

struct RotationVisitor;

impl<'de> Visitor<'de> for RotationVisitor {
    type Value = Rotation;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[x, y, z] in degrees, or { axis = [x, y, z], degrees = angle }")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, angles: A) -> Result<Rotation, A::Error> {
        Deserialize::deserialize(SeqAccessDeserializer::new(angles)).map(Rotation::Euler)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Rotation, A::Error> {
        AxisAngle::deserialize(MapAccessDeserializer::new(map)).map(Rotation::About)
    }
}

/// A material: its parameters and its textures.
pub type Material = Table<crate::Material, MaterialKeys>;

#[derive(Default)]
pub struct MaterialKeys {
    pub name: Option<Name>,
    pub replaces: Option<Spanned<Which>>,
    pub diffuse_map: Option<Spanned<Texture>>,
    pub specular_map: Option<Spanned<Texture>>,
    pub emission_map: Option<Spanned<Texture>>,
    pub opacity_map: Option<Spanned<Texture>>,
    pub normal_map: Option<Spanned<Texture>>,
    pub height_map: Option<Spanned<Texture>>,
    pub metallic_map: Option<Spanned<Texture>>,
    pub roughness_map: Option<Spanned<Texture>>,
    pub transmission_map: Option<Spanned<Texture>>,
}

/// A light: its parameters, and what stands for some of them.
pub type Light = Table<crate::Light, LightKeys>;

#[derive(Default)]
pub struct LightKeys {
    pub name: Option<String>,
    pub target: Option<Vector>,
    pub intensity: Option<NonNegative>,
    pub inner: Option<SpotAngle>,
    pub outer: Option<SpotAngle>,
}

/// Each key is a field of that name.
macro_rules! others {
    ($($type:ident: $($key:ident)*;)*) => {$(
        impl Others for $type {
            const KEYS: &'static [&'static str] = &[$(stringify!($key)),*];

            fn read<'de, A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error> {
                match key {
                    $(stringify!($key) => self.$key = Some(map.next_value()?),)*
                    _ => {}
                }
                Ok(())
            }
        }
    )*};
}

others! {
    MaterialKeys: name replaces diffuse_map specular_map emission_map opacity_map normal_map height_map metallic_map
        roughness_map transmission_map;
    LightKeys: name target intensity inner outer;
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    pub name: Option<String>,
    pub eye: Vector,
    pub target: Vector,
    pub up: Option<Vector>,
    pub fov: Option<FieldOfView>,
    pub height: Option<Positive>,
}

/// One colour all around, or three.
pub enum Background {
    Constant([f32; 3]),
    Sky(Sky),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sky {
    pub zenith: Color,
    pub horizon: Color,
    pub ground: Color,
}

impl<'de> Deserialize<'de> for Background {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(BackgroundVisitor)
    }
}

struct BackgroundVisitor;

impl BackgroundVisitor {
    /// A colour from what it is written as.
    fn constant<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Background, D::Error> {
        Color::deserialize(deserializer).map(|color| Background::Constant(color.0))
    }
}

impl<'de> Visitor<'de> for BackgroundVisitor {
    type Value = Background;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a colour, or a table with zenith, horizon and ground")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Background, E> {
        Self::constant(serde::de::value::F64Deserializer::new(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Background, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Background, E> {
        Self::constant(serde::de::value::StrDeserializer::new(text))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, channels: A) -> Result<Background, A::Error> {
        Self::constant(SeqAccessDeserializer::new(channels))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Background, A::Error> {
        Sky::deserialize(MapAccessDeserializer::new(map)).map(Background::Sky)
    }
}
