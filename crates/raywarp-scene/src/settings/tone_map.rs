//! The curve from radiance to display light.

use std::fmt;
use std::str::FromStr;

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

    /// Their names, likewise.
    pub const NAMES: [&'static str; 2] = [Self::Clamp.name(), Self::Filmic.name()];

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clamp => "clamp",
            Self::Filmic => "filmic",
        }
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ToneMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|curve| curve.name() == text);
        found.ok_or_else(|| "the curves are clamp and filmic".to_owned())
    }
}
