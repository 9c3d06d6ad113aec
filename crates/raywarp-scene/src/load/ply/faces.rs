//! Vertex lists to triangles.

use super::super::triangulate::Triangulator;
use super::super::Place;
use super::values::Fault;

/// Larger polygons become fans: cutting them takes time by the square.
const MOST_CORNERS: usize = 1000;

/// The triangles and what was dropped on the way to them.
pub(super) struct Faces {
    vertex_count: usize,
    pub triangles: Vec<[u32; 3]>,
    /// Faces with fewer than three corners.
    pub too_small: usize,
    scratch: Vec<u32>,
    polygon: Vec<[f32; 3]>,
    triangulator: Triangulator,
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
            too_small: 0,
            scratch: Vec::new(),
            polygon: Vec::new(),
            triangulator: Triangulator::new(file_bytes),
        }
    }

    /// A polygon, cut where it is not convex. Without positions, in files that put them last, a fan.
    pub fn add_polygon(&mut self, corners: &[f64], positions: &[[f32; 3]]) -> Result<(), Corners> {
        if let &[a, b, c] = corners {
            self.triangles.push([self.vertex(a)?, self.vertex(b)?, self.vertex(c)?]);
            return Ok(());
        }
        self.scratch.clear();
        for &corner in corners {
            self.scratch.push(self.vertex(corner)?);
        }
        if (4..=MOST_CORNERS).contains(&corners.len()) && positions.len() == self.vertex_count {
            self.polygon.clear();
            self.polygon.extend(self.scratch.iter().map(|&vertex| positions[vertex as usize]));
            let triangles = self.triangulator.cut(&self.polygon);
            self.triangles.extend(triangles.iter().map(|corner| corner.map(|place| self.scratch[place as usize])));
            return Ok(());
        }
        let Some((&first, others)) = self.scratch.split_first() else {
            self.too_small += 1;
            return Ok(());
        };
        self.too_small += usize::from(others.len() < 2);
        self.triangles.extend(others.windows(2).map(|edge| [first, edge[0], edge[1]]));
        Ok(())
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
