//! Which triangles can be hit at all.

use raywarp_core::build::hittable::has_area;
pub use raywarp_core::build::hittable::is_finite;
use raywarp_core::triangle::Triangle;

/// Triangles that no ray can hit, by the reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Dropped {
    /// With a coordinate that is NaN or infinite.
    pub not_finite: usize,
    /// Corners that coincide or lie on a line.
    pub without_area: usize,
}

/// Triangles that cannot be hit, where that is not to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "triangles without area or with coordinates that are not finite, {0} of them, would be dropped (an error, as reading \
     is strict)"
)]
pub struct Unhittable(pub usize);

impl Dropped {
    /// All of them.
    pub fn count(&self) -> usize {
        self.not_finite + self.without_area
    }

    /// Whether to go on without them.
    ///
    /// # Errors
    /// [`Unhittable`] if there are any and reading is `strict`: they are as every other warning.
    pub fn allow(&self, strict: bool) -> Result<(), Unhittable> {
        if strict && self.count() > 0 {
            return Err(Unhittable(self.count()));
        }
        Ok(())
    }
}

/// Keeps the triangles that a ray can hit, in their order, and counts the others: those without [an
/// area](raywarp_core::build::hittable::has_area) and those that are not finite.
pub fn drop_degenerate(mut triangles: Vec<Triangle>) -> (Vec<Triangle>, Dropped) {
    let mut dropped = Dropped::default();
    triangles.retain(|triangle| {
        let finite = is_finite(triangle);
        let keep = finite && has_area(triangle);
        dropped.not_finite += !finite as usize;
        dropped.without_area += (finite && !keep) as usize;
        keep
    });
    (triangles, dropped)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywarp_core::math::vec3;

    fn triangle(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> Triangle {
        Triangle::new(a.into(), b.into(), c.into(), 0, 0)
    }

    #[test]
    fn each_reason_is_counted() {
        let good = triangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let list = vec![
            triangle([f32::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            good,
            triangle([0.0; 3], [1.0, f32::INFINITY, 0.0], [0.0, 1.0, 0.0]),
            triangle([1.0; 3], [1.0; 3], [2.0, 3.0, 4.0]),
            triangle([0.0; 3], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0]),
        ];
        let (kept, dropped) = drop_degenerate(list);
        assert_eq!(kept, [good]);
        assert_eq!(dropped, Dropped { not_finite: 2, without_area: 2 });
    }

    #[test]
    fn extreme_sizes_have_an_area() {
        for size in [1e-40, 1e-30, 1e30, 1e38] {
            let corner = triangle([0.0; 3], vec3(size, 0.0, 0.0).to_array(), vec3(0.0, size, 0.0).to_array());
            assert_eq!(drop_degenerate(vec![corner]).1, Dropped::default(), "{size}");
        }
    }
}
