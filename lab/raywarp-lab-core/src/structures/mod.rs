//! Structures that lost: other layouts of a hierarchy of boxes, and other ways through a k-d tree or a list.

pub mod bvh4;
pub mod bvh8;
pub mod bvh8w;
mod grid;
pub mod kdtrail;
pub mod staged;

pub use bvh4::Bvh4;
pub use bvh8::Bvh8;
pub use bvh8w::Bvh8w;
pub use kdtrail::KdTrail;
pub use staged::Staged;
