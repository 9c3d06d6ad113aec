//! From the number of a triangle in the whole scene to an instance and a triangle of its mesh.

use glam::Mat3;

use raywarp_core::math::Vec3;
use raywarp_core::triangle::RayShear;

use crate::scene::{Instance, Mesh, Scene};
use crate::{Hit, Ray, Triangle, MISS};

/// Where the triangles of each instance begin: kernels number those of the whole scene, one instance after the other.
#[derive(Clone, Debug, Default)]
pub struct Geometries {
    /// Number of each instance's first triangle, ascending. Empty: one geometry, with the numbers as they are.
    first: Vec<u32>,
    /// Whether the instance is mirrored: then its triangles are traced with vertices 1 and 2 exchanged.
    mirrored: Vec<bool>,
}

impl Geometries {
    /// Of a scene's instances, in their order.
    pub fn of(scene: &Scene) -> Self {
        Self::placed(&scene.meshes, &scene.instances)
    }

    /// Of meshes and their instances, in their order.
    pub fn placed(meshes: &[Mesh], instances: &[Instance]) -> Self {
        let triangles = instances.iter().map(|i| meshes.get(i.mesh).map_or(0, |mesh| mesh.triangles.len()));
        // More than 2^32 are refused when the scene is flattened.
        let first = triangles.scan(0usize, |next, own| Some(std::mem::replace(next, *next + own) as u32)).collect();
        let mirrored = instances.iter().map(|instance| {
            let linear = Mat3::from_cols_array_2d(&instance.transform.columns);
            linear.determinant() < 0.0
        });
        Self { first, mirrored: mirrored.collect() }
    }

    /// The instance, and the triangle within its mesh; [`MISS`] twice for a miss.
    pub fn locate(&self, primitive: u32) -> (u32, u32) {
        if primitive == MISS {
            return (MISS, MISS);
        }
        // Of instances that begin alike all but the last are empty.
        match self.first.partition_point(|&first| first <= primitive).checked_sub(1) {
            Some(geometry) => (geometry as u32, primitive - self.first[geometry]),
            None => (0, primitive),
        }
    }

    /// The weights of vertices 1 and 2 as the mesh numbers them.
    pub fn barycentrics(&self, hit: &Hit) -> [f32; 2] {
        match self.mirrored.get(self.locate(hit.primitive).0 as usize) {
            Some(true) => [hit.v, hit.u],
            _ => [hit.u, hit.v],
        }
    }

    /// A triangle as the renderer traces it, in world space; nothing where there is none of this number. The meshes and
    /// instances are those that this is of.
    pub fn triangle(&self, meshes: &[Mesh], instances: &[Instance], primitive: u32) -> Option<Triangle> {
        let (geometry, own) = self.locate(primitive);
        let instance = instances.get(geometry as usize)?;
        let mesh = meshes.get(instance.mesh)?;
        let [a, b, c] = *mesh.triangles.get(own as usize)?;
        let [b, c] = if *self.mirrored.get(geometry as usize)? { [c, b] } else { [b, c] };
        let linear = Mat3::from_cols_array_2d(&instance.transform.columns);
        let shift = glam::Vec3::from(instance.transform.translation);
        let corner = |vertex: u32| {
            let local = glam::Vec3::from(*mesh.positions.get(vertex as usize)?);
            Some(Vec3::from((linear * local + shift).to_array()))
        };
        Some(Triangle::new(corner(a)?, corner(b)?, corner(c)?, primitive, 0))
    }

    /// Where a ray meets a triangle, with the bits that tracing gives; nothing where it does not.
    pub fn meet(&self, meshes: &[Mesh], instances: &[Instance], ray: &Ray, primitive: u32) -> Option<Hit> {
        self.triangle(meshes, instances, primitive)?.intersect(&RayShear::new(ray))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_instances_have_no_triangles() {
        let table = Geometries { first: vec![0, 0, 5, 5, 5, 7], mirrored: vec![false; 6] };
        for (primitive, place) in
            [(0, (1, 0)), (4, (1, 4)), (5, (4, 0)), (6, (4, 1)), (7, (5, 0)), (MISS, (MISS, MISS))]
        {
            assert_eq!(table.locate(primitive), place);
        }
        assert_eq!(Geometries::default().locate(9), (0, 9));
    }
}
