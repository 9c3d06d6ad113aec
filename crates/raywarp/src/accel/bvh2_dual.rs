//! One tree in two layouts.

use raywarp_core::traversal;
use raywarp_core::traversal::bvh2_quantized::{Grid, Node};
use raywarp_core::triangle::Triangle;

use super::bvh2::Bvh2;
use super::bvh2_quantized;
use super::view::{lend, Borrowed};
use super::{Invalid, TreeStats};

/// A binary hierarchy with both its 64-byte and its 32-byte nodes, see [`traversal::DualBvh2`].
#[derive(Clone, Debug)]
pub struct DualBvh2 {
    pub(crate) full: Bvh2,
    pub(crate) nodes: Vec<Node>,
    pub(crate) grid: Grid,
}

impl DualBvh2 {
    /// Adds the small nodes.
    pub fn new(full: Bvh2) -> Self {
        let grid = bvh2_quantized::grid(&full.bounds());
        let nodes = bvh2_quantized::compress(full.nodes(), &grid);
        Self { full, nodes, grid }
    }

    /// In the order of the leaves.
    pub fn triangles(&self) -> &[Triangle] {
        self.full.triangles()
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traversal::DualBvh2> {
        let triangles = lend(self.full.triangles());
        Borrowed::new(traversal::DualBvh2 {
            full: traversal::Bvh2 { nodes: lend(self.full.nodes()), triangles, reach: self.full.reach() },
            quantized: traversal::QuantizedBvh2 { nodes: lend(&self.nodes), triangles, grid: self.grid },
        })
    }

    /// Size and quality.
    pub fn stats(&self) -> TreeStats {
        let stats = self.full.stats();
        TreeStats { bytes: stats.bytes + size_of_val(&self.nodes[..]), ..stats }
    }

    /// See [`Accel::validate`](super::Accel::validate). The small nodes are checked by making them again.
    ///
    /// # Errors
    /// The first flaw found.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.full.validate()?;
        bvh2_quantized::same(self.full.nodes(), &self.nodes, &self.grid)
    }
}
