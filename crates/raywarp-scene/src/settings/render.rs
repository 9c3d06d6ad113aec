//! How a scene wants to be rendered, where whoever renders it has no other wish.

use std::fmt;

use super::{AccelKind, Quality, ToneMap};

/// Defaults for the options of rendering: the `[render]` table of a scene file, or the wishes of a command line.
/// `None` leaves an option to the next one asked, in the end to raywarp.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderDefaults {
    /// Width and height of the picture in pixels, each from 1 to [`MAX_SIDE`](super::MAX_SIDE).
    pub size: Option<[u32; 2]>,
    /// Samples a pixel, from 1 to [`MAX_SPP`](super::MAX_SPP).
    pub spp: Option<u32>,
    /// Bounces after the camera ray, at most [`MAX_DEPTH`](super::MAX_DEPTH).
    pub max_depth: Option<u32>,
    /// Whether lights cast shadows.
    pub shadows: Option<bool>,
    /// Changes the random numbers.
    pub seed: Option<u32>,
    /// Stops that a PNG is brightened by, from -60 to 60.
    pub exposure: Option<f32>,
    /// What a PNG does with radiance above 1.
    pub tone_map: Option<ToneMap>,
    /// The structure that rays go through. `None` in the end is the fastest on the device.
    pub accel: Option<AccelKind>,
    /// How good its tree should be.
    pub tree: Option<Quality>,
}

impl RenderDefaults {
    /// These, and where they are silent the `other` ones.
    pub fn or(&self, other: &Self) -> Self {
        Self {
            size: self.size.or(other.size),
            spp: self.spp.or(other.spp),
            max_depth: self.max_depth.or(other.max_depth),
            shadows: self.shadows.or(other.shadows),
            seed: self.seed.or(other.seed),
            exposure: self.exposure.or(other.exposure),
            tone_map: self.tone_map.or(other.tone_map),
            accel: self.accel.or(other.accel),
            tree: self.tree.or(other.tree),
        }
    }
}

/// What is given, with commas, as the options of the command line name it: "size 640x480, samples 16".
impl fmt::Display for RenderDefaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let switched = |on: bool| if on { "on" } else { "off" };
        let given = [
            self.size.map(|[width, height]| format!("size {width}x{height}")),
            self.spp.map(|n| format!("samples {n}")),
            self.max_depth.map(|n| format!("max depth {n}")),
            self.shadows.map(|on| format!("shadows {}", switched(on))),
            self.seed.map(|n| format!("seed {n}")),
            self.exposure.map(|stops| format!("exposure {stops}")),
            self.tone_map.map(|curve| format!("tone map {curve}")),
            self.accel.map(|kind| format!("accel {kind}")),
            self.tree.map(|quality| format!("tree {quality}")),
        ];
        f.write_str(&given.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_wish_counts_and_raywarp_fills_the_rest() {
        let first = RenderDefaults { spp: Some(4), shadows: Some(true), ..RenderDefaults::default() };
        let second = RenderDefaults { spp: Some(9), shadows: Some(false), seed: Some(3), ..RenderDefaults::default() };
        let both = first.or(&second);
        assert_eq!(both.to_string(), "samples 4, shadows on, seed 3");
        assert_eq!(RenderDefaults::default().to_string(), "");
    }
}
