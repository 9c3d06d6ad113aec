//! What is asked and how it is written, by name.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// What is asked of each ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// The closest hit.
    #[default]
    Closest,
    /// Whether there is any.
    Any,
    /// How many there are.
    Count,
    /// Each of them.
    All,
}

impl Mode {
    /// Every mode.
    pub const ALL: [Self; 4] = [Self::Closest, Self::Any, Self::Count, Self::All];

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest",
            Self::Any => "any",
            Self::Count => "count",
            Self::All => "all",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that belongs to no mode.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no question; expected closest, any, count or all")]
pub struct UnknownMode(pub String);

impl FromStr for Mode {
    type Err = UnknownMode;

    fn from_str(name: &str) -> Result<Self, UnknownMode> {
        Self::ALL.into_iter().find(|mode| mode.name() == name).ok_or_else(|| UnknownMode(name.to_owned()))
    }
}

/// Kinds of answer files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// NumPy's archive of named arrays, not compressed.
    Npz,
    /// One array of NumPy.
    Npy,
    /// Text, numbers with commas, a line a ray, or a line a hit for [`Mode::All`].
    Csv,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 3] = [Self::Npz, Self::Npy, Self::Csv];

    /// The name that [`FromStr`] reads, which is the file's extension.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Npz => "npz",
            Self::Npy => "npy",
            Self::Csv => "csv",
        }
    }

    /// What a file's extension asks for.
    pub fn of(path: &Path) -> Option<Self> {
        path.extension()?.to_str()?.to_ascii_lowercase().parse().ok()
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that belongs to no format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no format of answers; expected npz, npy or csv")]
pub struct UnknownFormat(pub String);

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(name: &str) -> Result<Self, UnknownFormat> {
        Self::ALL.into_iter().find(|format| format.name() == name).ok_or_else(|| UnknownFormat(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back() {
        for mode in Mode::ALL {
            assert_eq!(mode.to_string().parse(), Ok(mode));
        }
        for format in Format::ALL {
            assert_eq!(format.to_string().parse(), Ok(format));
        }
        assert_eq!(Format::of(Path::new("a.b/hits.NPZ")), Some(Format::Npz));
        assert_eq!([Format::of(Path::new("hits.txt")), Format::of(Path::new("-"))], [None, None]);
        assert!("first".parse::<Mode>().is_err() && "".parse::<Format>().is_err());
    }
}
