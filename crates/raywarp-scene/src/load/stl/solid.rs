//! A solid under construction: facets over vertices that are kept once.

use std::collections::HashMap;

use crate::load::hash::FoldState;
use crate::Mesh;

/// The triangles of a solid.
#[derive(Default)]
pub(super) struct Solid {
    mesh: Mesh,
    known: HashMap<(u64, u64, u64, u64), u32, FoldState>,
}

/// Of a triangle and its material, and of a vertex with its colour and its entry in the table.
const TRIANGLE_BYTES: usize = 16;
const VERTEX_BYTES: usize = 12 + 16 + 37;

impl Solid {
    /// No triangle yet.
    pub fn new(name: String) -> Self {
        Self { mesh: Mesh { name, ..Mesh::default() }, known: HashMap::default() }
    }

    /// Adds a facet, with a colour for all of it where the file has colours: then every facet must have one.
    pub fn add(&mut self, corners: [[f32; 3]; 3], color: Option<[f32; 4]>) {
        let triangle = corners.map(|corner| self.vertex(corner, color));
        self.mesh.triangles.push(triangle);
        self.mesh.materials.push(0);
    }

    fn vertex(&mut self, position: [f32; 3], color: Option<[f32; 4]>) -> u32 {
        let pair = |x: f32, y: f32| u64::from(x.to_bits()) | u64::from(y.to_bits()) << 32;
        let ([x, y, z], [r, g, b, a]) = (position, color.unwrap_or_default());
        let mesh = &mut self.mesh;
        *self.known.entry((pair(x, y), pair(z, 0.0), pair(r, g), pair(b, a))).or_insert_with(|| {
            mesh.positions.push(position);
            mesh.colors.extend(color);
            mesh.positions.len() as u32 - 1
        })
    }

    /// About what it takes, with what finds vertices again.
    #[inline]
    pub fn bytes(&self) -> usize {
        self.mesh.triangles.len() * TRIANGLE_BYTES + self.mesh.positions.len() * VERTEX_BYTES
    }

    /// The mesh, unless it has no triangle; one without a name gets the other.
    pub fn finish(mut self, name: &str) -> Option<Mesh> {
        if self.mesh.name.is_empty() {
            self.mesh.name = name.to_owned();
        }
        (!self.mesh.triangles.is_empty()).then_some(self.mesh)
    }
}
