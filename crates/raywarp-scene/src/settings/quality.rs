//! How much time to spend on a tree.

use std::fmt;
use std::str::FromStr;

/// How good a hierarchy of boxes should be: a better one takes longer to build and less to trace. The structures of the
/// paper have one quality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quality {
    /// Soon there: for scenes that change.
    Fast,
    /// In between.
    #[default]
    Medium,
    /// The best there is: for scenes that stay.
    High,
}

impl Quality {
    /// Every quality, from the fastest to the best.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Medium, Self::High];

    /// Their names, likewise.
    pub const NAMES: [&'static str; 3] = [Self::Fast.name(), Self::Medium.name(), Self::High.name()];

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Medium => "medium",
            Self::High => "high",
        }
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that belongs to no quality.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no quality of a tree; expected fast, medium or high")]
pub struct UnknownQuality(pub String);

impl FromStr for Quality {
    type Err = UnknownQuality;

    fn from_str(name: &str) -> Result<Self, UnknownQuality> {
        Self::ALL.into_iter().find(|quality| quality.name() == name).ok_or_else(|| UnknownQuality(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for quality in Quality::ALL {
            assert_eq!(quality.to_string().parse(), Ok(quality));
        }
        assert_eq!("best".parse::<Quality>(), Err(UnknownQuality("best".into())));
    }
}
