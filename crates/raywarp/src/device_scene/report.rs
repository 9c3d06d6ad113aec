//! What is told of a scene on its device.

use crate::accel::{Dropped, TreeStats};

/// What became of a scene on its way to the device.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Triangles that can be hit.
    pub triangles: usize,
    /// Triangles that cannot.
    pub dropped: Dropped,
    /// Vertices of all instances; 0 where only queries are answered.
    pub vertices: usize,
    /// Low and high corner of all triangles; both zero where there are none, or where a structure came ready.
    pub bounds: [[f32; 3]; 2],
    /// The structure.
    pub tree: TreeStats,
    /// Bytes on the device, without pictures and rays.
    pub device_bytes: u64,
    /// Seconds to bring all instances to world space.
    pub flatten_seconds: f64,
    /// Seconds to build the structure, or to read it from the cache.
    pub build_seconds: f64,
    /// Seconds to copy everything to the device.
    pub upload_seconds: f64,
    /// What was added or left out by raywarp's own choice, each a sentence without the full stop.
    pub notes: Vec<String>,
}
