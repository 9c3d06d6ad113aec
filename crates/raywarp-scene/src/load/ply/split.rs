//! What belongs to a corner of a face or to a whole face, given to vertices: one for each combination that there is.

use std::collections::HashMap;

use crate::load::hash::FoldState;
use crate::Mesh;

/// A vertex of the file with the attributes of a corner.
type Key = (u64, u64, u64, u64);

/// Takes over texture coordinates of each triangle's corners and colours of triangles; either list may be empty. Where a
/// triangle has none, those of its vertices stay, or (0, 0).
pub(super) fn split(mesh: &mut Mesh, uvs: &[Option<[[f32; 2]; 3]>], colors: &[[f32; 4]]) {
    let mut split =
        Split { whole: std::mem::take(mesh), uvs, colors, mesh: Mesh::default(), known: HashMap::default() };
    split.mesh.name = std::mem::take(&mut split.whole.name);
    split.mesh.materials = std::mem::take(&mut split.whole.materials);
    split.mesh.triangles =
        (0..split.whole.triangles.len()).map(|at| [0, 1, 2].map(|corner| split.vertex(at, corner))).collect();
    *mesh = split.mesh;
}

struct Split<'a> {
    /// The mesh as its vertices stand in the file.
    whole: Mesh,
    uvs: &'a [Option<[[f32; 2]; 3]>],
    colors: &'a [[f32; 4]],
    mesh: Mesh,
    known: HashMap<Key, u32, FoldState>,
}

impl Split<'_> {
    /// The vertex for a corner of a triangle.
    fn vertex(&mut self, triangle: usize, corner: usize) -> u32 {
        let vertex = self.whole.triangles[triangle][corner];
        let own = self.whole.uvs.get(vertex as usize).copied();
        let uv =
            self.uvs.get(triangle).map(|corners| corners.map_or(own.unwrap_or_default(), |corners| corners[corner]));
        let color = self.colors.get(triangle).copied();
        let pair = |x: f32, y: f32| u64::from(x.to_bits()) | u64::from(y.to_bits()) << 32;
        let [r, g, b, a] = color.unwrap_or_default();
        let key = (u64::from(vertex), uv.map_or(0, |[u, v]| pair(u, v)), pair(r, g), pair(b, a));
        let next = self.mesh.positions.len() as u32;
        let known = *self.known.entry(key).or_insert(next);
        if known == next {
            self.push(vertex as usize, uv, color);
        }
        known
    }

    fn push(&mut self, vertex: usize, uv: Option<[f32; 2]>, color: Option<[f32; 4]>) {
        let (whole, mesh) = (&self.whole, &mut self.mesh);
        mesh.positions.push(whole.positions[vertex]);
        mesh.normals.extend(whole.normals.get(vertex));
        mesh.uvs.extend(uv.or(whole.uvs.get(vertex).copied()));
        mesh.colors.extend(color.or(whole.colors.get(vertex).copied()));
    }
}
