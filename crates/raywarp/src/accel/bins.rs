//! Where to cut a range of triangles: the surface area heuristic over bins (Wald 2007).

use rayon::prelude::*;
use raywarp_core::triangle::Triangle;

use super::bounds::Bounds;
use super::TRIANGLE_COST;

/// Most bins an axis.
const BINS: usize = 32;

/// Items that one thread looks at before it hands over. Neither counts nor boxes depend on where ranges are cut.
const CHUNK: usize = 16_384;

/// Bins for a range: near the root a finer cut saves steps for every ray, near the leaves it only costs time.
fn bins_for(count: usize) -> usize {
    match count {
        0..32 => BINS / 4,
        32..256 => BINS / 2,
        _ => BINS,
    }
}

/// A triangle as the builder sees it: half a cache line.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Item {
    pub bounds: Bounds,
    pub index: u32,
}

impl Item {
    pub fn new(index: u32, triangle: &Triangle) -> Self {
        Self { bounds: Bounds::of(triangle), index }
    }
}

/// A range cut in two.
pub(super) struct Split {
    /// Items of the first part.
    pub middle: usize,
    /// Of each part.
    pub bounds: [Bounds; 2],
}

/// In the order given: only asked where no order is better than another.
pub(super) fn halve(items: &[Item]) -> Split {
    let middle = items.len().div_ceil(2);
    let (left, right) = items.split_at(middle);
    Split { middle, bounds: [around(left), around(right)] }
}

/// The box around all.
pub(super) fn around(items: &[Item]) -> Bounds {
    let around = |items: &[Item]| items.iter().fold(Bounds::EMPTY, |all, item| all.join(&item.bounds));
    in_chunks(items, Bounds::EMPTY, around, |a, b| a.join(&b))
}

/// Which bin a centre belongs to: evenly spaced between the outermost centres of a range.
#[derive(Clone, Copy)]
struct Grid {
    low: [f32; 3],
    scale: [f32; 3],
    bins: usize,
}

impl Grid {
    fn around(items: &[Item]) -> Self {
        let bins = bins_for(items.len());
        let centres = in_chunks(items, Bounds::EMPTY, centres, |a, b| a.join(&b));
        let scale = [0, 1, 2].map(|i| bins as f32 / (centres.high[i] - centres.low[i]));
        Self { low: centres.low, scale, bins }
    }

    fn sort(&self, items: &[Item]) -> Axes {
        let mut axes = [[Bin::EMPTY; BINS]; 3];
        for item in items {
            let centre = item.bounds.centre();
            for (axis, bins) in axes.iter_mut().enumerate() {
                let bin = &mut bins[self.bin(centre, axis)];
                *bin = bin.join(&Bin { bounds: item.bounds, count: 1 });
            }
        }
        axes
    }

    /// The conversion brings what rounding, overflow or NaN make of it back into range.
    #[inline(always)]
    fn bin(&self, centre: [f32; 3], axis: usize) -> usize {
        (((centre[axis] - self.low[axis]) * self.scale[axis]) as usize).min(self.bins - 1)
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, count: 0 };

    #[inline(always)]
    fn join(&self, other: &Self) -> Self {
        Self { bounds: self.bounds.join(&other.bounds), count: self.count + other.count }
    }

    /// Cost of a leaf of it, times the area of its box.
    fn cost(&self) -> f64 {
        TRIANGLE_COST * f64::from(self.count) * self.bounds.half_area()
    }
}

/// The triangles of a range by the position of their centres along each axis.
pub(super) struct Bins {
    grid: Grid,
    axes: Axes,
}

/// The bins of all axes.
type Axes = [[Bin; BINS]; 3];

/// What `one` makes of all items, by several threads where there are many.
fn in_chunks<T: Copy + Send + Sync>(
    items: &[Item],
    empty: T,
    one: impl Fn(&[Item]) -> T + Send + Sync,
    join: impl Fn(T, T) -> T + Send + Sync,
) -> T {
    if items.len() <= CHUNK {
        return one(items);
    }
    items.par_chunks(CHUNK).map(one).reduce(|| empty, join)
}

fn centres(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::EMPTY, |all, item| {
        let centre = item.bounds.centre();
        all.join(&Bounds { low: centre, high: centre })
    })
}

impl Bins {
    pub fn fill(items: &[Item]) -> Self {
        let grid = Grid::around(items);
        let empty = [[Bin::EMPTY; BINS]; 3];
        let join = |a: Axes, b: Axes| std::array::from_fn(|k| std::array::from_fn(|i| a[k][i].join(&b[k][i])));
        Self { grid, axes: in_chunks(items, empty, |items| grid.sort(items), join) }
    }

    /// The cheapest cut between two bins; none where all centres share a bin on every axis.
    pub fn best(&self) -> Option<Cut> {
        let cuts = (0..3).filter_map(|axis| self.best_on(axis));
        cuts.min_by(|a, b| a.children.total_cmp(&b.children))
    }

    /// Sweeps from the right to know every right part, then from the left to weigh each against its left part.
    fn best_on(&self, axis: usize) -> Option<Cut> {
        let bins = &self.axes[axis][..self.grid.bins];
        let mut right = [Bin::EMPTY; BINS + 1];
        for i in (0..bins.len()).rev() {
            right[i] = right[i + 1].join(&bins[i]);
        }
        let (mut left, mut best) = (Bin::EMPTY, None::<Cut>);
        for first in 1..bins.len() {
            left = left.join(&bins[first - 1]);
            let parts = [left, right[first]];
            if parts[0].count == 0 || parts[1].count == 0 || bins[first - 1].count == 0 {
                continue;
            }
            let children = parts[0].cost() + parts[1].cost();
            if best.as_ref().is_none_or(|best| children < best.children) {
                let bounds = parts.map(|part| part.bounds);
                best = Some(Cut { grid: self.grid, axis, first, bounds, middle: left.count as usize, children });
            }
        }
        best
    }
}

/// A place to cut: what lies in a bin before `first` goes left.
pub(super) struct Cut {
    grid: Grid,
    axis: usize,
    first: usize,
    middle: usize,
    bounds: [Bounds; 2],
    /// Expected cost of the two parts as leaves, times the area of the box around both.
    children: f64,
}

impl Cut {
    /// Triangles times half the area of their box, of both parts.
    pub fn children(&self) -> f64 {
        self.children
    }

    /// Half the area of what the boxes of both parts share.
    pub fn overlap(&self) -> f64 {
        let shared = self.bounds[0].meet(&self.bounds[1]);
        let is_box = (0..3).all(|i| shared.low[i] <= shared.high[i]);
        if is_box {
            shared.half_area()
        } else {
            0.0
        }
    }

    /// Reorders the range that the bins were filled from.
    pub fn apply(self, items: &mut [Item]) -> Split {
        let is_left = |item: &Item| self.grid.bin(item.bounds.centre(), self.axis) < self.first;
        let left = partition(items, is_left);
        debug_assert_eq!(left, self.middle);
        Split { middle: left, bounds: self.bounds }
    }
}

/// Brings the items of which something is true to the front, and gives their number.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool + Sync) -> usize {
    if items.len() > CHUNK {
        return partition_in_chunks(items, is_left);
    }
    let (mut left, mut right) = (0, items.len());
    loop {
        while left < right && is_left(&items[left]) {
            left += 1;
        }
        while left < right && !is_left(&items[right - 1]) {
            right -= 1;
        }
        if left >= right {
            return left;
        }
        items.swap(left, right - 1);
    }
}

/// The same by several threads: each sorts a chunk out, then all parts are put in a row.
fn partition_in_chunks(items: &mut [Item], is_left: impl Fn(&Item) -> bool + Sync) -> usize {
    let chunks = items.par_chunks(CHUNK).map(|chunk| chunk.iter().partition::<Vec<Item>, _>(|item| is_left(item)));
    let (left, right): (Vec<_>, Vec<_>) = chunks.collect::<Vec<_>>().into_iter().unzip();
    let mut rest = items;
    let mut copies = Vec::with_capacity(2 * left.len());
    for part in left.iter().chain(&right) {
        let (place, after) = rest.split_at_mut(part.len());
        copies.push((place, part));
        rest = after;
    }
    copies.into_par_iter().for_each(|(place, part)| place.copy_from_slice(part));
    left.iter().map(Vec::len).sum()
}
