//! No structure: the list of triangles itself.

use raywarp_core::traversal;
use raywarp_core::triangle::Triangle;

use super::view::{lend, Borrowed};
use super::{BuildError, TreeStats, TRIANGLE_COST};

/// Every triangle, in the order given.
#[derive(Clone, Debug, Default)]
pub struct Brute {
    pub(crate) triangles: Vec<Triangle>,
}

impl Brute {
    /// Keeps the list.
    ///
    /// # Errors
    /// It has 2^32 triangles or more.
    pub fn new(triangles: Vec<Triangle>) -> Result<Self, BuildError> {
        BuildError::check(triangles.len(), u32::MAX)?;
        Ok(Self { triangles })
    }

    /// In the order given.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// For tracing on this machine.
    pub fn view(&self) -> Borrowed<'_, traversal::Brute> {
        Borrowed::new(traversal::Brute { triangles: lend(&self.triangles) })
    }

    /// One leaf of everything.
    pub fn stats(&self) -> TreeStats {
        let count = self.triangles.len();
        TreeStats {
            leaves: 1,
            references: count,
            largest_leaf: count,
            sah_cost: TRIANGLE_COST * count as f64,
            bytes: size_of_val(&self.triangles[..]),
            ..TreeStats::default()
        }
    }
}
