//! What of a triangle is in a cell.

use raywarp_core::triangle::Triangle;

use raywarp::accel::bounds::Bounds;
use raywarp::accel::clip::Polygon;

/// A triangle that comes near a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    /// Index of the triangle.
    pub triangle: u32,
    /// Around every point of the cell where a ray may be found to hit the triangle.
    pub bounds: Bounds,
}

/// On which side of a plane a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Below,
    Above,
    Both,
}

impl Part {
    /// The part's place relative to a plane through its cell. Its bounds have the margin already: what ends in the plane
    /// is not above.
    pub fn side(&self, axis: usize, plane: f32) -> Side {
        if self.bounds.high[axis] <= plane {
            Side::Below
        } else if self.bounds.low[axis] >= plane {
            Side::Above
        } else {
            Side::Both
        }
    }

    /// This part's share in each of two cells that the plane has made of one.
    pub fn cut(&self, triangle: &Triangle, cells: &[Bounds; 2]) -> [Option<Self>; 2] {
        let shares = cells.each_ref().map(|cell| share(triangle, cell));
        // Rounding at its worst: then it is as if it were not cut.
        let shares =
            if shares == [None; 2] { cells.each_ref().map(|cell| Some(clamped(&self.bounds, cell))) } else { shares };
        shares.map(|bounds| bounds.map(|bounds| Self { bounds, ..*self }))
    }
}

/// Around the points of a cell where a ray may be found to hit the triangle, which is a margin beside it at most. So it
/// is cut by the cell with the margin added, and not by the cell itself: a triangle just outside belongs to the cell too.
pub(super) fn share(triangle: &Triangle, cell: &Bounds) -> Option<Bounds> {
    let near = Bounds::padded(cell.low, cell.high, triangle.extent());
    let polygon = Polygon::of(triangle).within(&near)?;
    Some(clamped(&polygon.bounds(triangle), cell))
}

fn clamped(bounds: &Bounds, cell: &Bounds) -> Bounds {
    let clamp = |x: [f32; 3]| [0, 1, 2].map(|i| x[i].clamp(cell.low[i], cell.high[i]));
    Bounds { low: clamp(bounds.low), high: clamp(bounds.high) }
}
