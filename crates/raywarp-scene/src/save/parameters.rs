//! The schema's parameters as a scene file writes them.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::number::{Color, Number};
use crate::schema::{Described, Kind, Value};

/// Keys and their values, in the order of the schema.
#[derive(Clone, Debug, Default)]
pub struct Keys(Vec<Key>);

#[derive(Clone, Copy, Debug)]
struct Key {
    name: &'static str,
    kind: Kind,
    value: Value,
}

impl Keys {
    /// All that a `T` says.
    pub fn all<T: Described>(of: &T) -> Self {
        Self::wanted(of, |_, _| true)
    }

    /// All that a `T` says and that is not so anyway.
    pub fn unusual<T: Described>(of: &T) -> Self {
        Self::wanted(of, |usual, value| !usual.is_some_and(|usual| usual.is(value)))
    }

    /// What it says `now` and did not say `before`.
    pub fn changed<T: Described>(before: &T, now: &T) -> Self {
        let mut keys = Self::all(now);
        keys.0.retain(|key| {
            let before = T::parameter(key.name).and_then(|parameter| parameter.get(before));
            !before.is_some_and(|before| before.is(key.value))
        });
        keys
    }

    fn wanted<T: Described>(of: &T, is_wanted: fn(Option<Value>, Value) -> bool) -> Self {
        let said = T::parameters().filter_map(|parameter| Some((parameter, parameter.get(of)?)));
        let wanted = said.filter(|(parameter, value)| is_wanted(parameter.default(), *value));
        Self(wanted.map(|(parameter, value)| Key { name: parameter.name, kind: parameter.kind, value }).collect())
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether each key of the other ones is here too, with some value.
    pub fn have_all_of(&self, other: &Self) -> bool {
        other.0.iter().all(|key| self.0.iter().any(|own| own.name == key.name))
    }
}

impl PartialEq for Keys {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&Key, &Key)| a.name == b.name && a.value.is(b.value);
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(same)
    }
}

impl Serialize for Keys {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for key in &self.0 {
            map.serialize_entry(key.name, key)?;
        }
        map.end()
    }
}

/// The value alone.
impl Serialize for Key {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match (self.value, self.kind) {
            (Value::Flag(on), _) => on.serialize(serializer),
            (Value::Count(count), _) => count.serialize(serializer),
            (Value::Size(sides), _) => sides.serialize(serializer),
            (Value::Number(angle), Kind::Angle) => Number::degrees(angle).serialize(serializer),
            (Value::Number(number), _) => Number::new(number).serialize(serializer),
            (Value::Triple(channels), Kind::Color | Kind::Share) => Color::new(channels).serialize(serializer),
            (Value::Triple(vector), _) => Number::each(vector).serialize(serializer),
            (Value::Word(word), _) => word.serialize(serializer),
        }
    }
}
