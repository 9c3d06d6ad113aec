//! One tree in two layouts.

use raywarp_kernels::traverse;
use raywarp_kernels::traverse::compact::{Grid, Node};
use raywarp_kernels::triangle::Triangle;

use super::bvh2::Bvh2;
use super::compact;
use super::view::{lend, Borrowed};
use super::{Invalid, TreeStats};

/// A binary hierarchy with both its 64-byte and its 32-byte nodes, see [`traverse::Octants`].
#[derive(Clone, Debug)]
pub struct Octants {
    pub(crate) full: Bvh2,
    pub(crate) nodes: Vec<Node>,
    pub(crate) grid: Grid,
}

impl Octants {
    /// Adds the small nodes.
    pub fn new(full: Bvh2) -> Self {
        let grid = compact::grid(&full.bounds());
        let nodes = compact::compress(full.nodes(), &grid);
        Self { full, nodes, grid }
    }

    /// In the order of the leaves.
    pub fn triangles(&self) -> &[Triangle] {
        self.full.triangles()
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traverse::Octants> {
        let triangles = lend(self.full.triangles());
        Borrowed::new(traverse::Octants {
            full: traverse::Bvh2 { nodes: lend(self.full.nodes()), triangles, reach: self.full.reach() },
            compact: traverse::Compact { nodes: lend(&self.nodes), triangles, grid: self.grid },
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
        compact::same(self.full.nodes(), &self.nodes, &self.grid)
    }
}
