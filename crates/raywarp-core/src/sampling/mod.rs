//! Random points of path tracing: low-discrepancy sequences, tables, and maps from the unit square to directions.

mod alias;
mod sobol;
pub mod warp;

pub use alias::{AliasEntry, AliasTable};
pub use sobol::{Pair, Sampler};
