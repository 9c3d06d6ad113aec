//! Where to cut space instead of a list: spatial splits (Stich, Friedrich and Dietrich 2009).
//!
//! A plane through the box of a range sends triangles on either side there, and those that it meets to both sides, each
//! part with a box of its own, unless one side alone takes the whole for less (reference unsplitting).

use rayon::prelude::*;
use raywarp_core::triangle::Triangle;

use super::bins::Item;
use super::bounds::Bounds;
use super::clip::Polygon;
use super::triangles::is_finite;
use super::TRIANGLE_COST;

/// Most planes an axis, and one more.
const BINS: usize = 32;

/// Items that one thread looks at before it hands over.
const CHUNK: usize = 4096;

/// What begins, ends and lies between two planes.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    first: u32,
    last: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, first: 0, last: 0 };

    fn add(&mut self, bounds: &Bounds) {
        self.bounds = self.bounds.join(bounds);
    }

    fn join(&self, other: &Self) -> Self {
        Self { bounds: self.bounds.join(&other.bounds), first: self.first + other.first, last: self.last + other.last }
    }
}

/// Evenly spaced planes.
#[derive(Clone, Copy)]
struct Planes {
    low: f32,
    step: f32,
    bins: usize,
}

impl Planes {
    /// Nothing for a box without room between two planes, or too large to count in.
    fn across(bounds: &Bounds, axis: usize, bins: usize) -> Option<Self> {
        let (low, high) = (bounds.low[axis], bounds.high[axis]);
        let step = (high - low) / bins as f32;
        (step.is_finite() && low + step > low && high - step < high).then_some(Self { low, step, bins })
    }

    /// Below bin `i`, for `i` from 1 on.
    fn plane(&self, i: usize) -> f32 {
        self.low + self.step * i as f32
    }

    fn bin(&self, x: f32) -> usize {
        (((x - self.low) / self.step) as usize).min(self.bins - 1)
    }
}

/// A place to cut.
#[derive(Clone, Copy)]
pub(super) struct SpatialCut {
    axis: usize,
    plane: f32,
    sides: [Side; 2],
    /// Triangles times half the area of their box, of both sides.
    pub cost: f64,
}

/// Before any triangle is kept whole.
#[derive(Clone, Copy)]
struct Side {
    bounds: Bounds,
    count: u32,
}

impl Side {
    fn cost(&self) -> f64 {
        TRIANGLE_COST * f64::from(self.count) * self.bounds.half_area()
    }
}

/// Where an item goes.
enum Place {
    Below(Item),
    Above(Item),
    Both(Item, Item),
}

/// The cheapest plane through the box around `items`.
pub(super) fn best(triangles: &[Triangle], items: &[Item], around: &Bounds) -> Option<SpatialCut> {
    let count = if items.len() < 256 { BINS / 2 } else { BINS };
    let planes = [0, 1, 2].map(|axis| Planes::across(around, axis, count));
    let bins = fill(triangles, items, &planes);
    let cuts = (0..3).filter_map(|axis| best_on(axis, planes[axis].as_ref()?, &bins[axis]));
    cuts.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// The bins of all axes.
type Bins = [[Bin; BINS]; 3];

fn fill(triangles: &[Triangle], items: &[Item], planes: &[Option<Planes>; 3]) -> Bins {
    let fill = |items: &[Item]| {
        let mut bins = [[Bin::EMPTY; BINS]; 3];
        items.iter().for_each(|item| chop(triangles, item, planes, &mut bins));
        bins
    };
    if items.len() <= CHUNK {
        return fill(items);
    }
    let join = |a: Bins, b: Bins| std::array::from_fn(|axis| std::array::from_fn(|i| a[axis][i].join(&b[axis][i])));
    items.par_chunks(CHUNK).map(fill).reduce(|| [[Bin::EMPTY; BINS]; 3], join)
}

/// Adds an item to every bin that it is in, with the box of its part there. Roughly: this only weighs planes.
fn chop(triangles: &[Triangle], item: &Item, planes: &[Option<Planes>; 3], bins: &mut Bins) {
    let mut polygon = None;
    for (axis, bins) in bins.iter_mut().enumerate() {
        let Some(planes) = &planes[axis] else { continue };
        let (first, last) = (planes.bin(item.bounds.low[axis]), planes.bin(item.bounds.high[axis]));
        bins[first].first += 1;
        bins[last].last += 1;
        if first == last {
            bins[first].add(&item.bounds);
            continue;
        }
        match polygon.get_or_insert_with(|| part(&triangles[item.index as usize], &item.bounds)) {
            Some(polygon) => chop_on(axis, planes, polygon, bins),
            None => bins[first..=last].iter_mut().for_each(|bin| bin.add(&item.bounds)),
        }
    }
}

/// Corners go to their bins, and the points where edges cross planes to the bins on both sides.
fn chop_on(axis: usize, planes: &Planes, polygon: &Polygon, bins: &mut [Bin; BINS]) {
    let mut from = polygon.corners()[polygon.corners().len() - 1].map(|x| x as f32);
    for to in polygon.corners() {
        let to = to.map(|x| x as f32);
        let (low, high) = if from[axis] <= to[axis] { (from, to) } else { (to, from) };
        let (first, last) = (planes.bin(low[axis]), planes.bin(high[axis]));
        bins[planes.bin(to[axis])].add(&Bounds { low: to, high: to });
        let slope = 1.0 / (high[axis] - low[axis]);
        for i in first..last {
            let plane = planes.plane(i + 1);
            let share = ((plane - low[axis]) * slope).clamp(0.0, 1.0);
            let mut point = [0, 1, 2].map(|k| low[k] + (high[k] - low[k]) * share);
            point[axis] = plane;
            let point = Bounds { low: point, high: point };
            bins[i].add(&point);
            bins[i + 1].add(&point);
        }
        from = to;
    }
}

/// What of a triangle is in a box; nothing where the triangle cannot be cut.
fn part(triangle: &Triangle, bounds: &Bounds) -> Option<Polygon> {
    if !is_finite(triangle) {
        return None;
    }
    let whole = Polygon::of(triangle);
    if *bounds == Bounds::of(triangle) {
        Some(whole)
    } else {
        whole.within(bounds)
    }
}

/// Sweeps as for an object split: what begins before a plane is below it, what ends behind it above.
fn best_on(axis: usize, planes: &Planes, bins: &[Bin; BINS]) -> Option<SpatialCut> {
    let bins = &bins[..planes.bins];
    let mut above = [Bin::EMPTY; BINS + 1];
    for i in (0..bins.len()).rev() {
        above[i] = above[i + 1].join(&bins[i]);
    }
    let (mut below, mut best) = (Bin::EMPTY, None::<SpatialCut>);
    for first in 1..bins.len() {
        below = below.join(&bins[first - 1]);
        let sides = [
            Side { bounds: below.bounds, count: below.first },
            Side { bounds: above[first].bounds, count: above[first].last },
        ];
        let cost = sides[0].cost() + sides[1].cost();
        if sides.iter().all(|side| side.count > 0) && best.as_ref().is_none_or(|best| cost < best.cost) {
            best = Some(SpatialCut { axis, plane: planes.plane(first), sides, cost });
        }
    }
    best
}

impl SpatialCut {
    /// The items of both sides, in their order; nothing where one side is empty or both together hold more than `most`.
    pub fn apply(&self, triangles: &[Triangle], items: &[Item], most: usize) -> Option<[Vec<Item>; 2]> {
        let share = |items: &[Item]| {
            let (mut below, mut above) = (Vec::with_capacity(items.len()), Vec::with_capacity(items.len() / 2));
            for item in items {
                match self.place(triangles, item) {
                    Place::Below(item) => below.push(item),
                    Place::Above(item) => above.push(item),
                    Place::Both(low, high) => {
                        below.push(low);
                        above.push(high);
                    }
                }
            }
            [below, above]
        };
        let parts = if items.len() <= CHUNK {
            share(items)
        } else {
            let chunks: Vec<_> = items.par_chunks(CHUNK).map(share).collect();
            [0, 1].map(|side| chunks.iter().flat_map(|chunk| &chunk[side]).copied().collect::<Vec<_>>())
        };
        let [below, above] = parts.each_ref().map(Vec::len);
        (below > 0 && above > 0 && below + above <= most).then_some(parts)
    }

    fn place(&self, triangles: &[Triangle], item: &Item) -> Place {
        if item.bounds.high[self.axis] <= self.plane {
            return Place::Below(*item);
        }
        if item.bounds.low[self.axis] >= self.plane {
            return Place::Above(*item);
        }
        let triangle = &triangles[item.index as usize];
        let Some(polygon) = part(triangle, &item.bounds) else { return self.whole(item).1 };
        let cut = |polygon: &Polygon| Item { bounds: polygon.bounds(triangle).meet(&item.bounds), ..*item };
        match polygon.split(self.axis, f64::from(self.plane)) {
            [Some(below), Some(above)] => self.cheaper(item, cut(&below), cut(&above)),
            [Some(below), None] => Place::Below(cut(&below)),
            [_, Some(above)] => Place::Above(cut(&above)),
            [None, None] => self.whole(item).1,
        }
    }

    /// Cut, or kept whole on the side that grows less by it.
    fn cheaper(&self, item: &Item, below: Item, above: Item) -> Place {
        let (cost, whole) = self.whole(item);
        if cost < self.cost {
            whole
        } else {
            Place::Both(below, above)
        }
    }

    /// The cost of both sides if an item that the plane meets is kept whole, and on which side it then is.
    fn whole(&self, item: &Item) -> (f64, Place) {
        let [below, above] = self.sides;
        let with = |side: &Side| Side { bounds: side.bounds.join(&item.bounds), ..*side }.cost();
        let without = |side: &Side| Side { count: side.count.saturating_sub(1), ..*side }.cost();
        let costs = [with(&below) + without(&above), without(&below) + with(&above)];
        if costs[0] <= costs[1] {
            (costs[0], Place::Below(*item))
        } else {
            (costs[1], Place::Above(*item))
        }
    }
}
