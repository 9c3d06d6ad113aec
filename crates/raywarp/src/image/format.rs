//! Kinds of picture files.

use std::fmt;
use std::path::Path;

use super::ImageError;
use crate::write::is_dash;

/// Kinds of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Eight bits a channel, sRGB.
    Png,
    /// 32 bits a channel, linear, with layers.
    Exr,
}

impl Format {
    /// What a file's extension asks for; `-` is PNG to standard output.
    ///
    /// # Errors
    /// [`ImageError::UnknownExtension`].
    pub fn of(path: &Path) -> Result<Self, ImageError> {
        if is_dash(path) {
            return Ok(Self::Png);
        }
        match path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(ImageError::UnknownExtension(path.to_owned())),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Png => "PNG",
            Self::Exr => "EXR",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_tells() {
        for (name, format) in [("a.png", Format::Png), ("b/a.EXR", Format::Exr), ("-", Format::Png)] {
            assert_eq!(Format::of(Path::new(name)).unwrap(), format);
        }
        assert!(matches!(Format::of(Path::new("a.gif")), Err(ImageError::UnknownExtension(_))));
    }
}
