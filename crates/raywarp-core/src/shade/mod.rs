//! What a ray brings back.

pub mod optics;
pub mod whitted;
