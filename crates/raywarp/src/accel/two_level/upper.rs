//! The tree over the boxes of instances, one in each leaf.
//!
//! Cut by the surface area heuristic over bins (Wald 2007), within the fewer levels that traversal's stack has for it.

use raywarp_core::traversal::bvh2::{Child, Node};
use raywarp_core::traversal::two_level::MAX_UPPER_DEPTH;

use super::super::bins::{Bins, Item, Split};
use super::super::bounds::Bounds;

/// A child that does not exist: an inverted box, and a link to an instance that always does.
const NOTHING: Child = Child::leaf(0, 1);

/// The nodes, 0 the root, and how many of them are on the longest way to a leaf.
pub(super) fn build(boxes: &[Bounds]) -> (Vec<Node>, usize) {
    let mut items: Vec<Item> = boxes.iter().zip(0..).map(|(&bounds, index)| Item { bounds, index }).collect();
    match &mut items[..] {
        [] => (vec![node(&[Bounds::EMPTY; 2], [NOTHING; 2])], 1),
        [one] => (vec![node(&[one.bounds, Bounds::EMPTY], [Child::leaf(one.index, 1), NOTHING])], 1),
        many => {
            let mut nodes = vec![node(&[Bounds::EMPTY; 2], [NOTHING; 2]); many.len() - 1];
            let depth = grow(many, MAX_UPPER_DEPTH, &mut nodes, 0).1;
            (nodes, depth)
        }
    }
}

/// Items of a range from which on its halves are worth a thread each.
const WORTH_A_THREAD: usize = 1024;

/// Fills in the tree of a range, whose root is the first of `nodes` and node `first` of the whole, with at most `levels` inner
/// nodes on the way to a leaf, and tells how many there are. A tree over so many boxes has one node less, so both halves know
/// their places before either is built.
fn grow(items: &mut [Item], levels: usize, nodes: &mut [Node], first: u32) -> (Child, usize) {
    if let [one] = items {
        return (Child::leaf(one.index, 1), 0);
    }
    let split = divide(items, levels);
    let worth_it = items.len() >= WORTH_A_THREAD;
    let (left, right) = items.split_at_mut(split.middle);
    let (root, below) = nodes.split_at_mut(1);
    let (of_left, of_right) = below.split_at_mut(left.len() - 1);
    let next = first + left.len() as u32;
    let mut on_left = || grow(left, levels - 1, of_left, first + 1);
    let mut on_right = || grow(right, levels - 1, of_right, next);
    let ((left, a), (right, b)) = if worth_it { rayon::join(on_left, on_right) } else { (on_left(), on_right()) };
    root[0] = node(&split.bounds, [left, right]);
    (Child::node(first), a.max(b) + 1)
}

/// The heuristic may split off one instance at a time: only as long as halving still ends in time.
fn divide(items: &mut [Item], levels: usize) -> Split {
    let best = (halvings(items.len() - 1) < levels).then(|| Bins::fill(items).best()).flatten();
    match best {
        Some(best) => best.apply(items),
        None => {
            let (left, right) = items.split_at(items.len().div_ceil(2));
            Split { middle: left.len(), bounds: [around(left), around(right)] }
        }
    }
}

/// How often a range must be halved to come to single items.
fn halvings(count: usize) -> usize {
    count.next_power_of_two().trailing_zeros() as usize
}

fn around(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::EMPTY, |all, item| all.join(&item.bounds))
}

fn node(bounds: &[Bounds; 2], children: [Child; 2]) -> Node {
    let [[low_left, high_left], [low_right, high_right]] = bounds.each_ref().map(Bounds::corners);
    Node { low: [low_left, low_right], high: [high_left, high_right], children, unused: [0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each cut takes off one box: without a limit the tree would have as many levels as boxes.
    #[test]
    fn exponential_spacing_keeps_to_the_limit() {
        let boxes: Vec<Bounds> = (0..3000)
            .map(|i| (i as f32 / 16.0 - 90.0).exp2())
            .map(|x| Bounds { low: [x, 0.0, 0.0], high: [x * 1.01, x, x] })
            .collect();
        let (nodes, depth) = build(&boxes);
        assert_eq!(nodes.len(), boxes.len() - 1);
        assert!((13..=MAX_UPPER_DEPTH).contains(&depth), "{depth}");
    }

    #[test]
    fn identical_boxes_are_halved() {
        assert_eq!(build(&[Bounds { low: [0.0; 3], high: [1.0; 3] }; 1000]).1, 10);
    }
}
