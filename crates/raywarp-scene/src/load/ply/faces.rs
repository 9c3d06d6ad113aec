//! Vertex lists to triangles, with what faces say of their corners.

use super::super::triangulate::Triangulator;
use super::super::Place;
use super::values::Fault;

/// Larger polygons become fans: cutting them takes time by the square.
const MOST_CORNERS: usize = 1000;

/// The triangles and what was dropped on the way to them.
pub(super) struct Faces {
    vertex_count: usize,
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of the corners of each triangle, `None` where the list does not fit; empty where faces have
    /// none.
    pub uvs: Vec<Option<[[f32; 2]; 3]>>,
    /// Colour of each triangle; empty where faces have none.
    pub colors: Vec<[f32; 4]>,
    /// Number of each triangle's picture, -1 for none; empty where faces do not say.
    pub textures: Vec<i32>,
    /// Faces with fewer than three corners that differ.
    pub too_small: usize,
    /// Faces whose list of texture coordinates is not two for each corner.
    pub odd_uvs: usize,
    scratch: Vec<u32>,
    polygon: Vec<[f32; 3]>,
    /// Triangles of a polygon, by places in its list.
    places: Vec<[u32; 3]>,
    triangulator: Triangulator,
}

/// What a face says beside its corners.
#[derive(Default)]
pub(super) struct Attributes {
    /// u and v for each corner, in turn. `None` where the table has no such list.
    pub uvs: Option<Vec<f64>>,
    /// Linear, as far as [`ColorFormat::color`](super::color::ColorFormat::color) makes it so.
    pub color: Option<[f32; 4]>,
    /// Number of its picture.
    pub texture: Option<f64>,
}

/// A corner that is not a vertex.
pub(super) struct Corners {
    index: f64,
    vertex_count: usize,
}

impl Corners {
    /// The message, at the place of the list.
    pub fn at(self, place: Place) -> Fault {
        let expected = match self.vertex_count {
            0 => "no faces where there are no vertices".to_owned(),
            count => format!("a whole number from 0 to {}", count - 1),
        };
        Fault { place, read: format!("vertex index {}", self.index), expected }
    }
}

impl Faces {
    /// No faces yet, between so many vertices, in a file of so many bytes.
    pub fn new(vertex_count: usize, file_bytes: usize) -> Self {
        Self {
            vertex_count,
            triangles: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            textures: Vec::new(),
            too_small: 0,
            odd_uvs: 0,
            scratch: Vec::new(),
            polygon: Vec::new(),
            places: Vec::new(),
            triangulator: Triangulator::new(file_bytes),
        }
    }

    /// A polygon, cut where it is not convex. Without positions, in files that put them last, a fan.
    pub fn add_polygon(
        &mut self,
        corners: &[f64],
        attributes: &Attributes,
        positions: &[[f32; 3]],
    ) -> Result<(), Corners> {
        self.scratch.clear();
        for &corner in corners {
            self.scratch.push(self.vertex(corner)?);
        }
        self.cut(positions);
        self.too_small += usize::from(self.places.is_empty());
        for &places in &self.places {
            self.triangles.push(places.map(|place| self.scratch[place as usize]));
        }
        self.add_attributes(attributes, corners.len());
        Ok(())
    }

    fn cut(&mut self, positions: &[[f32; 3]]) {
        let count = self.scratch.len() as u32;
        self.places.clear();
        if (4..=MOST_CORNERS).contains(&self.scratch.len()) && positions.len() == self.vertex_count {
            self.polygon.clear();
            self.polygon.extend(self.scratch.iter().map(|&vertex| positions[vertex as usize]));
            self.places.extend_from_slice(self.triangulator.cut(&self.polygon));
        } else {
            self.places.extend((2..count).map(|place| [0, place - 1, place]));
        }
    }

    fn add_attributes(&mut self, attributes: &Attributes, corners: usize) {
        if let Some(uvs) = &attributes.uvs {
            let fits = uvs.len() == 2 * corners;
            self.odd_uvs += usize::from(!fits && !self.places.is_empty());
            let finite = |x: f64| if (x as f32).is_finite() { x as f32 } else { 0.0 };
            let uv = |place: u32| [2 * place as usize, 2 * place as usize + 1].map(|at| finite(uvs[at]));
            self.uvs.extend(self.places.iter().map(|places| fits.then(|| places.map(uv))));
        }
        let triangles = self.places.len();
        if let Some(color) = attributes.color {
            self.colors.extend(std::iter::repeat_n(color, triangles));
        }
        if let Some(texture) = attributes.texture {
            // Saturates, and NaN is 0.
            self.textures.extend(std::iter::repeat_n(texture as i32, triangles));
        }
    }

    /// Strips of triangles; -1 starts a new one.
    pub fn add_strips(&mut self, corners: &[f64]) -> Result<(), Corners> {
        for strip in corners.split(|&corner| corner == -1.0) {
            for (place, window) in strip.windows(3).enumerate() {
                let [a, b, c] = [self.vertex(window[0])?, self.vertex(window[1])?, self.vertex(window[2])?];
                // Strips repeat corners to turn; those triangles have no area.
                if a != b && b != c && c != a {
                    self.triangles.push(if place % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
        Ok(())
    }

    fn vertex(&self, index: f64) -> Result<u32, Corners> {
        // Not so for NaN either. Counts beyond u32 never get here: the header was checked against the file.
        if index >= 0.0 && index < self.vertex_count as f64 && index <= f64::from(u32::MAX) && index.fract() == 0.0 {
            return Ok(index as u32);
        }
        Err(Corners { index, vertex_count: self.vertex_count })
    }
}
