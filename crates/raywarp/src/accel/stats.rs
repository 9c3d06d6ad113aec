//! How large and how good a tree is.

/// Cost of a step to an inner node, in the surface area heuristic.
pub const NODE_COST: f64 = 1.0;

/// Cost of a triangle's test, likewise.
pub const TRIANGLE_COST: f64 = 1.0;

/// Size and quality of a structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct TreeStats {
    /// Nodes in the array: inner ones, and leaves where they are nodes.
    pub nodes: usize,
    /// Leaves, empty ones included.
    pub leaves: usize,
    /// Triangles of all leaves, each as often as it is there.
    pub references: usize,
    /// Of those, the ones beyond the first of their primitive: what cells and spatial splits add.
    pub duplicates: usize,
    /// Inner nodes on the longest way from the root to a leaf: what traversal's stack must hold.
    pub depth: usize,
    /// Most triangles in a leaf.
    pub largest_leaf: usize,
    /// Expected cost of a ray that meets the root's box and nothing else: [`NODE_COST`] for every inner node and
    /// [`TRIANGLE_COST`] for every reference, each times its box's area over the root's (MacDonald and Booth 1990).
    pub sah_cost: f64,
    /// Memory of all arrays that traversal reads.
    pub bytes: usize,
    /// Time that the build took.
    pub build_seconds: f64,
}

impl TreeStats {
    /// Adds an inner node with `above` others on the way to it, whose box has `area` in units of the root's.
    pub(crate) fn inner(&mut self, above: usize, area: f64) {
        self.depth = self.depth.max(above + 1);
        self.sah_cost += NODE_COST * area;
    }

    /// Adds a leaf of `count` triangles.
    pub(crate) fn leaf(&mut self, count: usize, area: f64) {
        self.leaves += 1;
        self.references += count;
        self.largest_leaf = self.largest_leaf.max(count);
        self.sah_cost += TRIANGLE_COST * area * count as f64;
    }
}
