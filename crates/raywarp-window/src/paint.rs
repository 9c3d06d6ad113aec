//! All pixels of the window: the picture, and the interface over it.

use egui::epaint::Primitive;
use egui::ClippedPrimitive;
use rayon::prelude::*;

use crate::raster::{self, Band, Clip};
use crate::scale::Scaling;
use crate::texture::Textures;
use raywarp_viewer::live::Picture;

/// Where there is no picture yet.
const EMPTY: u32 = 0x1c1c1e;
/// Rows that one thread does at a time: few enough to stay in its cache from the picture to the last triangle.
const BAND: usize = 32;

/// What is over the picture.
pub struct Overlay<'a> {
    /// In the order that they are drawn in.
    pub primitives: &'a [ClippedPrimitive],
    /// Of the primitives.
    pub textures: &'a Textures,
    /// Pixels a point.
    pub scale: f32,
}

/// Fills a window of `size` pixels, row by row as `0x00RRGGBB`.
pub fn paint(pixels: &mut [u32], size: [usize; 2], picture: Option<&Picture>, overlay: &Overlay) {
    let width = size[0].max(1);
    let scaling = picture.and_then(|picture| Scaling::new(picture, size));
    pixels.par_chunks_mut(width * BAND).enumerate().for_each_init(Vec::new, |between, (i, rows)| {
        match &scaling {
            Some(scaling) => {
                for (y, row) in rows.chunks_exact_mut(width).enumerate() {
                    scaling.row(i * BAND + y, row, between);
                }
            }
            None => rows.fill(EMPTY),
        }
        overlay.draw(&mut Band { pixels: rows, width, top: i * BAND });
    });
}

impl Overlay<'_> {
    fn draw(&self, band: &mut Band) {
        for ClippedPrimitive { clip_rect, primitive } in self.primitives {
            // Callbacks are for those who draw with a graphics card.
            let Primitive::Mesh(mesh) = primitive else { continue };
            let Some(texture) = self.textures.get(mesh.texture_id) else { continue };
            let edge = |points: f32| (points * self.scale).round() as i64;
            let clip = Clip {
                columns: edge(clip_rect.min.x)..edge(clip_rect.max.x),
                rows: edge(clip_rect.min.y)..edge(clip_rect.max.y),
            };
            raster::draw(band, mesh, texture, self.scale, &clip);
        }
    }
}
