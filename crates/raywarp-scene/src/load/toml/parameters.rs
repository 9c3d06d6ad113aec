//! Tables of the file whose keys are the schema's parameters, read by their definitions.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::Deserialize;

use super::values::{self, Finite, NonNegative, Positive, SpotAngle};
use crate::radians;
use crate::schema::{Described, Field, Kind, Parameter, Value};

/// What a table says of the parameters of a `T`, in the order of the file.
pub struct Given<T: 'static>(Vec<(&'static Parameter<T>, Value)>);

impl<T> Default for Given<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: Described> Given<T> {
    /// The value of a parameter.
    pub fn get<V: Field>(&self, name: &str) -> Option<V> {
        self.0.iter().find(|(parameter, _)| parameter.name == name).and_then(|(_, value)| V::of(*value))
    }

    /// Gives a `T` what is said, in the order of the schema, and leaves the rest of it alone.
    pub fn apply(&self, to: &mut T) {
        for parameter in T::parameters() {
            if let Some((_, value)) = self.0.iter().find(|(given, _)| *given == parameter) {
                parameter.set(to, *value);
            }
        }
    }
}

/// The keys of a table beside the parameters, or instead of those of the same names.
pub trait Others: Default {
    /// Their names.
    const KEYS: &'static [&'static str];

    /// Reads the value of one of them.
    fn read<'de, A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error>;
}

impl Others for () {
    const KEYS: &'static [&'static str] = &[];

    fn read<'de, A: MapAccess<'de>>(&mut self, _: &str, _: &mut A) -> Result<(), A::Error> {
        Ok(())
    }
}

/// A table.
pub struct Table<T: 'static, O = ()> {
    pub given: Given<T>,
    pub others: O,
}

impl<T, O: Default> Default for Table<T, O> {
    fn default() -> Self {
        Self { given: Given::default(), others: O::default() }
    }
}

impl<'de, T: Described, O: Others> Deserialize<'de> for Table<T, O> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(TableVisitor(PhantomData))
    }
}

struct TableVisitor<T, O>(PhantomData<(T, O)>);

impl<'de, T: Described, O: Others> Visitor<'de> for TableVisitor<T, O> {
    type Value = Table<T, O>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Table<T, O>, A::Error> {
        let mut table = Table::<T, O>::default();
        while let Some(key) = map.next_key_seed(KeySeed::<T, O>(PhantomData))? {
            match key {
                Key::Parameter(parameter) => {
                    if table.given.0.iter().any(|(given, _)| *given == parameter) {
                        return Err(A::Error::custom(format_args!("duplicate field `{}`", parameter.name)));
                    }
                    table.given.0.push((parameter, map.next_value_seed(parameter.kind)?));
                }
                Key::Other(key) => table.others.read(key, &mut map)?,
            }
        }
        Ok(table)
    }
}

enum Key<T: 'static> {
    Parameter(&'static Parameter<T>),
    Other(&'static str),
}

/// Looks a key up: an unknown one is then complained of where it stands.
struct KeySeed<T, O>(PhantomData<(T, O)>);

impl<'de, T: Described, O: Others> DeserializeSeed<'de> for KeySeed<T, O> {
    type Value = Key<T>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Key<T>, D::Error> {
        let key = String::deserialize(deserializer)?;
        let other = O::KEYS.iter().find(|&&other| other == key).map(|other| Key::Other(other));
        other.or_else(|| T::parameter(&key).map(Key::Parameter)).ok_or_else(|| {
            let parameters = T::parameters().map(|parameter| parameter.name);
            let known = O::KEYS.iter().copied().chain(parameters.filter(|name| !O::KEYS.contains(name)));
            let known: Vec<_> = known.map(|key| format!("`{key}`")).collect();
            D::Error::custom(format_args!("unknown field `{key}`, expected one of {}", known.join(", ")))
        })
    }
}

impl<'de> DeserializeSeed<'de> for Kind {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        Ok(match self {
            Self::Flag { .. } => Value::Flag(bool::deserialize(deserializer)?),
            Self::Count { low, high } => Value::Count(deserializer.deserialize_u32(Count { low, high })?),
            Self::Size { high } => Value::Size(deserializer.deserialize_tuple(2, Sides { high })?),
            Self::Number { low, high, .. } => values::ranged(deserializer, low, high).map(Value::Number)?,
            Self::Positive => Value::Number(Positive::deserialize(deserializer)?.0),
            Self::Angle => Value::Number(radians(SpotAngle::deserialize(deserializer)?.0)),
            Self::Color => Value::Triple(values::Color::deserialize(deserializer)?.0),
            Self::Share => Value::Triple(values::Filter::deserialize(deserializer)?.0),
            Self::Vector => Value::Triple(<[Finite; 3]>::deserialize(deserializer)?.map(|number| number.0)),
            Self::Terms => Value::Triple(<[NonNegative; 3]>::deserialize(deserializer)?.map(|number| number.0)),
            Self::Words(words) => Value::Word(deserializer.deserialize_str(Word(words))?),
        })
    }
}

/// A whole number within bounds, both included.
#[derive(Clone, Copy)]
struct Count {
    low: u32,
    high: u32,
}

impl Visitor<'_> for Count {
    type Value = u32;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number from {} to {}", self.low, self.high)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<u32, E> {
        let counted = u32::try_from(number).ok().filter(|count| (self.low..=self.high).contains(count));
        counted.ok_or_else(|| E::invalid_value(Unexpected::Signed(number), &self))
    }
}

impl<'de> DeserializeSeed<'de> for Count {
    type Value = u32;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<u32, D::Error> {
        deserializer.deserialize_u32(self)
    }
}

/// Width and height.
struct Sides {
    high: u32,
}

impl<'de> Visitor<'de> for Sides {
    type Value = [u32; 2];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array of length 2")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sides: A) -> Result<[u32; 2], A::Error> {
        let mut size = [0; 2];
        for (index, side) in size.iter_mut().enumerate() {
            let next = sides.next_element_seed(Count { low: 1, high: self.high })?;
            *side = next.ok_or_else(|| A::Error::invalid_length(index, &self))?;
        }
        match sides.next_element::<serde::de::IgnoredAny>()? {
            Some(_) => Err(A::Error::invalid_length(3, &self)),
            None => Ok(size),
        }
    }
}

/// One of some words.
struct Word(&'static [&'static str]);

impl Visitor<'_> for Word {
    type Value = &'static str;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a string")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<&'static str, E> {
        self.0.iter().copied().find(|word| *word == text).ok_or_else(|| E::unknown_variant(text, self.0))
    }
}
