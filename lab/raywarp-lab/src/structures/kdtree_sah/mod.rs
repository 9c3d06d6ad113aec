//! Builds a k-d tree by the surface area heuristic in O(n log n) (Wald and Havran 2006, "On building fast kd-trees for ray
//! tracing, and on doing that in O(N log N)").
//!
//! A cell is cut where the heuristic expects the least work, among all planes where a part of a triangle begins or ends.
//! A part is what of a triangle is in the cell (a "perfect split"), so a triangle is not where only its box is. Begins
//! and ends are sorted once; a cut hands them down in their order, and sorts those of the parts that it goes through. A
//! cell becomes a leaf where the best cut costs more than it saves.
//!
//! Parts keep the margin of a hit (see `part::share`). It gives width to what is flat: Wald and Havran try a
//! triangle that lies in the plane on either side, here those are two planes, a margin below the triangle and a margin
//! above. No plane goes through it.

mod cell;
mod event;
mod part;
mod plane;

use std::time::Instant;

use raywarp_core::triangle::Triangle;

use self::cell::{Cell, PARALLEL};
use self::plane::Plane;
use raywarp::accel::kdtree::KdTree;
use raywarp::accel::kdtree_arrays::{deepest, grow, Arrays, Cut, Cutter, COPIES, MAX_TRIANGLES};
use raywarp::accel::BuildError;

/// Builds the tree. The result depends on the triangles and their order alone, not on the number of threads. Triangles
/// with coordinates that are not finite are in no leaf.
///
/// # Errors
/// More triangles than links to their copies can tell apart.
pub fn build(triangles: Vec<Triangle>) -> Result<KdTree, BuildError> {
    let start = Instant::now();
    BuildError::check(triangles.len(), MAX_TRIANGLES)?;
    let cell = Cell::around(&triangles);
    let corners = cell.bounds.corners();
    let builder = Builder { triangles: &triangles, deepest: deepest(triangles.len()) };
    let mut tree = Arrays::with_root();
    grow(&builder, cell, COPIES * triangles.len(), 0, 0, &mut tree);
    Ok(KdTree::grown(tree, triangles, corners, start))
}

struct Builder<'a> {
    triangles: &'a [Triangle],
    deepest: usize,
}

impl Cutter for Builder<'_> {
    type Cell = Cell;

    const PARALLEL: usize = PARALLEL;

    fn triangles(cell: &Cell) -> impl ExactSizeIterator<Item = u32> {
        cell.parts.iter().map(|part| part.triangle)
    }

    fn cut(&self, cell: Cell, budget: usize, depth: usize) -> Result<Cut<Cell>, Cell> {
        let Some(plane) = self.plane(&cell, budget, depth) else { return Err(cell) };
        let [below, above] = cell.cut(&plane, self.triangles);
        Ok(Cut { axis: plane.axis, plane: plane.at, below, above })
    }
}

impl Builder<'_> {
    /// Where to cut a cell; none where that is not worth its cost, or not allowed.
    fn plane(&self, cell: &Cell, budget: usize, depth: usize) -> Option<Plane> {
        let plane = (depth < self.deepest).then(|| plane::best(cell)).flatten()?;
        let copies = plane.counts.iter().map(|&count| count as usize).sum::<usize>();
        (plane.cost < cell.parts.len() as f64 && copies <= budget).then_some(plane)
    }
}

#[cfg(test)]
mod tests;
