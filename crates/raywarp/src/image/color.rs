//! From linear radiance to the bytes of a screen.

use std::fmt;
use std::str::FromStr;

use raywarp_kernels::display::{curve, Tone};

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

impl Development {
    /// As the kernels take it.
    pub(crate) fn tone(&self) -> Tone {
        let curve = match self.tone_map {
            ToneMap::Clamp => curve::CLAMP,
            ToneMap::Filmic => curve::FILMIC,
        };
        Tone { gain: self.exposure.exp2(), curve }
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
    use raywarp_kernels::display::srgb_byte;

    use super::*;

    fn color(development: &Development, radiance: [f32; 3]) -> [u8; 3] {
        development.tone().color(radiance.into())
    }

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
        assert_eq!(color(&stop, [0.1, 0.2, 0.3]), color(&plain, [0.2, 0.4, 0.6]));
    }

    #[test]
    fn strange_radiance_has_a_colour() {
        for tone_map in ToneMap::ALL {
            let development = Development { exposure: 0.0, tone_map };
            assert_eq!(color(&development, [f32::INFINITY; 3]), [255; 3]);
            assert_eq!(color(&development, [f32::NEG_INFINITY; 3]), [0; 3]);
            assert_eq!(color(&development, [0.0, f32::NAN, 0.0]), [255, 0, 255]);
        }
    }
}
