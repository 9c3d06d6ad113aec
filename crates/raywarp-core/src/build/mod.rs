//! Kernels that build a binary hierarchy of boxes: H-PLOC (Benthin, Meister, Barczak, Mehalwal, Kulkarni and Dietrich 2024).
//!
//! The way of a triangle: [`survey`] finds which can be hit and where their centres lie, [`morton`] gives each a code along a
//! curve through space, [`radix_sort`] puts them in its order, [`hploc`] merges neighbours into a binary tree with one
//! triangle a leaf and decides which subtrees become leaves, [`subtrees`] shares these out to threads, [`emit`] writes the
//! nodes that traversal reads, depth first, and [`gather`] the triangles in the order of the leaves.
//!
//! The tree is a function of the triangles and their order: no counter gives out numbers, every tie is decided by places in
//! the sorted order, and what is reduced by atomics are the least and the largest of integers. So both machines, and any
//! number of threads, build the same bits.

pub mod bounds;
mod cluster;
pub mod emit;
pub mod gather;
pub mod hittable;
pub mod hploc;
pub mod morton;
pub mod node;
pub mod quantize;
pub mod radix_sort;
pub mod subtrees;
pub mod survey;
#[cfg(test)]
mod tests;

use crate::arch;

/// Items that a block works on, in kernels that give each block a run of them.
pub const TILE: u32 = 1024;

/// Items of a run that each thread has.
const ITEMS: u32 = TILE / arch::THREADS;

/// Most triangles of a leaf.
pub const MAX_LEAF: u32 = 8;

const _: () = assert!(MAX_LEAF <= crate::traversal::bvh2::MAX_LEAF);
