//! Whether the leaves that hold a triangle cover all of it: what a spatial split must not break.
//!
//! A ray that hits a triangle passes through a small cube around the point that it hits. If the boxes of the leaves,
//! taken in by half the size of such a cube's margin, cover every point of the triangle, one of them is entered.

use std::collections::HashMap;

use rayon::prelude::*;
use raywarp_core::triangle::Triangle;

use super::bounds::{Bounds, MARGIN};
use super::clip::Polygon;
use super::triangles::is_finite;

/// What identifies a triangle: all of it.
type Key = [u32; 12];

/// The boxes that a triangle must be found in, where none has room for the whole.
#[derive(Default)]
pub(super) struct Parts<'a> {
    parts: HashMap<Key, (&'a Triangle, Vec<Part>)>,
}

/// A leaf that holds a triangle.
#[derive(Clone, Copy)]
struct Part {
    /// What all boxes on the way to the leaf contain.
    bounds: Bounds,
    /// What the caller calls it.
    leaf: u32,
}

impl<'a> Parts<'a> {
    /// Takes note of a leaf whose box does not contain the whole triangle.
    pub fn add(&mut self, triangle: &'a Triangle, bounds: Bounds, leaf: u32) {
        self.parts.entry(key(triangle)).or_insert_with(|| (triangle, Vec::new())).1.push(Part { bounds, leaf });
    }

    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// The triangle was found in a leaf with room for the whole.
    pub fn found_whole(&mut self, triangle: &Triangle) {
        self.parts.remove(&key(triangle));
    }

    /// The least name of a leaf with a triangle of which something is in no leaf.
    pub fn uncovered(&self) -> Option<u32> {
        let bare = self.parts.par_iter().filter(|(_, (triangle, parts))| !covered(triangle, parts));
        bare.flat_map_iter(|(_, (_, parts))| parts.iter().map(|part| part.leaf)).min()
    }
}

fn key(triangle: &Triangle) -> Key {
    let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(|v| v.to_array().map(f32::to_bits));
    [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], triangle.primitive, triangle.flags, triangle.instance]
}

/// A box in double precision.
pub(super) struct Space {
    low: [f64; 3],
    high: [f64; 3],
}

impl Space {
    /// A box less a [`narrow`] margin on every side: a ray that passes within that of a point inside enters the box.
    fn inside(bounds: &Bounds, extent: f32) -> Self {
        Self {
            low: bounds.low.map(|x| f64::from(x) + narrow(x, extent)),
            high: bounds.high.map(|x| f64::from(x) - narrow(x, extent)),
        }
    }

    /// A box and a [`narrow`] margin on every side: rays in the box may hit what of a triangle is in here.
    pub fn around(bounds: &Bounds, extent: f32) -> Self {
        Self {
            low: bounds.low.map(|x| f64::from(x) - narrow(x, extent)),
            high: bounds.high.map(|x| f64::from(x) + narrow(x, extent)),
        }
    }

    /// Whether any of a triangle with finite corners is in it.
    pub fn meets(&self, triangle: &Triangle) -> bool {
        Polygon::of(triangle).between(&self.low, &self.high).is_some()
    }

    fn contains(&self, point: &[f64; 3]) -> bool {
        (0..3).all(|i| self.low[i] <= point[i] && point[i] <= self.high[i])
    }

    /// Adds the parts of a polygon outside, and says whether the rest is inside.
    fn cut_off(&self, polygon: Polygon, outside: &mut Vec<Polygon>) -> bool {
        let mut rest = polygon;
        for axis in 0..3 {
            let [low, high] = [self.low[axis], self.high[axis]];
            if rest.corners().iter().any(|corner| corner[axis] < low) {
                let [below, Some(above)] = rest.split(axis, low) else { return false };
                outside.extend(below);
                rest = above;
            }
            if rest.corners().iter().any(|corner| corner[axis] > high) {
                let [Some(below), above] = rest.split(axis, high) else { return false };
                outside.extend(above);
                rest = below;
            }
        }
        rest.corners().iter().all(|corner| self.contains(corner))
    }
}

/// Takes one box after the other out of the triangle: each contains the middle of a piece that is still bare. Where
/// there is none, that point is in no leaf.
fn covered(triangle: &Triangle, parts: &[Part]) -> bool {
    // Such triangles are never hit.
    if !is_finite(triangle) {
        return true;
    }
    let spaces: Vec<Space> = parts.iter().map(|part| Space::inside(&part.bounds, triangle.extent())).collect();
    let mut bare = vec![(Polygon::of(triangle), (0..spaces.len()).collect::<Vec<_>>())];
    while let Some((piece, near)) = bare.pop() {
        let middle = piece.middle();
        let Some(around) = near.iter().position(|&i| spaces[i].contains(&middle)) else { return false };
        let mut outside = Vec::new();
        if !spaces[near[around]].cut_off(piece, &mut outside) {
            return false;
        }
        // What is outside a box never needs it again: the list shrinks, and this ends.
        bare.extend(outside.into_iter().map(|piece| {
            let others = near.iter().filter(|&&i| i != near[around] && meets(&spaces[i], &piece));
            (piece, others.copied().collect())
        }));
    }
    true
}

/// Less than half of the margin that builders leave stays outside, and a quarter of a step of the coordinate at least.
fn narrow(x: f32, extent: f32) -> f64 {
    let margin = 0.5 * f64::from(MARGIN) * f64::from(extent);
    let step = 0.25 * (f64::from(x.abs().next_up()) - f64::from(x.abs()));
    margin.max(step)
}

fn meets(space: &Space, piece: &Polygon) -> bool {
    (0..3).all(|i| {
        piece.corners().iter().any(|corner| corner[i] >= space.low[i])
            && piece.corners().iter().any(|corner| corner[i] <= space.high[i])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use raywarp_core::math::vec3;

    fn triangle() -> Triangle {
        Triangle::new(vec3(0.0, 0.0, 0.0), vec3(8.0, 0.0, 0.0), vec3(0.0, 8.0, 8.0), 0, 0)
    }

    fn cells(count: usize, overlap: f32) -> Vec<Part> {
        let size = 8.0 / count as f32;
        let cell = |i: usize| {
            let (x, y) = ((i % count) as f32 * size, (i / count) as f32 * size);
            let low = [x - overlap, y - overlap, -1.0];
            Part { bounds: Bounds { low, high: [x + size + overlap, y + size + overlap, 9.0] }, leaf: i as u32 }
        };
        (0..count * count).map(cell).collect()
    }

    #[test]
    fn cells_that_overlap_cover_it() {
        for count in [1, 2, 3, 7, 40] {
            assert!(covered(&triangle(), &cells(count, 1e-4)), "{count}");
        }
    }

    /// Rays between cells that only touch could be rounded out of both.
    #[test]
    fn cells_that_touch_do_not() {
        assert!(covered(&triangle(), &cells(1, 1e-4)));
        assert!(!covered(&triangle(), &cells(2, 0.0)));
        assert!(!covered(&triangle(), &cells(7, -1e-4)));
    }

    #[test]
    fn a_cell_that_is_missing_is_missed() {
        for missing in 0..49 {
            let mut parts = cells(7, 1e-4);
            let (x, y) = (missing % 7, missing / 7);
            parts.remove(missing);
            assert_eq!(covered(&triangle(), &parts), x + y >= 7, "{missing}");
        }
    }
}
