//! The best plane to cut a cell: the surface area heuristic at every begin and end of a part (Wald and Havran 2006,
//! algorithm 4).

use super::cell::{each_axis, Cell};
use super::event::Event;
use raywarp::accel::bounds::Bounds;

/// Cost of a step to an inner node, in units of a triangle's test: as Wald and Havran have it.
const TRAVERSAL: f64 = 15.0 / 20.0;

/// What of its cost a plane has that cuts off empty space.
const EMPTY: f64 = 0.8;

/// A plane through a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub axis: usize,
    pub at: f32,
    /// Parts that are below, and that are above; those on both sides are in both.
    pub counts: [u32; 2],
    /// Expected cost of a ray through the cell, in units of a triangle's test.
    pub cost: f64,
}

/// The cheapest of all; of equal ones the first. None where no part begins or ends within the cell.
pub(super) fn best(cell: &Cell) -> Option<Plane> {
    let planes = each_axis(cell.parts.len(), |axis| best_on(axis, &cell.bounds, &cell.events[axis], cell.parts.len()));
    planes.into_iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Sweeps a plane over the cell.
fn best_on(axis: usize, bounds: &Bounds, events: &[Event], count: usize) -> Option<Plane> {
    let odds = Odds::new(axis, bounds);
    let mut counts = [0, count as u32];
    let mut best = None::<Plane>;
    for here in events.chunk_by(|a, b| a.meets(*b)) {
        let begin = here.iter().filter(|event| event.begins()).count() as u32;
        let at = here[0].at();
        counts[1] -= here.len() as u32 - begin;
        if bounds.low[axis] < at && at < bounds.high[axis] {
            let cost = odds.cost(at, counts);
            if best.is_none_or(|best| cost < best.cost) {
                best = Some(Plane { axis, at, counts, cost });
            }
        }
        counts[0] += begin;
    }
    best
}

/// How likely a ray through a cell meets the part of it on either side of a plane: by their surfaces.
struct Odds {
    ends: [f64; 2],
    /// Half the surface of a piece of no width, and what it grows by per unit of width; in units of the cell's.
    flat: f64,
    growth: f64,
}

impl Odds {
    fn new(axis: usize, bounds: &Bounds) -> Self {
        let size = [0, 1, 2].map(|i| f64::from(bounds.high[i]) - f64::from(bounds.low[i]));
        let [a, b] = [size[(axis + 1) % 3], size[(axis + 2) % 3]];
        let whole = bounds.half_area();
        let ends = [bounds.low[axis], bounds.high[axis]].map(f64::from);
        Self { ends, flat: a * b / whole, growth: (a + b) / whole }
    }

    fn cost(&self, at: f32, counts: [u32; 2]) -> f64 {
        let at = f64::from(at);
        let odds = [at - self.ends[0], self.ends[1] - at].map(|width| self.flat + self.growth * width);
        let cost = TRAVERSAL + odds[0] * f64::from(counts[0]) + odds[1] * f64::from(counts[1]);
        if counts.contains(&0) {
            EMPTY * cost
        } else {
            cost
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The least cost of any plane that a part begins or ends at, by going through all of them and all parts.
    pub(in super::super) fn least_cost(cell: &Cell) -> Option<f64> {
        let ends = |axis| cell.parts.iter().flat_map(move |part| [part.bounds.low[axis], part.bounds.high[axis]]);
        let planes = (0..3).flat_map(|axis| ends(axis).map(move |at| (axis, at)));
        planes.filter_map(|(axis, at)| slow_cost(cell, axis, at)).min_by(f64::total_cmp)
    }

    /// By the definition. Nothing for a plane that does not cut the cell.
    pub(in super::super) fn slow_cost(cell: &Cell, axis: usize, at: f32) -> Option<f64> {
        let Bounds { low, high } = cell.bounds;
        let (mut below, mut above) = (cell.bounds, cell.bounds);
        (below.high[axis], above.low[axis]) = (at, at);
        let lower = cell.parts.iter().filter(|part| part.bounds.low[axis] < at).count() as f64;
        let upper = cell.parts.iter().filter(|part| part.bounds.high[axis] > at).count() as f64;
        let tests = lower * below.area_within(&cell.bounds) + upper * above.area_within(&cell.bounds);
        let bonus = if lower == 0.0 || upper == 0.0 { 0.8 } else { 1.0 };
        (low[axis] < at && at < high[axis]).then_some(bonus * (0.75 + tests))
    }
}
