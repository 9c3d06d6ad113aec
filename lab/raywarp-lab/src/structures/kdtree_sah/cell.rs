//! A cell with the parts of triangles in it, and how it is cut in two (Wald and Havran 2006, section 4.3).

use rayon::prelude::*;
use raywarp_core::triangle::Triangle;

use super::event::{merged, Event};
use super::part::{Part, Side};
use super::plane::Plane;
use raywarp::accel::bounds::Bounds;
use raywarp::accel::is_finite;

/// Cells with more parts are worked on by several threads.
pub(super) const PARALLEL: usize = 4096;

/// A box, what is in it, and where that begins and ends.
pub(super) struct Cell {
    pub bounds: Bounds,
    pub parts: Vec<Part>,
    /// Of each axis, sorted.
    pub events: [Vec<Event>; 3],
}

/// Events of each axis.
type Events = [Vec<Event>; 3];

/// The new index of a part on a side where it is not.
const NOWHERE: u32 = u32::MAX;

impl Cell {
    /// Around all triangles that can be hit. This is the only time that all events are sorted.
    pub fn around(triangles: &[Triangle]) -> Self {
        let part = |(i, triangle)| Part { triangle: i as u32, bounds: Bounds::of(triangle) };
        let hittable = triangles.par_iter().enumerate().filter(|(_, triangle)| is_finite(triangle));
        let parts: Vec<Part> = hittable.map(part).collect();
        let bounds = parts.iter().map(|part| part.bounds).reduce(|a, b| a.join(&b)).unwrap_or(Bounds::POINT);
        let events = each_axis(parts.len(), |axis| {
            let mut events: Vec<_> = (0..).zip(&parts).flat_map(|(i, part)| events_of(i, part, axis)).collect();
            events.par_sort_unstable();
            events
        });
        Self { bounds, parts, events }
    }

    /// The cells on both sides of a plane. Events of parts on one side stay in their order; only parts that the plane
    /// cuts get new ones, which are sorted by themselves and merged into the others.
    pub fn cut(self, plane: &Plane, triangles: &[Triangle]) -> [Self; 2] {
        let cells = halves(&self.bounds, plane);
        let mut halves = Halves::of(&self.parts, plane, &cells, triangles);
        let Self { parts, events, .. } = self;
        let count = parts.len();
        drop(parts);
        let [below, above] = &halves.cut;
        let [x, y, z] = each_axis(count, |axis| splice(&events[axis], &halves.moved, [&below[axis], &above[axis]]));
        drop(events);
        let [[x0, x1], [y0, y1], [z0, z1]] = [x, y, z];
        let [low, high] = std::mem::take(&mut halves.parts);
        [
            Self { bounds: cells[0], parts: low, events: [x0, y0, z0] },
            Self { bounds: cells[1], parts: high, events: [x1, y1, z1] },
        ]
    }
}

/// The box below a plane and the one above.
fn halves(bounds: &Bounds, plane: &Plane) -> [Bounds; 2] {
    let (mut below, mut above) = (*bounds, *bounds);
    below.high[plane.axis] = plane.at;
    above.low[plane.axis] = plane.at;
    [below, above]
}

fn events_of(index: u32, part: &Part, axis: usize) -> [Event; 2] {
    Event::pair(index, part.bounds.low[axis], part.bounds.high[axis])
}

/// Where the parts of a cell go, below and above.
#[derive(Default)]
struct Halves {
    parts: [Vec<Part>; 2],
    /// For each part of the cell its new index on the side that it is on; nowhere for those that were cut.
    moved: Vec<[u32; 2]>,
    /// Sorted events of the pieces of those, on each side.
    cut: [Events; 2],
}

impl Halves {
    fn of(parts: &[Part], plane: &Plane, cells: &[Bounds; 2], triangles: &[Triangle]) -> Self {
        let mut halves = Self { moved: Vec::with_capacity(parts.len()), ..Self::default() };
        for (side, list) in halves.parts.iter_mut().enumerate() {
            list.reserve_exact(plane.counts[side] as usize);
        }
        for part in parts {
            let moved = match part.side(plane.axis, plane.at) {
                Side::Below => [halves.add(0, part), NOWHERE],
                Side::Above => [NOWHERE, halves.add(1, part)],
                Side::Both => {
                    halves.add_pieces(part.cut(&triangles[part.triangle as usize], cells));
                    [NOWHERE; 2]
                }
            };
            halves.moved.push(moved);
        }
        halves.cut.iter_mut().flatten().for_each(|events| events.sort_unstable());
        halves
    }

    fn add(&mut self, side: usize, part: &Part) -> u32 {
        self.parts[side].push(*part);
        self.parts[side].len() as u32 - 1
    }

    fn add_pieces(&mut self, pieces: [Option<Part>; 2]) {
        for (side, piece) in pieces.iter().enumerate() {
            let Some(piece) = piece else { continue };
            let index = self.add(side, piece);
            for (axis, events) in self.cut[side].iter_mut().enumerate() {
                events.extend(events_of(index, piece, axis));
            }
        }
    }
}

/// The events of an axis on both sides: those that stay, merged with new ones.
fn splice(events: &[Event], moved: &[[u32; 2]], new: [&[Event]; 2]) -> [Vec<Event>; 2] {
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for event in events {
        let [low, high] = moved[event.part()];
        if low != NOWHERE {
            below.push(event.of(low));
        } else if high != NOWHERE {
            above.push(event.of(high));
        }
    }
    [merged(below, new[0]), merged(above, new[1])]
}

/// Does something for each axis, for many parts at once.
pub(super) fn each_axis<T: Send>(parts: usize, work: impl Fn(usize) -> T + Sync) -> [T; 3] {
    if parts <= PARALLEL {
        return [0, 1, 2].map(work);
    }
    let (x, (y, z)) = rayon::join(|| work(0), || rayon::join(|| work(1), || work(2)));
    [x, y, z]
}
