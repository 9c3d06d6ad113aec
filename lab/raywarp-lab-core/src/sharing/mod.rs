//! How the rays of a batch are shared out among threads: variations of one traversal, over the same tree.
//!
//! A [`search`] is one ray's way through a `bvh2`, which can be put aside after any step; a [`form`] is the order in which
//! the threads of a warp take steps to nodes and to triangles. The kernels differ in where a thread gets its rays from:
//! [`direct`] gives each its own, [`queued`] has warps take units of work from queues and from each other's, [`refill`]
//! gives a new ray to each lane that is done. [`paths`] follows rays over several bounces, and [`sort`] puts rays in order
//! between them.
//!
//! What renders is [`traversal`](raywarp_core::traversal), and batches that it does not suit are answered by [`persistent`](raywarp_core::persistent) threads;
//! this is for measuring what they could be (`raywarp-lab study`).

pub mod direct;
pub mod form;
pub mod paths;
pub mod queued;
pub mod refill;
pub mod search;
pub mod sort;
