//! Textures as a scene file writes them.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::Deserialize;

use super::values::{Finite, PerAxis};

/// A texture: a file name, or a table; or `false` for none.
pub enum Texture {
    None,
    Given(TextureTable),
}

impl Texture {
    /// What is said of it, if there is one.
    pub fn table(&self) -> Option<&TextureTable> {
        match self {
            Self::None => None,
            Self::Given(table) => Some(table),
        }
    }
}

impl<'de> Deserialize<'de> for Texture {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TextureVisitor)
    }
}

struct TextureVisitor;

impl<'de> Visitor<'de> for TextureVisitor {
    type Value = Texture;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an image file's name, a table such as { file = \"wood.png\", wrap = \"clamp\" }, or false")
    }

    fn visit_bool<E: Error>(self, given: bool) -> Result<Texture, E> {
        match given {
            false => Ok(Texture::None),
            true => Err(E::invalid_value(Unexpected::Bool(true), &self)),
        }
    }

    fn visit_str<E: Error>(self, file: &str) -> Result<Texture, E> {
        Ok(Texture::Given(TextureTable::from(file.to_owned())))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Texture, A::Error> {
        TextureTable::deserialize(MapAccessDeserializer::new(map)).map(Texture::Given)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextureTable {
    pub file: String,
    pub srgb: Option<bool>,
    pub wrap: Option<Wraps>,
    pub filter: Option<Filtering>,
    pub channel: Option<Channel>,
    pub scale: Option<PerAxis<2>>,
    pub offset: Option<[Finite; 2]>,
    pub base: Option<Finite>,
    pub gain: Option<Finite>,
    pub strength: Option<Finite>,
}

impl From<String> for TextureTable {
    fn from(file: String) -> Self {
        Self {
            file,
            srgb: None,
            wrap: None,
            filter: None,
            channel: None,
            scale: None,
            offset: None,
            base: None,
            gain: None,
            strength: None,
        }
    }
}

/// One way for both directions, or one for each.
pub struct Wraps(pub [Wrap; 2]);

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    Repeat,
    Clamp,
    Mirror,
}

impl<'de> Deserialize<'de> for Wraps {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WrapsVisitor)
    }
}

struct WrapsVisitor;

impl<'de> Visitor<'de> for WrapsVisitor {
    type Value = Wraps;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"repeat\", \"clamp\" or \"mirror\", or an array of two of them")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Wraps, E> {
        let wrap = Wrap::deserialize(serde::de::value::StrDeserializer::new(text))?;
        Ok(Wraps([wrap; 2]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, wraps: A) -> Result<Wraps, A::Error> {
        Deserialize::deserialize(SeqAccessDeserializer::new(wraps)).map(Wraps)
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Filtering {
    Nearest,
    Bilinear,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    Rgb,
    Red,
    Green,
    Blue,
    Alpha,
    Luminance,
}
