//! How a scene wants to be rendered: what a scene file and a command line can both say.

mod integrator;
mod quality;
mod render;
mod structure;
mod tone_map;

pub use integrator::Integrator;
pub use quality::{Quality, UnknownQuality};
pub use render::{Part, RenderDefaults, Setting, SETTINGS};
pub use structure::{AccelKind, UnknownKind};
pub use tone_map::ToneMap;

/// Most bounces: Whitted's stack in the kernels is so large.
pub const MAX_DEPTH: u32 = 16;

/// Most samples a pixel: beyond, single precision no longer adds them up.
pub const MAX_SPP: u32 = 1 << 20;

/// Most pixels along a side.
pub const MAX_SIDE: u32 = 1 << 16;
