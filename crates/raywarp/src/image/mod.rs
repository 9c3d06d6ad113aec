//! What a finished picture becomes: PNG for the eye, EXR for further work, layers and heat maps beside them.
//!
//! Encoders make bytes in memory; [`write::file`](crate::write::file) alone touches the disk, so that a picture is there
//! whole or not at all.

mod color;
mod digits;
mod error;
pub mod exr;
pub mod false_color;
mod format;
pub mod heatmap;
mod layer;
pub mod png;
mod probe;
mod provenance;

pub use crate::scene::settings::ToneMap;
pub use color::Development;
pub use error::ImageError;
pub use format::Format;
pub use layer::Layer;
pub use probe::probe;
pub use provenance::{Found, Provenance};
pub use raywarp_core::kernels::FirstHit;
pub use raywarp_core::traversal::Tests;

/// A rendered picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Column and row of the first pixel in the whole picture, of which this may be a crop.
    pub origin: [u32; 2],
    /// Size of the whole picture.
    pub whole: [u32; 2],
    /// Linear radiance (Rec. 709 primaries) and the share of camera rays that hit something; top row first.
    pub pixels: Vec<[f32; 4]>,
}

/// What the camera ray through each pixel's centre meets first, beside the picture.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One a pixel, top row first.
    pub first_hits: Vec<FirstHit>,
    /// What all rays of a pixel cost, one a pixel, if it was counted.
    pub tests: Option<Vec<Tests>>,
}

/// Eight-bit sRGB pixels, ready for a PNG.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgb8 {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Top row first.
    pub pixels: Vec<[u8; 3]>,
}
