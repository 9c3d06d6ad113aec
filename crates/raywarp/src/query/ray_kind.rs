//! The kinds of rays that ray tracers are measured with, by name.

use std::fmt;
use std::str::FromStr;

/// Where the rays of a workload come from and what is asked of them; see [`RaySource`](super::RaySource).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RayKind {
    /// From the camera through each pixel: closest hit.
    Primary,
    /// From what the camera sees towards a light: any hit.
    Shadow,
    /// Ambient occlusion, short rays from what the camera sees: any hit.
    Ao,
    /// From what the camera sees, as if it were a mirror: closest hit.
    Reflected,
    /// The first diffuse bounce: closest hit.
    Diffuse,
    /// From anywhere to anywhere: closest hit.
    Random,
}

impl RayKind {
    /// Every kind.
    pub const ALL: [Self; 6] = [Self::Primary, Self::Shadow, Self::Ao, Self::Reflected, Self::Diffuse, Self::Random];

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Ao => "ao",
            Self::Reflected => "reflected",
            Self::Diffuse => "diffuse",
            Self::Random => "random",
        }
    }

    /// Whether the question is if anything is hit, and not what comes first.
    pub const fn any_hit(self) -> bool {
        matches!(self, Self::Shadow | Self::Ao)
    }
}

impl fmt::Display for RayKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that belongs to no kind of rays.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no kind of rays; expected primary, shadow, ao, reflected, diffuse or random")]
pub struct UnknownRayKind(pub String);

impl FromStr for RayKind {
    type Err = UnknownRayKind;

    fn from_str(name: &str) -> Result<Self, UnknownRayKind> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| UnknownRayKind(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for kind in RayKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        assert_eq!("tertiary".parse::<RayKind>(), Err(UnknownRayKind("tertiary".into())));
    }
}
