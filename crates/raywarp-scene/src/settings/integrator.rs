//! How light is followed through a scene.

use std::fmt;
use std::str::FromStr;

/// How radiance is found along a camera ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Integrator {
    /// The paper's: Phong's illumination with shadows, mirrors and glass.
    #[default]
    Whitted,
    /// Path tracing of metallic-roughness materials: light from all sources, by all ways.
    Path,
}

impl Integrator {
    /// Every one.
    pub const ALL: [Self; 2] = [Self::Whitted, Self::Path];

    /// Their names, likewise.
    pub const NAMES: [&'static str; 2] = [Self::Whitted.name(), Self::Path.name()];

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Whitted => "whitted",
            Self::Path => "path",
        }
    }
}

impl fmt::Display for Integrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Integrator {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|integrator| integrator.name() == text);
        found.ok_or_else(|| "the integrators are whitted and path".to_owned())
    }
}
