//! An instance as traversal reads it: the way into the mesh, and a box in the world that no rounding leaves.
//!
//! The bounds are those of [`raywarp_core::traversal::two_level`], with its letters.

use glam::{DMat3, DVec3};
use raywarp_core::traversal::two_level::Instance;

use super::super::bounds::Bounds;
use crate::scene::Transform;

/// A rounding of single precision, relative.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// More than three of the smallest numbers, which a product that underflows is off by.
const SMALLEST: f64 = 4.0 * 1.401_298_464_324_817e-45;

/// Largest `K`: the bound grows with it, and with it the boxes of all instances. Rotations with one scale have at most 3;
/// what shears or squeezes a rotated mesh to a fraction has that fraction's inverse.
const MAX_CONDITION: f64 = 512.0;

/// Scales from 1 over this to this are inverted without a thought of underflow.
const MAX_SCALE: f64 = 1e18;

/// A transform turned round.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inverse {
    /// World to mesh, in single precision: what traversal computes with.
    pub rows: [[f32; 4]; 3],
    /// Exactly back: L.
    linear: DMat3,
    shift: DVec3,
    /// Entries of L, and of K.
    absolute: DMat3,
    spread: DMat3,
}

impl Inverse {
    /// None where single precision cannot hold it, or where rounding would move a ray too far: a flat transform, a scale
    /// out of range, NaN.
    pub fn of(transform: &Transform) -> Option<Self> {
        let forward = DMat3::from_cols_array_2d(&transform.columns.map(|column| column.map(f64::from)));
        let inverse = forward.inverse();
        let shift = -(inverse * DVec3::from(transform.translation.map(f64::from)));
        let [x, y, z, w] = [inverse.x_axis, inverse.y_axis, inverse.z_axis, shift].map(|v| v.as_vec3());
        Self::of_rows([0, 1, 2].map(|i| [x[i], y[i], z[i], w[i]]))
    }

    /// Of the way from the world to the mesh.
    pub fn of_rows(rows: [[f32; 4]; 3]) -> Option<Self> {
        let column = |i: usize| DVec3::from(rows.map(|row| f64::from(row[i])));
        let (rounded, shift) = (DMat3::from_cols(column(0), column(1), column(2)), column(3));
        let linear = rounded.inverse();
        let spread = absolute(linear) * absolute(rounded);
        let fits = |m: DMat3| {
            let largest = m.to_cols_array().into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            m.is_finite() && (1.0 / MAX_SCALE..MAX_SCALE).contains(&largest)
        };
        let fit = fits(rounded) && fits(linear) && shift.is_finite() && condition(spread) <= MAX_CONDITION;
        fit.then(|| Self { rows, linear, shift, absolute: absolute(linear), spread })
    }

    /// How far off a ray may be for each unit of its origin, as single precision rounds it up.
    pub fn slack(&self) -> f32 {
        if self.is_identity() {
            return 0.0;
        }
        ((8.0 * ROUNDING * condition(self.spread)) as f32).next_up()
    }

    /// Then nothing is rounded.
    fn is_identity(&self) -> bool {
        self.rows == Instance::IDENTITY.rows
    }

    /// Around every point of the world that a hit in one of these boxes of the mesh may have, for a ray from the origin;
    /// none where that is not finite.
    pub fn world_bounds(&self, boxes: &[Bounds]) -> Option<Bounds> {
        if self.is_identity() {
            return boxes.iter().copied().reduce(|a, b| a.join(&b));
        }
        let [low, high] =
            boxes.iter().map(|part| self.corners(part)).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
        let margin = self.spread * low.abs().max(high.abs()) + self.absolute * self.shift.abs();
        let margin = margin * (4.0 * ROUNDING) + self.absolute * DVec3::splat(SMALLEST);
        let bounds = Bounds {
            low: (low - margin).as_vec3().to_array().map(f32::next_down),
            high: (high + margin).as_vec3().to_array().map(f32::next_up),
        };
        let finite = bounds.low.into_iter().chain(bounds.high).all(f32::is_finite);
        finite.then_some(bounds)
    }

    /// Low and high corner of a box of the mesh in the world.
    fn corners(&self, part: &Bounds) -> [DVec3; 2] {
        let [low, high] = [part.low, part.high].map(|corner| DVec3::from(corner.map(f64::from)));
        let centre = self.linear * ((low + high) * 0.5 - self.shift);
        let half = self.absolute * ((high - low) * 0.5);
        [centre - half, centre + half]
    }
}

/// The largest sum of a row.
fn condition(m: DMat3) -> f64 {
    (0..3).map(|i| m.row(i).element_sum()).fold(0.0, f64::max)
}

fn absolute(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scaled(scale: [f32; 3]) -> Transform {
        let [x, y, z] = scale;
        Transform { columns: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], translation: [1.0, 2.0, 3.0] }
    }

    #[test]
    fn what_cannot_be_inverted_is_refused() {
        for scale in [[1.0, 0.0, 1.0], [f32::NAN, 1.0, 1.0], [f32::INFINITY, 1.0, 1.0], [1e-30, 1e-30, 1e-30]] {
            assert!(Inverse::of(&scaled(scale)).is_none(), "{scale:?}");
        }
        for scale in [[1.0, -2.0, 3.0], [1e-6, 1.0, 1e6], [1e-12; 3], [1e12; 3]] {
            assert!(Inverse::of(&scaled(scale)).is_some(), "{scale:?}");
        }
    }

    #[test]
    fn a_shear_that_rounding_cannot_undo_is_refused() {
        let mut sheared = scaled([1.0; 3]);
        sheared.columns[1][0] = 10.0;
        assert!(Inverse::of(&sheared).is_some());
        sheared.columns[1][0] = 1e4;
        assert!(Inverse::of(&sheared).is_none());
    }

    #[test]
    fn the_box_of_the_world_holds_the_box_of_the_mesh() {
        let unit = Bounds { low: [0.0; 3], high: [1.0; 3] };
        let inverse = Inverse::of(&scaled([2.0, -3.0, 0.5])).unwrap();
        let bounds = inverse.world_bounds(&[unit]).unwrap();
        assert!(bounds.contains(&Bounds { low: [1.0, -1.0, 3.0], high: [3.0, 2.0, 3.5] }));
        assert!(bounds.high[0] < 3.00001 && bounds.low[1] > -1.00001);
    }

    #[test]
    fn a_box_beyond_single_precision_is_refused() {
        let huge = Bounds { low: [-1e38; 3], high: [1e38; 3] };
        assert!(Inverse::of(&scaled([100.0; 3])).unwrap().world_bounds(&[huge]).is_none());
    }
}
