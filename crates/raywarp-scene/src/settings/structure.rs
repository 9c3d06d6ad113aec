//! The choice of a structure, by name.

use std::fmt;
use std::str::FromStr;

/// Which structure finds the triangles along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AccelKind {
    /// None: every ray tests every triangle. The paper's first version and the oracle of the others.
    Brute,
    /// The paper's k-d tree: median splits, axes in turn.
    Kd,
    /// Binary hierarchy of boxes, 64 bytes a node.
    Bvh2,
    /// The same, and on a grid of 16 bits an axis with 32 bytes a node, each for the rays that it suits.
    #[default]
    Bvh,
    /// Eight boxes a node in full precision, for the vector instructions of a CPU; GPUs have no kernels for it.
    Bvh8f,
}

impl AccelKind {
    /// Every kind.
    pub const ALL: [Self; 5] = [Self::Brute, Self::Kd, Self::Bvh2, Self::Bvh, Self::Bvh8f];

    /// Their names, likewise.
    pub const NAMES: [&'static str; 5] =
        [Self::Brute.name(), Self::Kd.name(), Self::Bvh2.name(), Self::Bvh.name(), Self::Bvh8f.name()];

    /// Whether this is a hierarchy of boxes, in some layout. Those come in several qualities, and are kept on disk.
    pub const fn is_hierarchy(self) -> bool {
        !matches!(self, Self::Brute | Self::Kd)
    }

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Kd => "kd",
            Self::Bvh2 => "bvh2",
            Self::Bvh => "bvh",
            Self::Bvh8f => "bvh8f",
        }
    }
}

impl fmt::Display for AccelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that belongs to no structure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no acceleration structure; expected brute, kd, bvh2, bvh or bvh8f")]
pub struct UnknownKind(pub String);

impl FromStr for AccelKind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| UnknownKind(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for kind in AccelKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        assert_eq!("octree".parse::<AccelKind>(), Err(UnknownKind("octree".into())));
        assert_eq!(AccelKind::default(), AccelKind::Bvh);
    }
}
