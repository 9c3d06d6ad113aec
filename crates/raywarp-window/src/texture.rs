//! The textures of the interface: the font atlas.

use std::collections::HashMap;

use egui::{Color32, ColorImage, ImageData, TextureId, TexturesDelta};

/// One texture. Without texels it is white.
#[derive(Default)]
pub struct Texture(ColorImage);

impl Texture {
    /// The texel at a place of 0 to 1 each way; the nearest, as glyphs are laid out on whole pixels.
    pub fn texel(&self, u: f32, v: f32) -> Color32 {
        let [width, height] = self.0.size;
        // Casts clamp: below 0 and NaN become 0.
        let x = ((u * width as f32) as usize).min(width.saturating_sub(1));
        let y = ((v * height as f32) as usize).min(height.saturating_sub(1));
        self.0.pixels.get(y * width + x).copied().unwrap_or(Color32::WHITE)
    }

    fn replace(&mut self, [left, top]: [usize; 2], part: &ColorImage) {
        let [width, height] = part.size;
        for row in 0..height {
            let from = part.pixels.get(row * width..(row + 1) * width);
            let start = (top + row) * self.0.size[0] + left;
            if let (Some(from), Some(to)) = (from, self.0.pixels.get_mut(start..start + width)) {
                to.copy_from_slice(from);
            }
        }
    }
}

/// All of them.
#[derive(Default)]
pub struct Textures(HashMap<TextureId, Texture>);

impl Textures {
    /// Takes what is new; what is to be freed stays until [`free`](Self::free).
    pub fn set(&mut self, delta: &TexturesDelta) {
        for (id, change) in &delta.set {
            let ImageData::Color(image) = &change.image;
            let texture = self.0.entry(*id).or_default();
            match change.pos {
                Some(place) => texture.replace(place, image),
                None => texture.0 = ColorImage::clone(image),
            }
        }
    }

    /// Lets go of what is no longer drawn.
    pub fn free(&mut self, delta: &TexturesDelta) {
        for id in &delta.free {
            self.0.remove(id);
        }
    }

    /// The texture of a mesh, if it is known.
    pub fn get(&self, id: TextureId) -> Option<&Texture> {
        self.0.get(&id)
    }
}
