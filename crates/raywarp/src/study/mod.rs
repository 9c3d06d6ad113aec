//! Other ways to trace the same rays, to measure what the ones in use are worth: what `raywarp study` is made of.
//!
//! A [`Batch`] answers rays by each [`Way`] of sharing them out among threads. [`lanes`] follows warps step by step, without
//! a GPU, and says what their lanes do. [`paths`] follows rays over several bounces, in one kernel or bounce by bounce. All
//! of them trace through a `bvh2`, and answer as everything else in raywarp does, to the bit.

pub mod lanes;
pub mod paths;
mod sharing;

pub use sharing::{Batch, Queues, Way};
