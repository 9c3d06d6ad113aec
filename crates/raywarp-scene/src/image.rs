//! Decoded pictures.

/// Eight-bit RGBA texels, top row first.
#[derive(Clone, Default)]
pub struct Image {
    /// Path or name, for messages.
    pub name: String,
    /// Texels a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `width * height` texels as they stand in the file: sRGB or linear is the texture's business.
    pub texels: Vec<[u8; 4]>,
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Image({}, {}x{})", self.name, self.width, self.height)
    }
}
