//! Numbers, colours and the like as a scene file writes them, checked where they are read: the parser then knows the
//! line and the column.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::Deserialize;

use crate::schema::LARGEST;
use crate::srgb::srgb;

macro_rules! numbers {
    ($($(#[$doc:meta])* $name:ident($type:ty), $expected:literal, |$x:ident| $allowed:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name(pub $type);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let allowed: fn(f64) -> bool = |$x| $allowed;
                deserializer.deserialize_f64(Number { allowed, expected: $expected }).map(|number| Self(number as $type))
            }
        }
    )*};
}

numbers! {
    /// Any number that can be computed with.
    Finite(f32), "a number between -1e12 and 1e12", |x| x.abs() <= LARGEST;
    /// A coordinate of a vertex or a place, as it is written.
    Coordinate(f64), "a number between -1e12 and 1e12", |x| x.abs() <= LARGEST;
    /// Zero or more.
    NonNegative(f32), "a number from 0 to 1e12", |x| (0.0..=LARGEST).contains(&x);
    /// More than zero.
    Positive(f32), "a number above 0, at most 1e12", |x| x as f32 > 0.0 && x <= LARGEST;
    /// From 0 to 1.
    Share(f32), "a number from 0 to 1", |x| (0.0..=1.0).contains(&x);
    /// A full angle of view, in degrees. Double precision, so that every angle in radians can be written.
    FieldOfView(f64), "an angle from 0.001 to 179 degrees", |x| (0.001..=179.0).contains(&x);
    /// A half angle of a spot, in degrees.
    SpotAngle(f64), "an angle from 0 to 90 degrees", |x| (0.0..=90.0).contains(&x);
}

struct Number {
    allowed: fn(f64) -> bool,
    expected: &'static str,
}

impl Visitor<'_> for Number {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        // Comparisons with NaN are false.
        if (self.allowed)(value) {
            Ok(value)
        } else {
            Err(E::invalid_value(Unexpected::Float(value), &self))
        }
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        self.visit_f64(value as f64)
    }
}

/// A number within bounds, both included.
pub fn ranged<'de, D: Deserializer<'de>>(deserializer: D, low: f64, high: f64) -> Result<f32, D::Error> {
    deserializer.deserialize_f64(Range { low, high }).map(|number| number as f32)
}

struct Range {
    low: f64,
    high: f64,
}

impl Visitor<'_> for Range {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.high {
            LARGEST => write!(f, "a number from {} to {LARGEST:e}", self.low),
            high => write!(f, "a number from {} to {high}", self.low),
        }
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        // NaN is in no range.
        if (self.low..=self.high).contains(&value) {
            Ok(value)
        } else {
            Err(E::invalid_value(Unexpected::Float(value), &self))
        }
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        self.visit_f64(value as f64)
    }
}

/// A linear colour, each channel zero or more.
#[derive(Clone, Copy, Debug)]
pub struct Color(pub [f32; 3]);

/// A linear colour of shares, each from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub struct Filter(pub [f32; 3]);

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ColorVisitor::<NonNegative>(PhantomData)).map(Self)
    }
}

impl<'de> Deserialize<'de> for Filter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ColorVisitor::<Share>(PhantomData)).map(Self)
    }
}

/// Three channels of which each is a `C`.
struct ColorVisitor<C>(PhantomData<C>);

impl<'de, C: Deserialize<'de> + Into<f32>> Visitor<'de> for ColorVisitor<C> {
    type Value = [f32; 3];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a colour: [r, g, b] or one number, linear, or \"#rrggbb\", sRGB")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<[f32; 3], E> {
        let grey = C::deserialize(serde::de::value::F64Deserializer::<E>::new(value))?;
        Ok([grey.into(); 3])
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<[f32; 3], E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<[f32; 3], E> {
        srgb(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut channels: A) -> Result<[f32; 3], A::Error> {
        let mut color = [0.0; 3];
        for (index, channel) in color.iter_mut().enumerate() {
            let next: C = channels.next_element()?.ok_or_else(|| A::Error::invalid_length(index, &self))?;
            *channel = next.into();
        }
        match channels.next_element::<serde::de::IgnoredAny>()? {
            Some(_) => Err(A::Error::invalid_length(4, &self)),
            None => Ok(color),
        }
    }
}

impl From<NonNegative> for f32 {
    fn from(number: NonNegative) -> f32 {
        number.0
    }
}

impl From<Share> for f32 {
    fn from(number: Share) -> f32 {
        number.0
    }
}

/// One value for every axis, or one for each.
#[derive(Clone, Copy, Debug)]
pub struct PerAxis<const N: usize>(pub [f32; N]);

impl<'de, const N: usize> Deserialize<'de> for PerAxis<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PerAxisVisitor::<N>).map(Self)
    }
}

struct PerAxisVisitor<const N: usize>;

impl<'de, const N: usize> Visitor<'de> for PerAxisVisitor<N> {
    type Value = [f32; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "one number or an array of {N}, none of them 0")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<[f32; N], E> {
        if value.abs() <= LARGEST && value as f32 != 0.0 {
            Ok([value as f32; N])
        } else {
            Err(E::invalid_value(Unexpected::Float(value), &self))
        }
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<[f32; N], E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<[f32; N], A::Error> {
        let mut read = Vec::new();
        while let Some(Finite(value)) = values.next_element()? {
            if value == 0.0 || read.len() == N {
                return Err(A::Error::invalid_value(Unexpected::Seq, &self));
            }
            read.push(value);
        }
        let length = read.len();
        read.try_into().map_err(|_| A::Error::invalid_length(length, &self))
    }
}

/// A text that stands for a table with one key, or the table. `T` is the table.
pub struct TextOrTable<T>(PhantomData<T>, &'static str);

impl<T> TextOrTable<T> {
    /// With what the file should say.
    pub fn new(expected: &'static str) -> Self {
        Self(PhantomData, expected)
    }
}

impl<'de, T: Deserialize<'de> + From<String>> Visitor<'de> for TextOrTable<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.1)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        Ok(T::from(text.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map))
    }
}
