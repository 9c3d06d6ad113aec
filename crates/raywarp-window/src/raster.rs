//! Triangles of the interface, drawn into pixels.
//!
//! egui gives triangles with a colour at each vertex, multiplied by the texel of one texture: a white one for shapes,
//! the font atlas for text. Colours are sRGB bytes with the alpha multiplied in, and are blended as such, which is what
//! egui's own painters do. Vertices are snapped to 1/256 of a pixel and edges are decided in whole numbers: two
//! triangles that share an edge neither leave a pixel between them nor blend one twice.

use std::ops::Range;

use egui::epaint::Vertex;
use egui::{Color32, Mesh};

use crate::texture::Texture;

/// Rows of a picture of `0x00RRGGBB`.
pub struct Band<'a> {
    /// Row by row.
    pub pixels: &'a mut [u32],
    /// Pixels in a row.
    pub width: usize,
    /// Number of the first row in the whole picture.
    pub top: usize,
}

/// Columns and rows of the whole picture that may be drawn to.
pub struct Clip {
    /// From left to right.
    pub columns: Range<i64>,
    /// From top to bottom.
    pub rows: Range<i64>,
}

/// Draws a mesh whose places are points of `scale` pixels each. Indices out of range and places that are not finite are
/// left out.
pub fn draw(band: &mut Band, mesh: &Mesh, texture: &Texture, scale: f32, clip: &Clip) {
    let rows = band.pixels.len() / band.width.max(1);
    let (top, width) = (band.top as i64, band.width as i64);
    let clip = Clip {
        columns: clip.columns.start.max(0)..clip.columns.end.min(width),
        rows: clip.rows.start.max(top)..clip.rows.end.min(top + rows as i64),
    };
    if clip.rows.is_empty() || clip.columns.is_empty() {
        return;
    }
    // Most triangles are in other bands: those are not even prepared.
    let (low, high) = ((clip.rows.start - 1) as f32 / scale, (clip.rows.end + 1) as f32 / scale);
    for triangle in mesh.indices.chunks_exact(3) {
        let vertex = |i: usize| mesh.vertices.get(triangle[i] as usize);
        let (Some(a), Some(b), Some(c)) = (vertex(0), vertex(1), vertex(2)) else { continue };
        let all = |holds: &dyn Fn(f32) -> bool| [a, b, c].iter().all(|vertex| holds(vertex.pos.y));
        if all(&|y| y < low) || all(&|y| y > high) {
            continue;
        }
        if let Some(triangle) = Triangle::new([a, b, c], scale) {
            triangle.fill(band, texture, &clip);
        }
    }
}

/// Units a pixel.
const UNITS: i64 = 256;
/// Places beyond cannot be in a picture, and would overflow.
const FARTHEST: f32 = 1e6;

struct Triangle {
    edges: [Edge; 3],
    rows: Range<i64>,
    /// Flat unless one of them has a slope.
    color: [Plane; 4],
    uv: [Plane; 2],
}

impl Triangle {
    fn new(mut vertices: [&Vertex; 3], scale: f32) -> Option<Self> {
        let snapped = |v: &Vertex| {
            let place = [v.pos.x * scale, v.pos.y * scale];
            let inside = place.iter().all(|x| x.abs() < FARTHEST);
            inside.then(|| place.map(|x| (x * UNITS as f32).round() as i64))
        };
        let mut at = [snapped(vertices[0])?, snapped(vertices[1])?, snapped(vertices[2])?];
        let mut area = cross(at[0], at[1], at[2]);
        if area < 0 {
            vertices.swap(1, 2);
            at.swap(1, 2);
            area = -area;
        }
        if area == 0 {
            return None;
        }
        let low = at.iter().map(|p| p[1]).min()?;
        let high = at.iter().map(|p| p[1]).max()?;
        let plane = |of: &dyn Fn(&Vertex) -> f32| Plane::new(at, vertices.map(of), area);
        Some(Self {
            edges: [Edge::new(at[0], at[1]), Edge::new(at[1], at[2]), Edge::new(at[2], at[0])],
            rows: low.div_euclid(UNITS)..high.div_euclid(UNITS) + 1,
            color: [0, 1, 2, 3].map(|i| plane(&|v| f32::from(v.color.to_array()[i]))),
            uv: [plane(&|v| v.uv.x), plane(&|v| v.uv.y)],
        })
    }

    fn fill(&self, band: &mut Band, texture: &Texture, clip: &Clip) {
        let rows = self.rows.start.max(clip.rows.start)..self.rows.end.min(clip.rows.end);
        let flat = self.flat_color(texture);
        for y in rows {
            let columns = self.columns(y, &clip.columns);
            if columns.is_empty() {
                continue;
            }
            let first = (y as usize - band.top) * band.width;
            let row = &mut band.pixels[first + columns.start as usize..first + columns.end as usize];
            match flat {
                Some(color) => blend_all(row, color),
                None => self.shade(row, columns.start, y, texture),
            }
        }
    }

    /// The columns whose centres are inside in a row.
    fn columns(&self, y: i64, clip: &Range<i64>) -> Range<i64> {
        let mut columns = clip.clone();
        for edge in &self.edges {
            edge.cut(y, &mut columns);
        }
        columns
    }

    fn flat_color(&self, texture: &Texture) -> Option<Color32> {
        let planes = self.color.iter().chain(&self.uv);
        planes.clone().all(|plane| plane.slope == [0.0; 2]).then(|| {
            let [r, g, b, a] = [0, 1, 2, 3].map(|i| self.color[i].origin.round() as u8);
            let texel = texture.texel(self.uv[0].origin, self.uv[1].origin);
            multiply(Color32::from_rgba_premultiplied(r, g, b, a), texel)
        })
    }

    fn shade(&self, row: &mut [u32], x: i64, y: i64, texture: &Texture) {
        let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
        for (i, pixel) in row.iter_mut().enumerate() {
            let at = [x + i as f32, y];
            let texel = texture.texel(self.uv[0].at(at), self.uv[1].at(at));
            if texel != Color32::TRANSPARENT {
                // A cast to bytes clamps what rounding brings out of range.
                let [r, g, b, a] = [0, 1, 2, 3].map(|c| (self.color[c].at(at) + 0.5) as u8);
                *pixel = blend(*pixel, multiply(Color32::from_rgba_premultiplied(r, g, b, a), texel));
            }
        }
    }
}

/// Twice the area, positive for corners that run clockwise on the screen.
fn cross(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// A directed edge, with the inside to its right on the screen.
struct Edge {
    from: [i64; 2],
    along: [i64; 2],
    /// 1 where centres on the edge belong to the neighbour: the rule of top and left edges.
    bias: i64,
}

impl Edge {
    fn new(from: [i64; 2], to: [i64; 2]) -> Self {
        let along = [to[0] - from[0], to[1] - from[1]];
        let owns = along[1] < 0 || (along[1] == 0 && along[0] > 0);
        Self { from, along, bias: i64::from(!owns) }
    }

    /// Leaves of the columns of row `y` those with centres inside.
    fn cut(&self, y: i64, columns: &mut Range<i64>) {
        let ([dx, dy], half) = (self.along, UNITS / 2);
        // Inside is where `constant - dy * px` is not negative, for a centre at `px = UNITS * x + half`.
        let constant = dx * (y * UNITS + half - self.from[1]) + dy * self.from[0] - self.bias - dy * half;
        match dy.signum() {
            1 => columns.end = columns.end.min(constant.div_euclid(dy * UNITS) + 1),
            -1 => columns.start = columns.start.max(-constant.div_euclid(-dy * UNITS)),
            _ if constant < 0 => columns.end = columns.start,
            _ => {}
        }
    }
}

/// A value that is linear over the picture.
struct Plane {
    origin: f32,
    slope: [f32; 2],
    anchor: [f32; 2],
}

impl Plane {
    fn new(at: [[i64; 2]; 3], values: [f32; 3], area: i64) -> Self {
        let pixels = |units: i64| units as f32 / UNITS as f32;
        let area = area as f32 / (UNITS * UNITS) as f32;
        let (ab, ac) = (values[1] - values[0], values[2] - values[0]);
        let side = |i: usize, axis: usize| pixels(at[i][axis] - at[0][axis]);
        let slope = [(ab * side(2, 1) - ac * side(1, 1)) / area, (ac * side(1, 0) - ab * side(2, 0)) / area];
        Self { origin: values[0], slope, anchor: at[0].map(pixels) }
    }

    fn at(&self, [x, y]: [f32; 2]) -> f32 {
        self.origin + (x - self.anchor[0]) * self.slope[0] + (y - self.anchor[1]) * self.slope[1]
    }
}

fn multiply(color: Color32, texel: Color32) -> Color32 {
    if texel == Color32::WHITE {
        return color;
    }
    let (a, b) = (color.to_array(), texel.to_array());
    let [r, g, b, a] = [0, 1, 2, 3].map(|i| ((u32::from(a[i]) * u32::from(b[i]) + 127) / 255) as u8);
    Color32::from_rgba_premultiplied(r, g, b, a)
}

fn blend_all(row: &mut [u32], color: Color32) {
    match color.a() {
        255 => row.fill(blend(0, color)),
        _ if color == Color32::TRANSPARENT => {}
        _ => row.iter_mut().for_each(|pixel| *pixel = blend(*pixel, color)),
    }
}

/// A colour with its alpha multiplied in, over a pixel.
fn blend(pixel: u32, color: Color32) -> u32 {
    let left = 255 - u32::from(color.a());
    let channel = |shift: u32, over: u8| {
        let under = ((pixel >> shift) & 255) * left + 128;
        // Exactly `under / 255` rounded, for all products of two bytes.
        ((under + (under >> 8)) >> 8).saturating_add(u32::from(over)).min(255) << shift
    };
    channel(16, color.r()) | channel(8, color.g()) | channel(0, color.b())
}

#[cfg(test)]
mod tests {
    use egui::epaint::WHITE_UV;
    use egui::pos2;
    use proptest::prelude::*;

    use super::*;

    const SIZE: usize = 24;

    fn drawn(mesh: &Mesh) -> Vec<u32> {
        let mut pixels = vec![0; SIZE * SIZE];
        let clip = Clip { columns: 0..i64::MAX, rows: 0..i64::MAX };
        for (i, rows) in pixels.chunks_mut(SIZE * 5).enumerate() {
            let mut band = Band { pixels: rows, width: SIZE, top: i * 5 };
            draw(&mut band, mesh, &Texture::default(), 1.0, &clip);
        }
        pixels
    }

    fn mesh(corners: &[[f32; 2]], color: Color32) -> Mesh {
        let vertices = corners.iter().map(|&[x, y]| Vertex { pos: pos2(x, y), uv: WHITE_UV, color }).collect();
        Mesh { indices: (0..corners.len() as u32).collect(), vertices, ..Mesh::default() }
    }

    #[test]
    fn a_rectangle_covers_its_pixels_and_no_others() {
        let corners = [[2.0, 3.0], [10.0, 3.0], [10.0, 7.0], [2.0, 3.0], [2.0, 7.0], [10.0, 7.0]];
        let pixels = drawn(&mesh(&corners, Color32::from_rgb(10, 20, 30)));
        for (i, &pixel) in pixels.iter().enumerate() {
            let inside = (2..10).contains(&(i % SIZE)) && (3..7).contains(&(i / SIZE));
            assert_eq!(pixel, if inside { 0x0a141e } else { 0 }, "{i}");
        }
    }

    #[test]
    fn colours_run_from_vertex_to_vertex() {
        let mut strip = mesh(&[[0.0, 0.0], [24.0, 0.0], [0.0, 24.0]], Color32::BLACK);
        strip.vertices[1].color = Color32::from_rgb(240, 0, 0);
        let pixels = drawn(&strip);
        for (x, pixel) in pixels[..20].iter().enumerate() {
            assert_eq!(pixel >> 16, 10 * x as u32 + 5, "{x}");
        }
    }

    #[test]
    fn nonsense_is_left_out() {
        let nan = mesh(&[[f32::NAN, 0.0], [9.0, 0.0], [0.0, 9.0]], Color32::WHITE);
        let far = mesh(&[[1e30, 0.0], [-1e30, 0.0], [0.0, f32::INFINITY]], Color32::WHITE);
        let thin = mesh(&[[0.0, 0.0], [9.0, 9.0], [18.0, 18.0]], Color32::WHITE);
        let mut wrong = mesh(&[[0.0, 0.0], [9.0, 0.0], [0.0, 9.0]], Color32::WHITE);
        wrong.indices = vec![0, 1, 7, 2];
        for mesh in [nan, far, thin, wrong] {
            assert!(drawn(&mesh).iter().all(|&pixel| pixel == 0));
        }
    }

    #[test]
    fn blending_is_exact() {
        for under in 0..=255u32 {
            for a in 0..=255u8 {
                let exact = (f64::from(under) * f64::from(255 - a) / 255.0).round() as u32;
                assert_eq!(blend(under << 8, Color32::from_rgba_premultiplied(0, 0, 0, a)), exact << 8);
            }
        }
        assert_eq!(blend(0xffffff, Color32::from_rgba_premultiplied(9, 9, 9, 0)), 0xffffff);
    }

    proptest! {
        /// A fan about any point in a square, half transparent: every pixel of the square exactly once.
        #[test]
        fn neighbours_share_no_pixel_and_leave_none(x in 1.0f32..19.0, y in 1.0f32..19.0, turn in any::<bool>()) {
            let corners = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
            let fan: Vec<_> = (0..4).flat_map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % 4]);
                if turn { [[x, y], a, b] } else { [[x, y], b, a] }
            }).collect();
            let pixels = drawn(&mesh(&fan, Color32::from_rgba_premultiplied(100, 100, 100, 128)));
            for (i, &pixel) in pixels.iter().enumerate() {
                let inside = i % SIZE < 20 && i / SIZE < 20;
                prop_assert_eq!(pixel, if inside { 0x646464 } else { 0 }, "pixel {}", i);
            }
        }
    }
}
