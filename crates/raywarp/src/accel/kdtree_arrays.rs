//! What builders of k-d trees share: how a tree grows, the arrays that it grows in, and how large it may become.

use raywarp_core::traversal::kdtree::{Node, MAX_DEPTH, MAX_LINK};

/// References of all leaves together are at most this many times the triangles. A cell that must not add as many as
/// its split would becomes a leaf instead.
pub const COPIES: usize = 16;

/// Most triangles: their copies must have an index each.
pub const MAX_TRIANGLES: u32 = MAX_LINK / COPIES as u32;

/// Levels of inner nodes: 8 + 1.3 log2 n (Havran 2000, page 65), within what traversal's stack holds.
pub fn deepest(triangles: usize) -> usize {
    let levels = 8.0 + 1.3 * (triangles.max(1) as f64).log2();
    (levels as usize).min(MAX_DEPTH)
}

/// What builders differ in: how a cell is cut.
pub trait Cutter: Sync {
    /// A cell, with the triangles in it.
    type Cell: Send;

    /// Cells with more triangles are built by two threads.
    const PARALLEL: usize;

    /// Of a cell, each once.
    fn triangles(cell: &Self::Cell) -> impl ExactSizeIterator<Item = u32>;

    /// The parts of a cell `depth` levels below the root, which together hold at most `budget` references; or the cell,
    /// where it is to be a leaf.
    fn cut(&self, cell: Self::Cell, budget: usize, depth: usize) -> Result<Cut<Self::Cell>, Self::Cell>;
}

/// A plane across an axis, and the cells on both sides.
pub struct Cut<C> {
    pub axis: usize,
    pub plane: f32,
    pub below: C,
    pub above: C,
}

/// Makes the node at `slot` that of a cell, and adds what is below it. The leaves there hold at most `budget` references.
pub fn grow<C: Cutter>(cutter: &C, cell: C::Cell, budget: usize, depth: usize, slot: usize, tree: &mut Arrays) {
    let count = C::triangles(&cell).len();
    let Cut { axis, plane, below, above } = match cutter.cut(cell, budget, depth) {
        Ok(cut) => cut,
        Err(cell) => return tree.leaf(slot, C::triangles(&cell)),
    };
    let children = tree.inner(slot, axis, plane);
    let [left, right] = share(budget, C::triangles(&below).len(), C::triangles(&above).len());
    if count > C::PARALLEL {
        let mut apart = Arrays::with_root();
        rayon::join(
            || grow(cutter, below, left, depth + 1, children, tree),
            || grow(cutter, above, right, depth + 1, 0, &mut apart),
        );
        tree.adopt(children + 1, apart);
    } else {
        grow(cutter, below, left, depth + 1, children, tree);
        grow(cutter, above, right, depth + 1, children + 1, tree);
    }
}

/// A budget of references for both sides of a split, by the share of each. Both get at least what they already have, if
/// the sum does not exceed the budget.
pub fn share(budget: usize, below: usize, above: usize) -> [usize; 2] {
    let left = budget * below / (below + above).max(1);
    [left, budget - left]
}

/// A tree or a part of one, whose links count from its own start.
#[derive(Debug)]
pub struct Arrays {
    pub nodes: Vec<Node>,
    pub references: Vec<u32>,
}

impl Arrays {
    pub fn with_root() -> Self {
        Self { nodes: vec![Node::leaf(0, 0)], references: Vec::new() }
    }

    /// Makes the node at `slot` a leaf.
    fn leaf(&mut self, slot: usize, triangles: impl ExactSizeIterator<Item = u32>) {
        self.nodes[slot] = Node::leaf(self.references.len() as u32, triangles.len() as u32);
        self.references.extend(triangles);
    }

    /// Makes the node at `slot` an inner one, and places for its children, of which the first is returned.
    fn inner(&mut self, slot: usize, axis: usize, plane: f32) -> usize {
        let children = self.nodes.len();
        self.nodes.extend([Node::leaf(0, 0); 2]);
        self.nodes[slot] = Node::inner(axis as u32, plane, children as u32);
        children
    }

    /// Moves another tree in here: its root to `slot`, the rest to the end.
    fn adopt(&mut self, slot: usize, other: Self) {
        let (nodes, references) = (self.nodes.len() as u32, self.references.len() as u32);
        let moved = |node: Node| match node.is_leaf() {
            true => Node::leaf(node.first() + references, node.count()),
            // The root stayed behind, so everything else is one place nearer.
            false => Node::inner(node.axis(), node.plane(), node.below() + nodes - 1),
        };
        let mut others = other.nodes.into_iter().map(moved);
        if let Some(root) = others.next() {
            self.nodes[slot] = root;
        }
        self.nodes.extend(others);
        self.references.extend(other.references);
    }
}
