//! The boxes of the tree, drawn over the picture as lines of light.
//!
//! The boxes of one level and the leaves above it are bright; those on the way there are fainter and wider, so that the
//! hierarchy shows without hiding what it is made of. Each level has its own hue. Of a box seen from outside, the edges
//! behind it are fainter than those in front. Nothing of the scene hides a line.

mod eye;
mod line;

use rayon::prelude::*;
use raywarp::accel::TreeBox;
use raywarp::scene::Camera;

use eye::Eye;
use line::{Band, Line};

/// Strength of a line that is hardly seen: it is left out.
const LEAST: f32 = 0.06;

/// Draws boxes down to a level over a picture of so many columns and rows: red, green, blue and anything of each pixel,
/// top row first. `boxes` may go deeper; they are those of [`Structure::boxes`](raywarp::device_scene::Structure::boxes).
///
/// Boxes and edges that are not at finite places are left out. Nothing is drawn with a camera that cannot be rendered
/// from, or where the picture has another size.
pub fn draw(rgba: &mut [u8], size: [u32; 2], camera: &Camera, boxes: &[TreeBox], level: u32) {
    let [width, height] = size.map(|side| side as usize);
    let bytes = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(4));
    let Some(eye) = Eye::new(camera, size).filter(|_| bytes == Some(rgba.len()) && bytes != Some(0)) else { return };
    let lines = lines(&eye, size, boxes, level);
    // Few bands, as each looks at all lines; more than threads, as they take unlike times.
    let rows = height.div_ceil(4 * rayon::current_num_threads()).max(8);
    rgba.par_chunks_mut(4 * width * rows).enumerate().for_each(|(band, pixels)| {
        let mut band = Band { pixels, columns: width, first: band * rows };
        lines.iter().for_each(|line| line.draw(&mut band));
    });
}

/// All edges that the picture shows, in the order of drawing: deep levels first.
fn lines(eye: &Eye, size: [u32; 2], boxes: &[TreeBox], level: u32) -> Vec<Line> {
    let deepest = boxes.iter().map(|item| item.level).filter(|&own| own <= level).max().unwrap_or(0);
    let scale = (size[0].min(size[1]) as f32 / 1080.0).clamp(1.0, 4.0);
    let shown = boxes.par_iter().rev().filter(|item| item.level <= level);
    shown.flat_map_iter(|item| edges(eye, item, Style::of(item, deepest, scale))).collect()
}

/// How the edges of a box look.
struct Style {
    color: [u8; 3],
    width: f32,
    strength: f32,
}

impl Style {
    fn of(item: &TreeBox, deepest: u32, scale: f32) -> Self {
        let above = if item.is_leaf { 0 } else { (deepest - item.level.min(deepest)).min(8) };
        let depth = item.level.min(8) as f32;
        Self {
            color: hue(item.level),
            width: scale * if above == 0 { 1.0 } else { 1.0 + 1.2 * 0.75f32.powf(depth) },
            strength: if above == 0 { 0.9 } else { 0.5 * 0.8f32.powi(above as i32 - 1) },
        }
    }
}

/// Of a level: far from those of its neighbours.
fn hue(level: u32) -> [u8; 3] {
    const WHEEL: [[u8; 3]; 7] = [
        [255, 214, 64],
        [64, 200, 255],
        [255, 104, 180],
        [112, 240, 96],
        [255, 140, 48],
        [160, 136, 255],
        [48, 240, 200],
    ];
    WHEEL[level as usize % WHEEL.len()]
}

/// The edges of a box that the picture shows.
fn edges<'a>(eye: &'a Eye, item: &TreeBox, style: Style) -> impl Iterator<Item = Line> + 'a {
    let faces = eye.faces(&item.bounds);
    let corners = eye.corners(&item.bounds);
    let is_inside = faces == [[false; 2]; 3];
    let edge = move |axis: usize, sides: [usize; 2]| {
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let from = sides[0] << others[0] | sides[1] << others[1];
        let ends = eye.project([corners[from], corners[from | 1 << axis]])?;
        let is_front = is_inside || faces[others[0]][sides[0]] || faces[others[1]][sides[1]];
        let strength = style.strength * if is_front { 1.0 } else { 0.4 } * faintness(ends);
        (strength > LEAST).then_some(Line { ends, color: style.color, width: style.width, strength })
    };
    (0..12).filter_map(move |i| edge(i / 4, [i & 1, i >> 1 & 1]))
}

/// Where boxes are small there are many: short edges are fainter, lest they hide the picture.
fn faintness([from, to]: [[f32; 2]; 2]) -> f32 {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    (length / 16.0).clamp(0.3, 1.0)
}

#[cfg(test)]
mod tests;
