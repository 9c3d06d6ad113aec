//! The outline of an object over the picture: around what is seen of it, so that the object itself stays as it is.

use rayon::prelude::*;
use raywarp::render::{RenderError, RenderOptions, Tracer};
use raywarp::scene::Camera;

/// Of the line.
pub const COLOR: [u8; 3] = [255, 166, 26];
/// Most pixels that are looked at; a larger picture has the outline of a smaller one, scaled.
const MOST: f64 = (1 << 20) as f64;
/// Rows of the picture for a pixel of the line's width.
const ROWS: u32 = 400;

/// Where the line is, in a picture of this size.
#[derive(Clone, Debug)]
pub struct Outline {
    size: [u32; 2],
    line: Vec<bool>,
}

impl Outline {
    /// Of an instance as it is seen through a camera.
    ///
    /// # Errors
    /// [`RenderError`] for a camera that cannot be rendered from, or where the device fails.
    pub fn of(tracer: &Tracer, camera: &Camera, size: [u32; 2], instance: usize) -> Result<Self, RenderError> {
        let scale = (MOST / (f64::from(size[0]) * f64::from(size[1]))).sqrt().min(1.0);
        let size = size.map(|side| ((f64::from(side) * scale) as u32).max(1));
        let first_hits = tracer.layers(camera, &RenderOptions { size, ..RenderOptions::default() })?;
        let inside: Vec<bool> = first_hits.par_iter().map(|hit| hit.instance as usize == instance).collect();
        Ok(Self { size, line: around(&inside, size, size[1].div_ceil(ROWS) as usize) })
    }

    /// Draws it over a picture of so many columns and rows, four bytes a pixel.
    pub fn draw(&self, rgba: &mut [u8], [width, height]: [u32; 2]) {
        let nearest = |i: usize, shown: u32, own: u32| (2 * i + 1) * own as usize / (2 * shown as usize);
        rgba.par_chunks_exact_mut(4 * width as usize).take(height as usize).enumerate().for_each(|(y, row)| {
            let line = &self.line[nearest(y, height, self.size[1]) * self.size[0] as usize..];
            for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
                if line[nearest(x, width, self.size[0])] {
                    pixel[..3].copy_from_slice(&COLOR);
                }
            }
        });
    }
}

/// The pixels outside that have one inside at most so many columns and rows away.
fn around(inside: &[bool], [width, height]: [u32; 2], reach: usize) -> Vec<bool> {
    let (width, height) = (width as usize, height as usize);
    let near = |i: usize, end: usize| i.saturating_sub(reach)..(i + reach + 1).min(end);
    let wide: Vec<bool> =
        inside.par_chunks(width).flat_map_iter(|row| (0..width).map(|x| row[near(x, width)].contains(&true))).collect();
    let is_line = |i: usize| !inside[i] && near(i / width, height).any(|y| wide[y * width + i % width]);
    (0..inside.len()).into_par_iter().map(is_line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_goes_around_what_is_inside() {
        let inside: Vec<bool> =
            "....... ....... ..##... ..##... .......".chars().filter(|&c| c != ' ').map(|c| c == '#').collect();
        let line = around(&inside, [7, 5], 1);
        let drawn: Vec<String> =
            line.chunks(7).map(|row| row.iter().map(|&on| if on { '#' } else { '.' }).collect()).collect();
        assert_eq!(drawn, [".......", ".####..", ".#..#..", ".#..#..", ".####.."]);
        assert!(!around(&[false; 12], [4, 3], 2).contains(&true) && !around(&[true; 12], [4, 3], 2).contains(&true));
    }

    #[test]
    fn it_is_scaled_to_the_picture() {
        let outline = Outline { size: [2, 1], line: vec![false, true] };
        let mut rgba = vec![0; 4 * 4 * 2];
        outline.draw(&mut rgba, [4, 2]);
        let drawn: Vec<bool> = rgba.chunks_exact(4).map(|pixel| pixel[..3] == COLOR).collect();
        assert_eq!(drawn, [false, false, true, true, false, false, true, true]);
    }
}
