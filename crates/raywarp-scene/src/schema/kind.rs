//! What a value may be.

use std::fmt;

use super::Value;

/// The type of a parameter's values, with their range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Yes or no. The command line has an option for each, whose help these are.
    Flag {
        /// Of `--NAME`.
        on: &'static str,
        /// Of `--no-NAME`.
        off: &'static str,
    },
    /// A whole number.
    Count {
        /// Least.
        low: u32,
        /// Largest.
        high: u32,
    },
    /// Width and height, each from 1.
    Size {
        /// Longest side.
        high: u32,
    },
    /// A number.
    Number {
        /// Least.
        low: f64,
        /// Largest.
        high: f64,
        /// What it counts: "stops". Empty for a mere number.
        unit: &'static str,
    },
    /// A number above 0.
    Positive,
    /// An angle in radians, from 0 to a right one; in degrees for people.
    Angle,
    /// A linear colour, each channel 0 or more.
    Color,
    /// A linear colour, each channel from 0 to 1.
    Share,
    /// Three coordinates.
    Vector,
    /// Three numbers of 0 or more.
    Terms,
    /// One of these words.
    Words(&'static [&'static str]),
}

/// Nothing in a scene is larger: squares and cubes of it would leave the range of an `f32`.
pub const LARGEST: f64 = 1e12;

impl Kind {
    /// A number of 0 or more.
    pub const NON_NEGATIVE: Self = Self::Number { low: 0.0, high: LARGEST, unit: "" };

    /// Yes or no, where the command line does not ask.
    pub const FLAG: Self = Self::Flag { on: "", off: "" };

    /// Whether a value is of this kind and in its range.
    pub fn takes(&self, value: Value) -> bool {
        let within = |x: f32, high: f64| (0.0..=high).contains(&f64::from(x));
        match (*self, value) {
            (Self::Flag { .. }, Value::Flag(_)) => true,
            (Self::Count { low, high }, Value::Count(count)) => (low..=high).contains(&count),
            (Self::Size { high }, Value::Size(sides)) => sides.iter().all(|side| (1..=high).contains(side)),
            (Self::Number { low, high, .. }, Value::Number(x)) => (low..=high).contains(&f64::from(x)),
            (Self::Positive, Value::Number(x)) => x > 0.0 && within(x, LARGEST),
            (Self::Angle, Value::Number(x)) => within(x, std::f64::consts::FRAC_PI_2 + 1e-6),
            (Self::Color | Self::Terms, Value::Triple(channels)) => channels.iter().all(|&x| within(x, LARGEST)),
            (Self::Share, Value::Triple(channels)) => channels.iter().all(|&x| within(x, 1.0)),
            (Self::Vector, Value::Triple(vector)) => vector.iter().all(|&x| f64::from(x).abs() <= LARGEST),
            (Self::Words(words), Value::Word(word)) => words.contains(&word),
            _ => false,
        }
    }
}

/// What a scene file may say, in words: "a whole number from 0 to 16".
impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Flag { .. } => f.write_str("`true` or `false`"),
            Self::Count { low, high } => write!(f, "a whole number from {low} to {high}"),
            Self::Size { high } => write!(f, "`[width, height]`, 1 to {high} each"),
            Self::Number { low, high, .. } if low == 0.0 && high == LARGEST => f.write_str("a number, 0 or more"),
            Self::Number { low, high, .. } => write!(f, "a number from {low} to {high}"),
            Self::Positive => f.write_str("a number above 0"),
            Self::Angle => f.write_str("an angle from 0 to 90 degrees"),
            Self::Color => f.write_str("a colour"),
            Self::Share => f.write_str("a colour, 0 to 1"),
            Self::Vector => f.write_str("a vector"),
            Self::Terms => f.write_str("three numbers, 0 or more"),
            Self::Words(words) => {
                let quoted: Vec<_> = words.iter().map(|word| format!("`\"{word}\"`")).collect();
                f.write_str(&quoted.join(", "))
            }
        }
    }
}
