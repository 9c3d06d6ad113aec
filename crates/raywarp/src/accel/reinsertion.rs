//! Makes a binary tree better by taking nodes out and putting them back where they cost least.
//!
//! Bittner, Hapala and Havran 2013, in the parallel form of Meister and Bittner 2018: many nodes look for their best
//! places in a tree that nobody changes, by branch and bound, and then move one after the other, most gain first. A
//! move is weighed again in the tree as the earlier ones left it: some have become worthless or impossible, and the
//! sum of the areas of all boxes never grows. The result does not depend on the number of threads.

use rayon::prelude::*;

use super::binary::{sibling, Tree, ROOT};
use super::bounds::Bounds;

/// A node, where to put it, and by how much the sum of all areas shrinks.
#[derive(Clone, Copy)]
struct Move {
    node: u32,
    target: u32,
    gain: f32,
}

/// Lets the share of nodes with the largest boxes look for better places, once for each of `shares`; ends when a round
/// gains less than `least` of the sum of all areas.
pub(super) fn optimise(tree: &mut Tree, shares: &[f64], least: f64) {
    let mut marks = vec![u32::MAX; tree.nodes().len()];
    for &share in shares {
        let nodes = largest(tree, share);
        let total: f64 = nodes.iter().map(|&node| f64::from(half_area(&tree.at(node).bounds))).sum();
        let mut moves: Vec<Move> =
            nodes.par_iter().map_init(Vec::new, |open, &node| search(tree, node, open)).flatten_iter().collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        marks.fill(u32::MAX);
        let gained: f64 = moves.iter().enumerate().map(|(i, wish)| carry_out(tree, wish, i as u32, &mut marks)).sum();
        if gained <= least * total {
            break;
        }
    }
}

/// The largest of all nodes but the root.
fn largest(tree: &Tree, share: f64) -> Vec<u32> {
    let size = |node: u32| half_area(&tree.at(node).bounds);
    let all = 0..tree.nodes().len() as u32;
    let mut nodes: Vec<u32> = all.into_par_iter().filter(|&i| i != ROOT && !tree.at(i).link.is_nothing()).collect();
    let wanted = (nodes.len() as f64 * share).ceil() as usize;
    if wanted < nodes.len() {
        nodes.select_nth_unstable_by(wanted, |&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
        nodes.truncate(wanted);
        nodes.sort_unstable();
    }
    nodes
}

/// In single precision: the search adds differences of areas, and those of boxes that do not change are exactly zero.
#[inline(always)]
fn half_area(bounds: &Bounds) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|i| bounds.high[i] - bounds.low[i]);
    x * y + y * z + z * x
}

/// The best new place of a node, if there is a better one. Overflow makes gains that are no numbers, and none is taken.
///
/// `open` is room for places to look at, lent by the caller.
fn search(tree: &Tree, node: u32, open: &mut Vec<(f32, u32)>) -> Option<Move> {
    let moved = tree.at(node).bounds;
    let own = half_area(&moved);
    let parent = tree.parent(node);
    let mut best = Move { node, target: node, gain: 0.0 };
    // Going up, `around` is what is left of the pivot's box without the node, and `gain` what that has gained.
    let mut gain = half_area(&tree.at(parent).bounds);
    let (mut pivot, mut beside) = (parent, sibling(node));
    let mut around = tree.at(beside).bounds;
    loop {
        open.push((gain, beside));
        while let Some((gain, target)) = open.pop() {
            // Even in a box without any room to spare, the new parent is as large as the node.
            if gain - own <= best.gain {
                continue;
            }
            let place = tree.at(target);
            let joined = half_area(&place.bounds.join(&moved));
            if gain - joined > best.gain {
                best = Move { node, target, gain: gain - joined };
            }
            if let Some([left, right]) = place.link.children() {
                let below = gain - (joined - half_area(&place.bounds));
                if below - own > best.gain {
                    open.extend([(below, right), (below, left)]);
                }
            }
        }
        if pivot != parent {
            around = around.join(&tree.at(beside).bounds);
            gain += half_area(&tree.at(pivot).bounds) - half_area(&around);
        }
        if pivot == ROOT {
            break;
        }
        (beside, pivot) = (sibling(pivot), tree.parent(pivot));
    }
    (best.target != node && best.target != sibling(node)).then_some(best)
}

/// Does the move if it still is one and still gains; gives the gain. `turn` has marked no node before.
fn carry_out(tree: &mut Tree, wish: &Move, turn: u32, marks: &mut [u32]) -> f64 {
    match gain_now(tree, wish, turn, marks) {
        Some(gain) if gain > 0.0 => {
            tree.reinsert(wish.node, wish.target);
            gain
        }
        _ => 0.0,
    }
}

/// What the move gains in the tree as it is; nothing if it cannot be done.
fn gain_now(tree: &Tree, &Move { node, target, .. }: &Move, turn: u32, marks: &mut [u32]) -> Option<f64> {
    let parent = tree.parent(node);
    if target == parent || target == sibling(node) {
        return None;
    }
    let area = |bounds: &Bounds| f64::from(half_area(bounds));
    // The target and all above it.
    let mut above = target;
    loop {
        marks[above as usize] = turn;
        if above == ROOT {
            break;
        }
        above = tree.parent(above);
    }
    if marks[node as usize] == turn {
        return None;
    }
    // Up from the node to the first that is above both: what is in between shrinks.
    let mut around = tree.at(sibling(node)).bounds;
    let mut gain = area(&tree.at(parent).bounds);
    let (mut meeting, mut below) = (parent, parent);
    while marks[meeting as usize] != turn {
        if meeting != parent {
            around = around.join(&tree.at(sibling(below)).bounds);
            gain += area(&tree.at(meeting).bounds) - area(&around);
        }
        (below, meeting) = (meeting, tree.parent(meeting));
    }
    if meeting == target {
        return None;
    }
    // Up from the target to there: what is in between grows.
    let moved = tree.at(node).bounds;
    gain -= area(&tree.at(target).bounds.join(&moved));
    above = tree.parent(target);
    while above != meeting {
        let bounds = tree.at(above).bounds;
        gain -= area(&bounds.join(&moved)) - area(&bounds);
        above = tree.parent(above);
    }
    Some(gain)
}
