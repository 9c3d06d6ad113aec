//! Builds a binary [`Tree`] from the top by the surface area heuristic, down to one triangle a leaf: with bins (Wald
//! 2007), and where boxes would overlap with spatial splits (Stich, Friedrich and Dietrich 2009).

use rayon::prelude::*;
use raywarp_core::triangle::Triangle;

use super::binary::{Link, Node, Tree, ROOT};
use super::bins::{around, halve, Bins, Item, Split};
use super::bounds::Bounds;
use super::spatial;

/// Ranges longer than this are built by two threads.
const PARALLEL: usize = 1024;

/// Levels of the tree before it is made to fit traversal's stack; recursion here must end as well.
const LEVELS: usize = 128;

/// A cut by bins is only replaced by a spatial one where its two boxes share at least this part of the root's area.
const OVERLAP: f64 = 1e-5;

/// Part of the cost of the best cut by bins that a spatial one may have. Copies cost more than the heuristic says: they
/// leave less to gain for the reinsertion that follows.
const WORTH: f64 = 0.9;

/// Builds the tree of at least one triangle. Spatial splits add at most `copies` references a triangle.
pub(super) fn build(triangles: &[Triangle], copies: f64) -> Tree {
    let items: Vec<Item> = triangles.par_iter().enumerate().map(|(i, t)| Item::new(i as u32, t)).collect();
    let spare = (triangles.len() as f64 * copies) as usize;
    let mut nodes = vec![Node::NOTHING; 2 * (items.len() + spare)];
    let whole = items.par_iter().map(|item| item.bounds).reduce(|| Bounds::EMPTY, |a, b| a.join(&b));
    let builder = Builder { triangles, overlap: OVERLAP * whole.half_area() };
    let (root, rest) = nodes.split_at_mut(2);
    root[0] = builder.divide(items, spare, LEVELS, Room { owner: ROOT, first: 2, nodes: rest });
    Tree::new(nodes)
}

/// Where the descendants of a node go.
struct Room<'a> {
    owner: u32,
    /// Index of the first of `nodes`.
    first: u32,
    nodes: &'a mut [Node],
}

impl<'a> Room<'a> {
    /// Places for the two children, and room for the descendants of each, of which the left one has `left` leaves at
    /// most.
    fn share(self, left: usize) -> (&'a mut [Node], [Room<'a>; 2]) {
        let (pair, rest) = self.nodes.split_at_mut(2);
        let middle = 2 * (left - 1);
        let (below_left, below_right) = rest.split_at_mut(middle);
        let first = self.first + 2;
        let left = Room { owner: self.first, first, nodes: below_left };
        let right = Room { owner: self.first + 1, first: first + middle as u32, nodes: below_right };
        (pair, [left, right])
    }

    /// An inner node over the two children that `grow` makes of each part.
    fn pair<T: Send>(self, parts: [T; 2], left: usize, apart: bool, grow: impl Fn(T, Room) -> Node + Sync) -> Node {
        let (owner, first) = (self.owner, self.first);
        let (pair, [room_left, room_right]) = self.share(left);
        let [part_left, part_right] = parts;
        let children = if apart {
            rayon::join(|| grow(part_left, room_left), || grow(part_right, room_right))
        } else {
            (grow(part_left, room_left), grow(part_right, room_right))
        };
        pair[0] = Node { parent: owner, ..children.0 };
        pair[1] = Node { parent: owner, ..children.1 };
        let bounds = pair[0].bounds.join(&pair[1].bounds);
        Node { bounds, link: Link::pair(first), parent: ROOT }
    }
}

struct Builder<'a> {
    triangles: &'a [Triangle],
    /// Half the area that two boxes must share for a spatial split.
    overlap: f64,
}

impl Builder<'_> {
    /// The node of some items, with descendants, where up to `spare` copies may be made; its parent is not yet known.
    fn divide(&self, mut items: Vec<Item>, spare: usize, levels: usize, room: Room) -> Node {
        let count = items.len();
        if spare == 0 || count <= 2 {
            return grow(&mut items, levels, room);
        }
        let best = can_choose(count + 1, levels).then(|| Bins::fill(&items).best()).flatten();
        let parts = self.cut_space(&items, best.as_ref().map(|cut| (cut.overlap(), cut.children())), spare, levels);
        let [left, right] = parts.unwrap_or_else(|| {
            let split = match best {
                Some(best) => best.apply(&mut items),
                None => halve(&items),
            };
            let right = items.split_off(split.middle);
            [items, right]
        });
        let spare = spare + count - left.len() - right.len();
        let weights = [&left, &right].map(|items| weight(items));
        let share = (spare as f64 * weights[0] / (weights[0] + weights[1])) as usize;
        let spares = [share.min(spare), spare - share.min(spare)];
        let most = left.len() + spares[0];
        let parts = [(left, spares[0]), (right, spares[1])];
        room.pair(parts, most, count > PARALLEL, |(items, spare), room| self.divide(items, spare, levels - 1, room))
    }

    /// The two sides of the best plane, if that is better than the best cut of the list.
    fn cut_space(
        &self,
        items: &[Item],
        list: Option<(f64, f64)>,
        spare: usize,
        levels: usize,
    ) -> Option<[Vec<Item>; 2]> {
        let (overlap, cost) = list.unwrap_or((f64::INFINITY, f64::INFINITY));
        if overlap <= self.overlap || !can_choose(items.len() + 1, levels) {
            return None;
        }
        let cut = spatial::best(self.triangles, items, &around(items)).filter(|cut| cut.cost < cost * WORTH)?;
        cut.apply(self.triangles, items, items.len() + spare)
    }
}

/// How much a range should get of the copies that are left: large triangles are worth more than many.
fn weight(items: &[Item]) -> f64 {
    items.iter().map(|item| item.bounds.half_area().sqrt()).sum()
}

/// Whether there is time for a part of `count` items that is as uneven as can be: halving must still reach the leaves.
fn can_choose(count: usize, levels: usize) -> bool {
    (count.next_power_of_two().trailing_zeros() as usize) < levels
}

/// As [`Builder::divide`] without copies, in place.
fn grow(items: &mut [Item], levels: usize, room: Room) -> Node {
    let count = items.len();
    if let [item] = items {
        return Node { bounds: item.bounds, link: Link::leaf(item.index), parent: ROOT };
    }
    let split = divide(items, levels);
    let parts: [&mut [Item]; 2] = items.split_at_mut(split.middle).into();
    room.pair(parts, split.middle, count > PARALLEL, |items, room| grow(items, levels - 1, room))
}

/// Reorders at least two items so that two parts follow each other.
fn divide(items: &mut [Item], levels: usize) -> Split {
    let best = (items.len() > 2 && can_choose(items.len(), levels)).then(|| Bins::fill(items).best()).flatten();
    match best {
        Some(best) => best.apply(items),
        None => halve(items),
    }
}
