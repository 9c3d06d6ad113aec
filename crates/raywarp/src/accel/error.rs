//! What can go wrong with a structure, as sentences.

/// Why a structure could not be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// Links have too few bits.
    #[error("the scene has {has} triangles, more than the {limit} that this structure can index")]
    TooManyTriangles {
        /// Triangles given.
        has: usize,
        /// Most that fit.
        limit: u32,
    },
}

impl BuildError {
    /// Whether `has` triangles stay within `limit`.
    pub(crate) fn check(has: usize, limit: u32) -> Result<(), Self> {
        if has > limit as usize {
            return Err(Self::TooManyTriangles { has, limit });
        }
        Ok(())
    }
}

/// Why a structure must not be traversed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Invalid {
    /// Traversal starts at node 0.
    #[error("the tree has no nodes; traversal starts at node 0")]
    NoRoot,
    /// Of a link or a run of triangles.
    #[error("node {node} links to {what} {index}, but there are {count}")]
    OutOfRange {
        /// Where the link is.
        node: u32,
        /// "node", "triangle" or "reference".
        what: &'static str,
        /// What it says.
        index: u64,
        /// How many there are.
        count: usize,
    },
    /// A cycle, or a part shared by two parents.
    #[error("node {node} is reached more than once")]
    Reached {
        /// Which.
        node: u32,
    },
    /// A ray whose distances overflow would follow the link, and maybe for ever.
    #[error(
        "node {node} links to another node without a box around it; a child that is not there links to a triangle"
    )]
    NoBox {
        /// Where the link is.
        node: u32,
    },
    /// Memory that traversal never sees.
    #[error("only {reached} of {count} nodes are reached from the root")]
    Unreached {
        /// Nodes below the root, itself included.
        reached: usize,
        /// Nodes in the array.
        count: usize,
    },
    /// Traversal's stack would overflow.
    #[error("node {node} lies below {limit} others, more than traversal's stack can hold")]
    TooDeep {
        /// The first one too deep.
        node: u32,
        /// Levels that there may be.
        limit: usize,
    },
    /// A triangle is in no leaf, or in two where one is the rule.
    #[error("triangle {triangle} is in {leaves} leaves; expected {expected}")]
    Leaves {
        /// Index in the structure's order.
        triangle: u32,
        /// How many hold it.
        leaves: u32,
        /// "1" or "at least 1".
        expected: &'static str,
    },
    /// A ray could hit a triangle outside the boxes on the way to it, and miss it.
    #[error("a triangle below node {node} sticks out of its box there, and no other leaf has that part of it")]
    Outside {
        /// The first node on the way whose box does not contain the whole triangle.
        node: u32,
    },
    /// A ray could pass the cell and miss the triangle.
    #[error("triangle {triangle} touches the cell of leaf {node}, which does not refer to it")]
    NotReferred {
        /// The leaf.
        node: u32,
        /// Index in the structure's order.
        triangle: u32,
    },
}
