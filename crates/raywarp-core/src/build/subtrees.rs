//! Shares the binary tree out to the threads that write it: to each a small subtree, or a node above those.

use super::node::Node;
use super::survey::Findings;
use crate::arch::{self, WARP};
use crate::kernels::Thread;
use crate::view::{View, ViewMut};
use crate::warp_counter::WarpCounter;

/// Most nodes of a subtree that one thread writes.
pub const MOST: u32 = 8;

/// All threads of a warp, a bit each.
const ALL: u32 = u32::MAX >> (32 - WARP);

/// Lists the nodes at which a thread begins to write, in any order, one thread a node of the binary tree.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FindSubtrees {
    /// The binary tree.
    pub tree: View<Node>,
    /// Triangles given.
    pub given: u32,
    /// One; how many subtrees there are is added to it.
    pub findings: ViewMut<Findings>,
    /// Numbers of nodes, written.
    pub subtrees: ViewMut<u32>,
}

impl FindSubtrees {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let begins = self.begins(thread.x);
        // SAFETY: whole warps are launched, and no thread has left.
        let lanes = unsafe { arch::ballot(ALL, begins) };
        if lanes == 0 {
            return;
        }
        // SAFETY: in this launch nothing but warps touches the number, by additions.
        let counter = WarpCounter::at(unsafe { &raw mut (*self.findings.shared(0)).subtrees });
        let first = counter.take(lanes.count_ones());
        if arch::afresh(begins) {
            // SAFETY: the counter gives each place once.
            unsafe { self.subtrees.set(first + (lanes & arch::lanes_below()).count_ones(), thread.x) };
        }
    }

    /// Whether a node's thread writes it: the root, the nodes above small subtrees, and the roots of these.
    #[inline(always)]
    fn begins(&self, number: u32) -> bool {
        let found = self.findings.shared(0);
        // SAFETY: these two were counted by a launch before.
        let count = unsafe { self.given - (*found).not_finite - (*found).without_area };
        if number >= count {
            return false;
        }
        let node = self.tree.item(number);
        number == 0 || node.nodes > MOST || (node.nodes > 0 && self.tree.item(node.parent).nodes > MOST)
    }
}
