//! Boxes on the grid of a node: see `raywarp_lab_core::structures` for how rays meet them.

use raywarp::accel::bounds::Bounds;
use raywarp::accel::wide::Region;

/// 256 planes an axis, the first of them at `origin`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    pub origin: [f32; 3],
    /// Distance between planes, a normal positive number.
    pub spacing: [f32; 3],
}

/// First and last plane of a box on each axis.
pub(super) type Planes = [[u8; 2]; 3];

impl Grid {
    /// Ends at or barely beyond the box.
    pub fn around(bounds: &Bounds) -> Self {
        let spacing = [0, 1, 2].map(|i| {
            let extent = Difference::new(bounds.high[i], bounds.low[i]);
            let mut spacing = ((extent.rounded / 255.0) as f32).max(f32::MIN_POSITIVE);
            while !extent.is_within(255.0 * f64::from(spacing)) {
                spacing = spacing.next_up();
            }
            spacing
        });
        Self { origin: bounds.low, spacing }
    }

    /// With distances that are powers of two.
    pub fn of_powers(bounds: &Bounds) -> Self {
        let Self { origin, spacing } = Self::around(bounds);
        Self { origin, spacing: spacing.map(|x| f32::from_bits((x.to_bits() + 0x007f_ffff) & 0x7f80_0000)) }
    }

    /// The smallest box between planes that holds one within the grid.
    pub fn planes(&self, bounds: &Bounds) -> Planes {
        [0, 1, 2].map(|i| {
            let spacing = f64::from(self.spacing[i]);
            let low = Difference::new(bounds.low[i], self.origin[i]);
            let mut first = (low.rounded / spacing).clamp(0.0, 255.0).floor();
            while first > 0.0 && !low.is_beyond(first * spacing) {
                first -= 1.0;
            }
            let high = Difference::new(bounds.high[i], self.origin[i]);
            let mut last = (high.rounded / spacing).clamp(0.0, 255.0).ceil();
            while last < 255.0 && !high.is_within(last * spacing) {
                last += 1.0;
            }
            [first as u8, last as u8]
        })
    }

    /// What is between planes.
    pub fn region(&self, planes: Planes) -> Region {
        let at = |i: usize, plane: u8| f64::from(self.origin[i]) + f64::from(plane) * f64::from(self.spacing[i]);
        Region { low: [0, 1, 2].map(|i| at(i, planes[i][0])), high: [0, 1, 2].map(|i| at(i, planes[i][1])) }
    }

    /// Whether kernels may compute with it.
    pub fn is_sound(&self) -> bool {
        self.origin.iter().all(|x| x.is_finite()) && self.spacing.iter().all(|x| x.is_normal() && *x > 0.0)
    }
}

/// A difference of two coordinates, exactly: rounded, and what rounding took away (Knuth's sum of two).
struct Difference {
    rounded: f64,
    rest: f64,
}

impl Difference {
    fn new(a: f32, b: f32) -> Self {
        let (a, b) = (f64::from(a), -f64::from(b));
        let rounded = a + b;
        let of_b = rounded - a;
        Self { rounded, rest: (a - (rounded - of_b)) + (b - of_b) }
    }

    /// Whether it is at most `x`.
    fn is_within(&self, x: f64) -> bool {
        self.rounded < x || (self.rounded == x && self.rest <= 0.0)
    }

    /// Whether it is at least `x`.
    fn is_beyond(&self, x: f64) -> bool {
        self.rounded > x || (self.rounded == x && self.rest >= 0.0)
    }
}

/// Byte `INDEX` of four.
pub(super) fn set_byte(word: &mut u32, index: usize, byte: u8) {
    *word = *word & !(0xff << (8 * index)) | u32::from(byte) << (8 * index);
}

pub(super) fn byte(word: u32, index: usize) -> u8 {
    (word >> (8 * index)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![any::<f32>(), (-8i32..8).prop_map(|x| x as f32), -1.0f32..1.0, Just(f32::MAX), Just(-f32::MAX)]
            .prop_map(|x| if x.is_nan() { 0.0 } else { x.clamp(-f32::MAX, f32::MAX) })
    }

    fn bounds() -> impl Strategy<Value = Bounds> {
        prop::array::uniform3((coordinate(), coordinate()))
            .prop_map(|axes| Bounds { low: axes.map(|(a, b)| a.min(b)), high: axes.map(|(a, b)| a.max(b)) })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn planes_hold_what_they_stand_for(a in bounds(), b in bounds()) {
            let all = a.join(&b);
            for grid in [Grid::around(&all), Grid::of_powers(&all)] {
                prop_assert!(grid.is_sound(), "{grid:?}");
                for part in [a, b, all] {
                    let planes = grid.planes(&part);
                    prop_assert!(grid.region(planes).contains(&part), "{grid:?} {planes:?}");
                    // And no larger than they must be.
                    for (i, [first, last]) in planes.into_iter().enumerate() {
                        let [low, high] = [part.low[i], part.high[i]].map(|x| f64::from(x) - f64::from(grid.origin[i]));
                        let spacing = f64::from(grid.spacing[i]);
                        prop_assert!(f64::from(first) + 1.0 > low / spacing * (1.0 - 1e-12) || first == 255);
                        prop_assert!(f64::from(last) - 1.0 <= high / spacing * (1.0 + 1e-12));
                    }
                }
            }
        }
    }
}
