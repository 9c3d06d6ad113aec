//! Triangles cut along planes, and boxes around the pieces.
//!
//! In double precision: what its rounding moves is far less than the margin that a box leaves around its triangle.

use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;

/// Three corners, and one more for each of six planes; the rest is for cuts that rounding has made crooked.
const MOST: usize = 16;

/// A convex polygon; not empty.
#[derive(Clone, Copy, Debug)]
pub struct Polygon {
    corners: [[f64; 3]; MOST],
    count: usize,
}

impl Polygon {
    /// A whole triangle, with finite corners.
    pub fn of(triangle: &Triangle) -> Self {
        let mut polygon = Self::NONE;
        for corner in [triangle.v0, triangle.v1, triangle.v2] {
            polygon.add(corner.to_array().map(f64::from));
        }
        polygon
    }

    const NONE: Self = Self { corners: [[0.0; 3]; MOST], count: 0 };

    pub fn corners(&self) -> &[[f64; 3]] {
        &self.corners[..self.count.min(MOST)]
    }

    /// A point of it: the mean of the corners.
    pub fn middle(&self) -> [f64; 3] {
        let share = 1.0 / self.corners().len() as f64;
        [0, 1, 2].map(|i| self.corners().iter().map(|corner| corner[i] * share).sum())
    }

    fn add(&mut self, corner: [f64; 3]) {
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
        }
        self.count += 1;
    }

    /// The parts below and above a plane across an axis, each with its edge in the plane.
    ///
    /// Where there are too many corners to keep, both parts are the whole.
    pub fn split(&self, axis: usize, plane: f64) -> [Option<Self>; 2] {
        let (mut below, mut above) = (Self::NONE, Self::NONE);
        let mut from = self.corners[self.count - 1];
        for &to in self.corners() {
            if (from[axis] < plane && to[axis] > plane) || (from[axis] > plane && to[axis] < plane) {
                let crossing = crossing(from, to, axis, plane);
                below.add(crossing);
                above.add(crossing);
            }
            if to[axis] <= plane {
                below.add(to);
            }
            if to[axis] >= plane {
                above.add(to);
            }
            from = to;
        }
        [below, above].map(|part| match part.count {
            0 => None,
            count if count > MOST => Some(*self),
            _ => Some(part),
        })
    }

    /// The part in a box.
    pub fn within(&self, bounds: &Bounds) -> Option<Self> {
        self.between(&bounds.low.map(f64::from), &bounds.high.map(f64::from))
    }

    /// The part in a box from `low` to `high`.
    pub fn between(&self, low: &[f64; 3], high: &[f64; 3]) -> Option<Self> {
        let mut part = *self;
        for axis in 0..3 {
            // Most planes do not cut: those cost no copy.
            if !part.corners().iter().all(|corner| corner[axis] > low[axis]) {
                let [_, above] = part.split(axis, low[axis]);
                part = above?;
            }
            if !part.corners().iter().all(|corner| corner[axis] < high[axis]) {
                let [below, _] = part.split(axis, high[axis]);
                part = below?;
            }
        }
        Some(part)
    }

    /// The box around every point where a ray may be found to hit this part of `triangle`: as [`Bounds::of`] the whole.
    pub fn bounds(&self, triangle: &Triangle) -> Bounds {
        let first = self.corners[0];
        let (low, high) = self.corners().iter().fold((first, first), |(low, high), corner| {
            ([0, 1, 2].map(|i| f64::min(low[i], corner[i])), [0, 1, 2].map(|i| f64::max(high[i], corner[i])))
        });
        Bounds::padded(low.map(rounded_down), high.map(|x| -rounded_down(-x)), triangle.extent())
    }
}

/// Where an edge meets a plane that runs between its ends.
fn crossing(from: [f64; 3], to: [f64; 3], axis: usize, plane: f64) -> [f64; 3] {
    let share = (plane - from[axis]) / (to[axis] - from[axis]);
    let mut point = [0, 1, 2].map(|i| {
        let (low, high) = (from[i].min(to[i]), from[i].max(to[i]));
        (from[i] + (to[i] - from[i]) * share).clamp(low, high)
    });
    point[axis] = plane;
    point
}

/// The largest number of single precision that is not above.
fn rounded_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x {
        nearest.next_down()
    } else {
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywarp_core::math::vec3;

    fn triangle() -> Triangle {
        Triangle::new(vec3(0.0, 0.0, 0.0), vec3(4.0, 0.0, 0.0), vec3(0.0, 4.0, 1.0), 0, 0)
    }

    fn area(polygon: &Polygon) -> f64 {
        let c = polygon.corners();
        let cross = |a: [f64; 3], b: [f64; 3]| a[0] * b[1] - a[1] * b[0];
        (0..c.len()).map(|i| cross(c[i], c[(i + 1) % c.len()])).sum::<f64>().abs() / 2.0
    }

    #[test]
    fn parts_make_the_whole() {
        let whole = Polygon::of(&triangle());
        for (axis, plane) in [(0, 1.0), (1, 2.5), (2, 0.25)] {
            let [below, above] = whole.split(axis, plane).map(Option::unwrap);
            assert!((area(&below) + area(&above) - 8.0).abs() < 1e-12, "{axis}");
            assert!(below.corners().iter().all(|c| c[axis] <= plane));
            assert!(above.corners().iter().all(|c| c[axis] >= plane));
        }
    }

    #[test]
    fn a_plane_beside_leaves_nothing() {
        let whole = Polygon::of(&triangle());
        assert!(whole.split(0, -1.0)[0].is_none());
        assert!(whole.split(0, 5.0)[1].is_none());
        let aside = Bounds { low: [5.0; 3], high: [6.0; 3] };
        assert!(whole.within(&aside).is_none());
    }

    /// A part touches its plane where only a corner does.
    #[test]
    fn a_corner_in_the_plane_is_in_both_parts() {
        let [below, above] = Polygon::of(&triangle()).split(0, 4.0).map(Option::unwrap);
        assert_eq!(above.corners(), [[4.0, 0.0, 0.0]]);
        assert_eq!(area(&below), 8.0);
    }

    #[test]
    fn a_box_keeps_what_is_in_it() {
        let part = Polygon::of(&triangle()).within(&Bounds { low: [1.0, 1.0, -1.0], high: [2.0; 3] }).unwrap();
        assert_eq!(area(&part), 0.5 + 0.5);
        let bounds = part.bounds(&triangle());
        assert!(bounds.low[0] < 1.0 && bounds.high[0] > 2.0 && bounds.low[2] < 0.25 && bounds.high[1] > 2.0);
    }
}
