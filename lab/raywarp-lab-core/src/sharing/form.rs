//! The order in which the threads of a warp take steps (after Aila and Laine 2009).
//!
//! A thread whose next step is to a node and one whose next is to a triangle cannot take them at once: one of them waits.

use super::search::Search;
use raywarp_core::arch;
use raywarp_core::traversal::query::Query;
use raywarp_core::traversal::Counter;

/// A loop over a search's steps.
pub trait Form: Copy + Send + Sync {
    /// Some steps of a search that is not over; of those that take turns together, one takes a step at least.
    fn turn<Q: Query>(search: &mut Search<Q>, counter: &mut impl Counter);
}

/// A node or a triangle, and again.
#[derive(Clone, Copy, Debug)]
pub struct IfIf;

impl Form for IfIf {
    #[inline(always)]
    fn turn<Q: Query>(search: &mut Search<Q>, counter: &mut impl Counter) {
        if search.is_at_node() && !search.holds_leaf() {
            search.visit(counter);
        }
        if search.is_at_leaf() && !search.holds_leaf() {
            search.hold();
        }
        if search.holds_leaf() {
            search.test_one(counter);
        }
    }
}

/// Nodes until there is a leaf, then its triangles: what renders.
#[derive(Clone, Copy, Debug)]
pub struct WhileWhile;

impl Form for WhileWhile {
    #[inline(always)]
    fn turn<Q: Query>(search: &mut Search<Q>, counter: &mut impl Counter) {
        while search.is_at_node() {
            search.visit(counter);
        }
        if search.is_at_leaf() {
            search.test_next(counter);
        }
    }
}

/// As [`WhileWhile`], but a thread with a leaf goes on to nodes for as long as another has none: it may visit some for
/// nothing, and would only have waited.
#[derive(Clone, Copy, Debug)]
pub struct Speculative;

impl Form for Speculative {
    #[inline(always)]
    fn turn<Q: Query>(search: &mut Search<Q>, counter: &mut impl Counter) {
        while search.is_at_node() {
            search.visit(counter);
            if search.is_at_leaf() && !search.holds_leaf() {
                search.hold();
            }
            if arch::all(search.holds_leaf()) {
                break;
            }
        }
        search.test_held(counter);
        if search.is_at_leaf() {
            search.test_next(counter);
        }
    }
}

/// Each step is what more of the threads want; one with a leaf goes on to nodes until the leaves are more.
#[derive(Clone, Copy, Debug)]
pub struct Postponed;

impl Form for Postponed {
    #[inline(always)]
    fn turn<Q: Query>(search: &mut Search<Q>, counter: &mut impl Counter) {
        if search.is_at_leaf() && !search.holds_leaf() {
            search.hold();
        }
        let here = arch::together();
        // SAFETY: those that are together come here together.
        let (nodes, leaves) =
            unsafe { (arch::ballot(here, search.is_at_node()), arch::ballot(here, search.holds_leaf())) };
        if nodes.count_ones() >= leaves.count_ones() {
            if search.is_at_node() {
                search.visit(counter);
            }
        } else if search.holds_leaf() {
            search.test_held(counter);
        }
    }
}
