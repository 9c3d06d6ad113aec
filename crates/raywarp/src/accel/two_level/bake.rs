//! Placements brought to world space for good.

use glam::{Mat3, Vec3};
use raywarp_core::triangle::Triangle;

use super::Placement;
use crate::scene::Transform;

/// The mesh's triangles where they are placed, named as in the scene.
///
/// Corners are rounded, and mirrored triangles turned round, as where a scene without instances is made of this one.
pub(super) fn bake<'a>(mesh: &'a [Triangle], placement: &Placement) -> impl Iterator<Item = Triangle> + 'a {
    let (linear, shift) = parts(&placement.transform);
    let mirrored = is_mirrored(&placement.transform);
    let Placement { first_primitive, flags, .. } = *placement;
    mesh.iter().map(move |triangle| {
        let [v0, v1, v2] = [triangle.v0, triangle.v1, triangle.v2]
            .map(|v| (linear * Vec3::from(v.to_array()) + shift).to_array().into());
        let [v1, v2] = if mirrored { [v2, v1] } else { [v1, v2] };
        Triangle::new(v0, v1, v2, first_primitive + triangle.primitive, flags.unwrap_or(triangle.flags))
    })
}

/// Whether the transform turns outside in, by the same arithmetic.
pub(super) fn is_mirrored(transform: &Transform) -> bool {
    parts(transform).0.determinant() < 0.0
}

fn parts(transform: &Transform) -> (Mat3, Vec3) {
    (Mat3::from_cols_array_2d(&transform.columns), Vec3::from(transform.translation))
}
