//! What can go wrong with a structure, as sentences.

use raywarp_core::traversal::bvh2::MAX_INDEX;

use super::AccelKind;
use crate::device::DeviceError;

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
    /// Links between two levels have too few bits.
    #[error("the scene has {has} {what}, more than the {limit} that a structure of two levels can index")]
    TooManyLinks {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        has: usize,
        /// Most that fit.
        limit: u32,
    },
    /// A structure for other machines.
    #[error("the structure {structure} is laid out for CPUs and has no kernels for {device}; bvh is the one for GPUs")]
    NoKernels {
        /// Which.
        structure: AccelKind,
        /// What cannot trace it.
        device: String,
    },
    /// The same, where meshes are placed by instances.
    #[error(
        "the structure {structure} has no kernels for {device} where a scene's meshes are placed by instances; bvh has, and \
         CPUs trace both"
    )]
    NoInstances {
        /// Which.
        structure: AccelKind,
        /// What cannot trace it.
        device: String,
    },
    /// A builder that was made for fewer.
    #[error("{has} triangles do not fit in the memory of a builder of trees for {capacity}")]
    Capacity {
        /// Triangles given.
        has: usize,
        /// Most that it was made for.
        capacity: u32,
    },
    /// The device that builds fails, or has no room.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// An instance of nothing.
    #[error("instance {placement} is of mesh {mesh}, but there are {count}")]
    NoSuchMesh {
        /// Which instance, from 0.
        placement: usize,
        /// What it says.
        mesh: usize,
        /// How many there are.
        count: usize,
    },
}

impl BuildError {
    /// Whether `has` triangles stay within `limit`.
    ///
    /// # Errors
    /// [`TooManyTriangles`](Self::TooManyTriangles) where they do not.
    pub fn check(has: usize, limit: u32) -> Result<(), Self> {
        if has > limit as usize {
            return Err(Self::TooManyTriangles { has, limit });
        }
        Ok(())
    }

    /// Whether links of a hierarchy can tell `has` things apart.
    pub(crate) fn check_index(what: &'static str, has: usize) -> Result<(), Self> {
        if has > MAX_INDEX as usize {
            return Err(Self::TooManyLinks { what, has, limit: MAX_INDEX });
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
    /// Of one of several trees.
    #[error("in the tree of mesh {mesh}: {flaw}")]
    Mesh {
        /// Which, in the structure's order.
        mesh: u32,
        /// What is wrong with it.
        flaw: Box<Invalid>,
    },
    /// A placed mesh would not be found, or its triangles would be called by others' names.
    #[error("instance {instance} {flaw}")]
    Instance {
        /// Which.
        instance: u32,
        /// What is wrong with it: the rest of a sentence.
        flaw: &'static str,
    },
    /// A ray could hit a triangle outside the boxes on the way to it, and miss it.
    #[error("a triangle below node {node} sticks out of its box there, and no other leaf has that part of it")]
    Outside {
        /// The first node on the way whose box does not contain the whole triangle.
        node: u32,
    },
    /// Planes on a grid of no size.
    #[error(
        "the distance between the planes of node {node} is not a normal positive number, or its origin is not finite"
    )]
    Grid {
        /// The node that holds the grid.
        node: u32,
    },
    /// A cell that is cut nowhere.
    #[error("node {node} is cut at a plane that is not a number")]
    NoPlane {
        /// Which.
        node: u32,
    },
    /// Of a node that tells by a byte what a slot holds.
    #[error("slot {slot} of node {node} holds neither a node nor a leaf")]
    Slot {
        /// Which node.
        node: u32,
        /// From 0.
        slot: usize,
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
