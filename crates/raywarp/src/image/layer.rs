//! The layers that can be written beside a picture.

use std::fmt;
use std::str::FromStr;

/// One kind of information a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Layer {
    /// Distance along the camera ray, in scene units; infinite where nothing is.
    Depth,
    /// Unit shading normal in world space, on the side that is seen.
    Normal,
    /// Linear diffuse colour with textures, unlit.
    Albedo,
    /// Texture coordinates.
    Uv,
    /// World position.
    Position,
    /// Index of the triangle in its mesh.
    Primitive,
    /// Index of the instance in the scene.
    Instance,
    /// Index of the material.
    Material,
    /// Nodes visited, triangles tested and rays traced for the pixel.
    Tests,
}

impl Layer {
    /// Every layer, in the order of the documentation.
    pub const ALL: [Self; 9] = [
        Self::Depth,
        Self::Normal,
        Self::Albedo,
        Self::Uv,
        Self::Position,
        Self::Primitive,
        Self::Instance,
        Self::Material,
        Self::Tests,
    ];

    /// The name in file names, in EXR channels and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Albedo => "albedo",
            Self::Uv => "uv",
            Self::Position => "position",
            Self::Primitive => "primitive",
            Self::Instance => "instance",
            Self::Material => "material",
            Self::Tests => "tests",
        }
    }
}

impl fmt::Display for Layer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Layer {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|layer| layer.name() == text).ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|layer| layer.name()).collect();
            format!("the layers are {}", names.join(", "))
        })
    }
}
