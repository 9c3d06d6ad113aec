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

/// Columns and rows of the window that a picture takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// Its upper left pixel.
    pub first: [usize; 2],
    /// Columns and rows, within the window.
    pub size: [usize; 2],
}

/// What is over the picture.
pub struct Overlay<'a> {
    /// In the order that they are drawn in.
    pub primitives: &'a [ClippedPrimitive],
    /// Of the primitives.
    pub textures: &'a Textures,
    /// Pixels a point.
    pub scale: f32,
}

/// Fills a window of so many columns, row by row as `0x00RRGGBB`: the picture in its area, and the rest empty.
pub fn paint(pixels: &mut [u32], columns: usize, picture: Option<(&Picture, Area)>, overlay: &Overlay) {
    let width = columns.max(1);
    let scaling = picture.and_then(|(picture, area)| Some((Scaling::new(picture, area.size)?, area)));
    pixels.par_chunks_mut(width * BAND).enumerate().for_each_init(Vec::new, |between, (i, rows)| {
        for (y, row) in rows.chunks_exact_mut(width).enumerate() {
            match &scaling {
                Some((scaling, area)) => area.fill(i * BAND + y, row, scaling, between),
                None => row.fill(EMPTY),
            }
        }
        overlay.draw(&mut Band { pixels: rows, width, top: i * BAND });
    });
}

impl Area {
    fn fill(&self, y: usize, row: &mut [u32], scaling: &Scaling, between: &mut Vec<u32>) {
        let [left, top] = self.first;
        if row.len() > self.size[0] {
            row.fill(EMPTY);
        }
        let within = row.get_mut(left..left + self.size[0]);
        match (within, y.checked_sub(top).filter(|&y| y < self.size[1])) {
            (Some(within), Some(y)) => scaling.row(y, within, between),
            _ => row.fill(EMPTY),
        }
    }
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
