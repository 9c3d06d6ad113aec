//! Placements brought to world space for good.

use glam::{Mat3, Vec3};
use raywarp_core::triangle::Triangle;

use super::Placement;
use crate::scene::Transform;

/// The mesh's triangles where they are placed, as those of the instance. Corners are rounded as where a scene without
/// instances is made of this one.
pub(super) fn bake<'a>(mesh: &'a [Triangle], placement: &Placement) -> impl Iterator<Item = Triangle> + 'a {
    let (linear, shift) = parts(&placement.transform);
    let Placement { instance, flags, .. } = *placement;
    mesh.iter().map(move |triangle| {
        let [v0, v1, v2] = [triangle.v0, triangle.v1, triangle.v2]
            .map(|v| (linear * Vec3::from(v.to_array()) + shift).to_array().into());
        let flags = flags.unwrap_or(triangle.flags);
        Triangle { instance, ..Triangle::new(v0, v1, v2, triangle.primitive, flags) }
    })
}

fn parts(transform: &Transform) -> (Mat3, Vec3) {
    (Mat3::from_cols_array_2d(&transform.columns), Vec3::from(transform.translation))
}
