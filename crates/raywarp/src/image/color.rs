//! From linear radiance to the bytes of a screen.

use std::fmt;
use std::str::FromStr;

/// How radiance becomes a displayed colour. EXR files hold the radiance itself and ignore this.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// Stops: radiance is multiplied by 2 to this power.
    pub exposure: f32,
    /// What happens to radiance that a screen cannot show.
    pub tone_map: ToneMap,
}

/// The curve from exposed radiance to display-linear light in 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToneMap {
    /// Everything above 1 is 1: what Phong's model expects.
    #[default]
    Clamp,
    /// The ACES curve as fitted by Narkowicz (2015): highlights roll off instead of burning out.
    Filmic,
}

impl ToneMap {
    /// Every curve.
    pub const ALL: [Self; 2] = [Self::Clamp, Self::Filmic];

    fn apply(self, x: f32) -> f32 {
        match self {
            Self::Clamp => x,
            Self::Filmic => (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14),
        }
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Clamp => "clamp",
            Self::Filmic => "filmic",
        })
    }
}

impl FromStr for ToneMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|curve| curve.to_string() == text);
        found.ok_or_else(|| "the curves are clamp and filmic".to_owned())
    }
}

/// Shown for radiance that is no number: seen at once.
const NOT_A_NUMBER: [u8; 3] = [255, 0, 255];

impl Development {
    /// The displayed colour of a radiance. Infinite radiance is white, NaN magenta.
    pub(super) fn develop(&self, radiance: [f32; 3]) -> [u8; 3] {
        if radiance.iter().any(|channel| channel.is_nan()) {
            return NOT_A_NUMBER;
        }
        let gain = self.exposure.exp2();
        // Beyond this every curve is flat, and infinities would make NaN of the filmic one.
        radiance.map(|channel| srgb_byte(self.tone_map.apply((channel * gain).clamp(0.0, 1e6))))
    }
}

/// The byte of a display-linear value, rounded.
pub(super) fn srgb_byte(linear: f32) -> u8 {
    byte(linear_to_srgb(linear.clamp(0.0, 1.0)))
}

/// A share from 0 to 1 as a byte, rounded.
pub(super) fn byte(share: f32) -> u8 {
    (255.0 * share.clamp(0.0, 1.0)).round() as u8
}

/// IEC 61966-2-1, for values from 0 to 1.
fn linear_to_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Linear value of an sRGB one, both from 0 to 1 (IEC 61966-2-1).
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// [`srgb_to_linear`] in double precision, for tables and for values of more than 8 bits.
pub(crate) fn srgb_to_linear_precise(encoded: f64) -> f64 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_way_to_linear_and_back() {
        for byte in 0..=255u8 {
            assert_eq!(srgb_byte(srgb_to_linear(f32::from(byte) / 255.0)), byte);
        }
    }

    #[test]
    fn one_stop_doubles() {
        let stop = Development { exposure: 1.0, ..Development::default() };
        let plain = Development::default();
        assert_eq!(stop.develop([0.1, 0.2, 0.3]), plain.develop([0.2, 0.4, 0.6]));
    }

    #[test]
    fn strange_radiance_has_a_colour() {
        for tone_map in ToneMap::ALL {
            let development = Development { exposure: 0.0, tone_map };
            assert_eq!(development.develop([f32::INFINITY; 3]), [255; 3]);
            assert_eq!(development.develop([f32::NEG_INFINITY; 3]), [0; 3]);
            assert_eq!(development.develop([0.0, f32::NAN, 0.0]), NOT_A_NUMBER);
        }
    }
}
