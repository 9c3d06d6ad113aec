//! The choice of a structure, by name.

use std::fmt;
use std::str::FromStr;

use raywarp::accel::{AccelKind, Quality};

/// What to build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Build {
    /// The structure.
    pub kind: StructureKind,
    /// How good it should be.
    pub quality: Quality,
}

impl From<StructureKind> for Build {
    fn from(kind: StructureKind) -> Self {
        Self { kind, quality: Quality::default() }
    }
}

impl From<AccelKind> for Build {
    fn from(kind: AccelKind) -> Self {
        StructureKind::Product(kind).into()
    }
}

/// Which structure finds the triangles along a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StructureKind {
    /// One that raywarp renders with.
    Product(AccelKind),
    /// Every triangle, staged through memory that threads share.
    Staged,
    /// The k-d tree of the surface area heuristic, traversed by a stack.
    KdSah,
    /// The same, traversed by restarts and a trail, with a stack of four cells.
    KdTrail,
    /// Two boxes a node on a grid of 16 bits an axis: 32 bytes, the small nodes of [`AccelKind::Bvh`] alone.
    Bvh2c,
    /// Four boxes a node, quantised to eight bits: 64 bytes.
    Bvh4,
    /// Eight boxes a node, compressed to 80 bytes.
    Bvh8,
    /// Eight boxes a node, quantised to eight bits, with a link each: 128 bytes.
    Bvh8w,
}

impl StructureKind {
    /// See [`AccelKind::Brute`].
    pub const BRUTE: Self = Self::Product(AccelKind::Brute);
    /// See [`AccelKind::Kd`].
    pub const KD: Self = Self::Product(AccelKind::Kd);
    /// See [`AccelKind::Bvh2`].
    pub const BVH2: Self = Self::Product(AccelKind::Bvh2);
    /// See [`AccelKind::Bvh`].
    pub const BVH: Self = Self::Product(AccelKind::Bvh);
    /// See [`AccelKind::Bvh8f`].
    pub const BVH8F: Self = Self::Product(AccelKind::Bvh8f);

    /// Every kind.
    pub const ALL: [Self; 12] = [
        Self::BRUTE,
        Self::Staged,
        Self::KD,
        Self::KdSah,
        Self::KdTrail,
        Self::BVH2,
        Self::Bvh2c,
        Self::BVH,
        Self::Bvh4,
        Self::Bvh8,
        Self::Bvh8w,
        Self::BVH8F,
    ];

    /// Whether this is a hierarchy of boxes, in some layout. Those come in several qualities.
    pub const fn is_hierarchy(self) -> bool {
        match self {
            Self::Product(kind) => kind.is_hierarchy(),
            Self::Staged | Self::KdSah | Self::KdTrail => false,
            Self::Bvh2c | Self::Bvh4 | Self::Bvh8 | Self::Bvh8w => true,
        }
    }

    /// Whether every ray may test every triangle.
    pub const fn is_exhaustive(self) -> bool {
        matches!(self, Self::Product(AccelKind::Brute) | Self::Staged)
    }

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Product(kind) => kind.name(),
            Self::Staged => "staged",
            Self::KdSah => "kdsah",
            Self::KdTrail => "kdtrail",
            Self::Bvh2c => "bvh2c",
            Self::Bvh4 => "bvh4",
            Self::Bvh8 => "bvh8",
            Self::Bvh8w => "bvh8w",
        }
    }
}

impl fmt::Display for StructureKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that belongs to no structure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownStructure(pub String);

impl fmt::Display for UnknownStructure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = StructureKind::ALL.map(StructureKind::name);
        let (last, others) = names.split_last().unwrap_or((&"", &[]));
        write!(f, "'{}' is no acceleration structure; expected {} or {last}", self.0, others.join(", "))
    }
}

impl std::error::Error for UnknownStructure {}

impl raywarp_cli::advice::Advise for UnknownStructure {}

impl FromStr for StructureKind {
    type Err = UnknownStructure;

    fn from_str(name: &str) -> Result<Self, UnknownStructure> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| UnknownStructure(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_and_the_products_are_among_them() {
        for kind in StructureKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
        for kind in AccelKind::ALL {
            assert_eq!(kind.name().parse(), Ok(StructureKind::Product(kind)));
        }
        let error = "octree".parse::<StructureKind>().unwrap_err().to_string();
        assert!(error.starts_with("'octree' is no acceleration structure; expected brute, staged, kd, "), "{error}");
        assert!(error.ends_with(", bvh8w or bvh8f"), "{error}");
    }
}
