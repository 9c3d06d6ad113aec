//! Stand-in until the tree builders land.
use std::fmt;
use std::str::FromStr;

/// Which structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AccelKind {
    /// Every triangle.
    Brute,
    /// The paper's tree.
    Kd,
    /// Boxes.
    #[default]
    Bvh,
}

impl fmt::Display for AccelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Brute => "brute",
            Self::Kd => "kd",
            Self::Bvh => "bvh",
        })
    }
}

impl FromStr for AccelKind {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "brute" => Ok(Self::Brute),
            "kd" => Ok(Self::Kd),
            "bvh" => Ok(Self::Bvh),
            _ => Err("the structures are brute, kd and bvh".to_owned()),
        }
    }
}

/// Quality of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct TreeStats {
    pub nodes: usize,
    pub leaves: usize,
    pub references: usize,
    pub depth: usize,
    pub largest_leaf: usize,
    pub sah_cost: f64,
    pub bytes: usize,
    pub build_seconds: f64,
}
