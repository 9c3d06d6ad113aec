//! Triangle meshes and their placement.

/// Indexed triangles in the mesh's own space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name in the file, for messages and picking.
    pub name: String,
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Unit shading normals, one a vertex; or empty. Zero for a vertex: the flat normal of each triangle is used there.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, one a vertex, (0, 0) at the lower left of the image (v up); or empty.
    pub uvs: Vec<[f32; 2]>,
    /// A second set of texture coordinates, one a vertex, as `uvs`; or empty: then (0, 0) everywhere.
    pub second_uvs: Vec<[f32; 2]>,
    /// Linear RGBA that multiplies the diffuse colour and the opacity, one a vertex; or empty.
    pub colors: Vec<[f32; 4]>,
    /// Unit tangent and handedness (+1 or -1), one a vertex; or empty: then derived from the texture
    /// coordinates of a normal map where there is one.
    pub tangents: Vec<[f32; 4]>,
    /// Vertex indices, counter-clockwise seen from outside. All are below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// Index of each triangle's material in [`Scene::materials`](super::Scene::materials); as long as `triangles`.
    pub materials: Vec<u32>,
}

/// A mesh put into the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Name in the file, for messages and picking.
    pub name: String,
    /// Index into [`Scene::meshes`](super::Scene::meshes).
    pub mesh: usize,
    /// Mesh space to world space.
    pub transform: Transform,
    /// A material for all triangles instead of the mesh's own.
    pub material: Option<u32>,
}

/// An affine map: the columns of its linear part, then the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Images of the three unit vectors.
    pub columns: [[f32; 3]; 3],
    /// Image of the origin.
    pub translation: [f32; 3],
}

impl Transform {
    /// Leaves every point where it is.
    pub const IDENTITY: Self =
        Self { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}
