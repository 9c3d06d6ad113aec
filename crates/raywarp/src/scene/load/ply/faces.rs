//! Vertex lists to triangles.

use super::super::Place;
use super::values::Fault;

/// The triangles and what was dropped on the way to them.
pub(super) struct Faces {
    vertex_count: usize,
    pub triangles: Vec<[u32; 3]>,
    /// Faces with fewer than three corners.
    pub too_small: usize,
    scratch: Vec<u32>,
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
    /// No faces yet, between so many vertices.
    pub fn new(vertex_count: usize) -> Self {
        Self { vertex_count, triangles: Vec::new(), too_small: 0, scratch: Vec::new() }
    }

    /// A polygon as a fan around its first corner.
    pub fn add_polygon(&mut self, corners: &[f64]) -> Result<(), Corners> {
        if let &[a, b, c] = corners {
            self.triangles.push([self.vertex(a)?, self.vertex(b)?, self.vertex(c)?]);
            return Ok(());
        }
        self.scratch.clear();
        for &corner in corners {
            self.scratch.push(self.vertex(corner)?);
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
