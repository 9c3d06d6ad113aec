//! Which triangles can be hit at all.

use crate::math::Vec3;
use crate::triangle::Triangle;

/// Whether no coordinate is NaN or infinite.
#[inline(always)]
pub fn is_finite(triangle: &Triangle) -> bool {
    let finite = |v: Vec3| v.x.is_finite() & v.y.is_finite() & v.z.is_finite();
    finite(triangle.v0) & finite(triangle.v1) & finite(triangle.v2)
}

/// Whether the corners of a finite triangle span an area.
///
/// It is taken in double precision from the corners as they are, where it neither overflows nor vanishes, and must be
/// exactly zero for the triangle to have none.
#[inline(always)]
pub fn has_area(triangle: &Triangle) -> bool {
    let (a, b) = (difference(triangle.v1, triangle.v0), difference(triangle.v2, triangle.v0));
    (a[1] * b[2] != a[2] * b[1]) | (a[2] * b[0] != a[0] * b[2]) | (a[0] * b[1] != a[1] * b[0])
}

#[inline(always)]
fn difference(a: Vec3, b: Vec3) -> [f64; 3] {
    [a.x as f64 - b.x as f64, a.y as f64 - b.y as f64, a.z as f64 - b.z as f64]
}
