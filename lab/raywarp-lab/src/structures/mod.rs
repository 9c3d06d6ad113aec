//! Every structure that can be measured: those of the product, and those that lost.
//!
//! [`StructureKind`] names them all. A [`Tree`] is one of them over triangles, on the host; it is asked there, or put on a device
//! [opened](crate::open) with their kernels.

pub mod bvh4;
pub mod bvh8;
pub mod bvh8w;
mod grid;
pub mod kdtree_sah;
mod kind;
mod resident;
mod slots;
#[cfg(test)]
mod tests;
mod tree;

pub use kind::{Build, StructureKind, UnknownStructure};
pub use tree::{trail, Tree};

use raywarp_core::view::View;

/// A view of a slice of the host, for a [`Borrowed`](raywarp::accel::Borrowed) that keeps the slice borrowed.
fn lend<T: Copy>(items: &[T]) -> View<T> {
    debug_assert!(u32::try_from(items.len()).is_ok());
    // SAFETY: the slice is valid, and `Borrowed` keeps it borrowed while safe code can reach the view.
    unsafe { View::new(items.as_ptr(), items.len() as u32) }
}
