//! A k-d tree traversed almost without a stack: with restarts, and a trail that leads back (Laine 2010, "Restart trail for
//! stackless BVH traversal").
//!
//! What waits on a stack is also known from one bit for each level of the way down: whether what is nearer there is done.
//! A few cells are kept all the same, the newest, in registers. Where they have run out, the ray starts at the root again
//! and follows the trail. Each step of the way depends on the way alone, see `Cell::way`: so the same leaves are visited
//! in the same order as with a stack, and only nodes are visited more often.

use raywarp_core::ray::Ray;
use raywarp_core::traversal::kdtree::{later, Cell, KdTree, Way, MAX_DEPTH};
use raywarp_core::traversal::{Counter, Structure, Visitor, WorldSpace};
use raywarp_core::triangle::RayShear;

/// A tree to be traversed so.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct KdTrail {
    /// As for traversal by a stack.
    pub tree: KdTree,
}

/// The cells put aside last. Only ever indexed by constants, so that they lie in registers.
struct Newest {
    cells: [Cell; 4],
    len: u32,
}

impl Newest {
    const fn new() -> Self {
        Self { cells: [Cell { node: 0, first: 0.0, last: 0.0 }; 4], len: 0 }
    }

    /// The oldest is dropped where there are four.
    #[inline(always)]
    fn push(&mut self, cell: Cell) {
        let [a, b, c, _] = self.cells;
        self.cells = [cell, a, b, c];
        self.len = if self.len < 4 { self.len + 1 } else { 4 };
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Cell> {
        self.len = self.len.checked_sub(1)?;
        let [first, a, b, c] = self.cells;
        self.cells = [a, b, c, c];
        Some(first)
    }
}

/// The bit of the root's level in a trail. Those of lower levels are to the right of it, and the bit to the left is set
/// where nothing is left to be visited.
const ROOT: u64 = 1 << 62;

/// One bit for each level of the way to a node: set where the way goes to the only child that the ray meets, or to the
/// second of two.
struct Trail {
    bits: u64,
    /// The bit of the current node's level.
    level: u64,
}

impl Trail {
    /// Goes on to a child.
    #[inline(always)]
    fn descend(&mut self, is_last: bool) {
        if is_last {
            self.bits |= self.level;
        }
        self.level >>= 1;
    }

    /// Whether this node's first child is done.
    #[inline(always)]
    fn is_past_first(&self) -> bool {
        self.bits & self.level != 0
    }

    /// The current node is done: moves on to the node that is next, the second child of the lowest level that has one
    /// left. False where there is none.
    #[inline(always)]
    fn advance(&mut self) -> bool {
        // As counting: the carry passes the levels that are done, and clears them. What is below the current level is
        // left of a way that ended above, and goes as well.
        let parent = self.level << 1;
        self.bits = (self.bits & !(parent - 1)) + parent;
        self.level = (self.bits & self.bits.wrapping_neg()) >> 1;
        self.bits <= ROOT | (ROOT - 1)
    }
}

impl Structure for KdTrail {
    const NAME: &'static str = "kdtrail";
    type Space = WorldSpace;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        let shear = RayShear::new(ray);
        let inverse = ray.inverse_direction();
        let Some(root) = self.tree.enter(ray, inverse) else { return };
        let mut newest = Newest::new();
        let mut trail = Trail { bits: 0, level: ROOT };
        let (mut cell, mut t_far) = (root, ray.t_max);
        loop {
            counter.node();
            let node = self.tree.nodes.at(cell.node);
            if !node.is_leaf() {
                match cell.way(node, ray, inverse) {
                    Way::One(child) => {
                        trail.descend(true);
                        cell = child;
                        continue;
                    }
                    // After a restart.
                    Way::Both(_, far) if trail.is_past_first() => {
                        trail.descend(true);
                        cell = far;
                        if cell.first <= later(t_far) {
                            continue;
                        }
                    }
                    Way::Both(near, far) => {
                        trail.descend(false);
                        newest.push(far);
                        cell = near;
                        continue;
                    }
                }
            } else {
                t_far = self.tree.leaf(node, &shear, ray.t_min, t_far, counter, visitor);
                if t_far < ray.t_min {
                    return;
                }
            }
            // As with a stack, cells that begin behind the nearest hit are dropped one by one.
            cell = loop {
                if !trail.advance() {
                    return;
                }
                match newest.pop() {
                    Some(cell) if cell.first <= later(t_far) => break cell,
                    Some(_) => {}
                    None => {
                        trail.level = ROOT;
                        break root;
                    }
                }
            };
        }
    }
}

const _: () = assert!(MAX_DEPTH <= 62);
