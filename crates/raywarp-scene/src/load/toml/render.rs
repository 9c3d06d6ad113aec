//! The `[render]` table: how a scene wants to be rendered.

use std::fmt;

use serde::de::{Deserializer, Error, Unexpected, Visitor};
use serde::Deserialize;

use super::values::Stops;
use crate::settings::{AccelKind, Quality, ToneMap, MAX_DEPTH, MAX_SIDE, MAX_SPP};
use crate::RenderDefaults;

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Render {
    size: Option<[Count<1, MAX_SIDE>; 2]>,
    #[serde(alias = "spp")]
    samples: Option<Count<1, MAX_SPP>>,
    max_depth: Option<Count<0, MAX_DEPTH>>,
    shadows: Option<bool>,
    seed: Option<Count<0, { u32::MAX }>>,
    exposure: Option<Stops>,
    tone_map: Option<ToneMap>,
    accel: Option<AccelKind>,
    tree: Option<Quality>,
}

impl Render {
    /// As plain data.
    pub fn defaults(&self) -> RenderDefaults {
        RenderDefaults {
            size: self.size.map(|sides| sides.map(|side| side.0)),
            spp: self.samples.map(|count| count.0),
            max_depth: self.max_depth.map(|count| count.0),
            shadows: self.shadows,
            seed: self.seed.map(|count| count.0),
            exposure: self.exposure.map(|stops| stops.0),
            tone_map: self.tone_map,
            accel: self.accel,
            tree: self.tree,
        }
    }
}

/// A whole number within bounds, both included.
#[derive(Clone, Copy)]
struct Count<const LOW: u32, const HIGH: u32>(u32);

impl<'de, const LOW: u32, const HIGH: u32> Deserialize<'de> for Count<LOW, HIGH> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_u32(CountVisitor::<LOW, HIGH>).map(Self)
    }
}

struct CountVisitor<const LOW: u32, const HIGH: u32>;

impl<const LOW: u32, const HIGH: u32> Visitor<'_> for CountVisitor<LOW, HIGH> {
    type Value = u32;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number from {LOW} to {HIGH}")
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<u32, E> {
        let counted = u32::try_from(number).ok().filter(|count| (LOW..=HIGH).contains(count));
        counted.ok_or_else(|| E::invalid_value(Unexpected::Signed(number), &self))
    }
}
