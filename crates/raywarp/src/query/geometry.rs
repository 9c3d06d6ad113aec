//! The triangle of a hit, and where a ray meets it.

use glam::Mat3;

use raywarp_core::math::Vec3;
use raywarp_core::triangle::RayShear;

use crate::scene::{Instance, Mesh};
use crate::{Hit, Ray, Triangle};

/// A triangle in world space, by the instance and the primitive of a [`Hit`]; none where the scene has no such.
pub fn world_triangle(meshes: &[Mesh], instances: &[Instance], instance: u32, primitive: u32) -> Option<Triangle> {
    let placed = instances.get(instance as usize)?;
    let mesh = meshes.get(placed.mesh)?;
    let corners = mesh.triangles.get(primitive as usize)?;
    let linear = Mat3::from_cols_array_2d(&placed.transform.columns);
    let shift = glam::Vec3::from(placed.transform.translation);
    let corner = |vertex: u32| {
        let local = glam::Vec3::from(*mesh.positions.get(vertex as usize)?);
        Some(Vec3::from((linear * local + shift).to_array()))
    };
    let [a, b, c] = corners.map(corner);
    Some(Triangle { instance, ..Triangle::new(a?, b?, c?, primitive, 0) })
}

/// Where a ray meets a triangle of a scene, with the bits that tracing in world space gives; none where it does not.
pub fn intersect(meshes: &[Mesh], instances: &[Instance], ray: &Ray, [instance, primitive]: [u32; 2]) -> Option<Hit> {
    world_triangle(meshes, instances, instance, primitive)?.intersect(&RayShear::new(ray))
}
