//! Numbers that come back from a scene file with the same bits.

use serde::{Serialize, Serializer};

/// A number as it stands in the file. Two are equal if they would be the same bits in a scene.
#[derive(Clone, Copy, Debug)]
pub struct Number(f64);

/// Three coordinates.
pub type Vector = [Number; 3];

impl Number {
    /// The shortest decimal that is read as this.
    pub fn new(value: f32) -> Self {
        let short = value.to_string().parse::<f64>().unwrap_or(f64::NAN);
        // Reading rounds twice, to double and to single precision, so the shortest decimal might miss.
        let exact = (short as f32).to_bits() == value.to_bits();
        Self(if exact { short } else { f64::from(value) })
    }

    /// Three at once.
    pub fn each<const N: usize>(values: [f32; N]) -> [Self; N] {
        values.map(Self::new)
    }

    /// The shortest angle in degrees that is read as this one in radians.
    pub fn degrees(angle: f32) -> Self {
        Self(crate::degrees(angle))
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_bits() == other.0.to_bits()
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // `2` for `2.0`, as people write it; a minus zero has to keep its sign.
        let whole = self.0.fract() == 0.0 && self.0.abs() < 1e9 && !(self.0 == 0.0 && self.0.is_sign_negative());
        if whole {
            serializer.serialize_i64(self.0 as i64)
        } else {
            serializer.serialize_f64(self.0)
        }
    }
}

/// A colour: one number where it is grey.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color(Vector);

impl Color {
    /// Of three channels.
    pub fn new(channels: [f32; 3]) -> Self {
        Self(Number::each(channels))
    }
}

impl Serialize for Color {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            [r, g, b] if r == g && g == b => r.serialize(serializer),
            channels => channels.serialize(serializer),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::radians;

    #[derive(Serialize)]
    struct Line {
        x: Number,
    }

    fn text(x: Number) -> String {
        toml::to_string(&Line { x }).unwrap().trim_start_matches("x = ").trim_end().to_owned()
    }

    proptest! {
        #[test]
        fn every_number_comes_back_with_its_bits(bits: u32) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            let read: f64 = text(Number::new(value)).parse().unwrap();
            prop_assert_eq!((read as f32).to_bits(), bits);
        }

        #[test]
        fn every_angle_comes_back_with_its_bits(angle in 1e-6f32..3.13) {
            let read: f64 = text(Number::degrees(angle)).parse().unwrap();
            prop_assert_eq!(radians(read).to_bits(), angle.to_bits());
        }
    }

    #[test]
    fn numbers_are_written_as_people_write_them() {
        assert_eq!(text(Number::new(2.0)), "2");
        assert_eq!(text(Number::new(0.1)), "0.1");
        assert_eq!(text(Number::new(-0.0)), "-0.0");
        for degrees in [45.0, 35.5, 0.1, 90.0, 178.9] {
            assert_eq!(text(Number::degrees(radians(degrees))), degrees.to_string());
        }
        assert_eq!(text(Number::degrees(std::f32::consts::FRAC_PI_2)), "90");
    }
}
