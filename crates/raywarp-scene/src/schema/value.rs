//! A value of any parameter, and the types that values have.

use std::fmt;

use crate::settings::{AccelKind, Integrator, Quality, ToneMap};

/// What a parameter is set to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Yes or no.
    Flag(bool),
    /// A whole number.
    Count(u32),
    /// Width and height.
    Size([u32; 2]),
    /// A number; an angle in radians.
    Number(f32),
    /// A colour or a vector.
    Triple([f32; 3]),
    /// One of several words.
    Word(&'static str),
}

impl Value {
    /// Whether it is the other one to the bit: zeros differ by their sign.
    pub fn is(self, other: Self) -> bool {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a.to_bits() == b.to_bits(),
            (Self::Triple(a), Self::Triple(b)) => a.map(f32::to_bits) == b.map(f32::to_bits),
            _ => self == other,
        }
    }
}

/// As people write it: "1920x1080", "on", "filmic".
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(on) => f.write_str(if *on { "on" } else { "off" }),
            Self::Count(count) => count.fmt(f),
            Self::Size([width, height]) => write!(f, "{width}x{height}"),
            Self::Number(number) => number.fmt(f),
            Self::Triple([x, y, z]) => write!(f, "{x},{y},{z}"),
            Self::Word(word) => f.write_str(word),
        }
    }
}

/// A type that a [`Value`] can be of.
pub trait Field: Sized {
    /// As a value.
    fn value(self) -> Value;

    /// Of a value; nothing where that is of another type.
    fn of(value: Value) -> Option<Self>;
}

macro_rules! fields {
    ($($type:ty, $variant:ident;)*) => {$(
        impl Field for $type {
            fn value(self) -> Value {
                Value::$variant(self)
            }

            fn of(value: Value) -> Option<Self> {
                match value {
                    Value::$variant(value) => Some(value),
                    _ => None,
                }
            }
        }
    )*};
}

fields! {
    bool, Flag;
    u32, Count;
    [u32; 2], Size;
    f32, Number;
    [f32; 3], Triple;
    &'static str, Word;
}

macro_rules! words {
    ($($type:ty),*) => {$(
        impl Field for $type {
            fn value(self) -> Value {
                Value::Word(self.name())
            }

            fn of(value: Value) -> Option<Self> {
                <&str>::of(value)?.parse().ok()
            }
        }
    )*};
}

words!(Integrator, ToneMap, AccelKind, Quality);
