//! Colours of vertices and of faces: which properties hold them, and in what unit.

use ply_rs_bw::ply::{PropertyType, ScalarType};

use super::header::Element;
use crate::load::colors::{decoded, share, ChannelRange};
use crate::srgb::srgb_to_linear_precise;

/// How a table writes its colours: what stands for 1 in red, green, blue and alpha; `None` for floating point.
#[derive(Clone, Copy)]
pub(super) struct ColorFormat([Option<f64>; 4]);

/// The channel that a property of this name holds.
pub(super) fn channel(name: &str) -> Option<usize> {
    Some(match name {
        "red" | "diffuse_red" => 0,
        "green" | "diffuse_green" => 1,
        "blue" | "diffuse_blue" => 2,
        "alpha" | "diffuse_alpha" => 3,
        _ => return None,
    })
}

impl ColorFormat {
    /// `None` for a table without red, green and blue.
    pub fn of(element: &Element) -> Option<Self> {
        let mut kinds = [None; 4];
        for property in element.properties.iter().rev() {
            if let (PropertyType::Scalar(kind), Some(channel)) = (&property.kind, channel(&property.name)) {
                kinds[channel] = Some(one(kind));
            }
        }
        kinds[..3].iter().all(Option::is_some).then(|| Self(kinds.map(Option::flatten)))
    }

    /// What a row without an alpha has for it.
    pub fn full_alpha(self) -> f64 {
        self.0[3].unwrap_or(1.0)
    }

    /// A linear colour; channels in floating point stay as they are until all are known.
    pub fn color(self, row: [f64; 4]) -> [f32; 4] {
        std::array::from_fn(|channel| match self.0[channel] {
            None => row[channel] as f32,
            Some(one) if channel == 3 => share(row[channel] / one) as f32,
            Some(one) => srgb_to_linear_precise(share(row[channel] / one)) as f32,
        })
    }

    /// Brings the channels in floating point, which are linear from 0 to 1 or sRGB from 0 to 255, to where they belong.
    /// Returns how many colours were cut off at 1.
    pub fn finish(self, colors: &mut [[f32; 4]]) -> usize {
        let floats = |channels: std::ops::Range<usize>| channels.filter(|&channel| self.0[channel].is_none());
        let range = |channels: std::ops::Range<usize>| {
            ChannelRange::of(colors.iter().flat_map(|color| floats(channels.clone()).map(|channel| color[channel])))
        };
        let (rgb, alpha) = (range(0..3), range(3..4));
        let mut cut = 0;
        for color in colors {
            cut += usize::from(floats(0..3).any(|channel| rgb.cuts(color[channel])));
            for channel in floats(0..3) {
                let unit = rgb.unit(color[channel]);
                color[channel] = if rgb.is_bytes() { decoded(unit) } else { unit };
            }
            for channel in floats(3..4) {
                color[channel] = alpha.unit(color[channel]);
            }
        }
        cut
    }
}

/// What stands for 1; `None` in floating point.
fn one(kind: &ScalarType) -> Option<f64> {
    match kind {
        ScalarType::Float | ScalarType::Double => None,
        ScalarType::Char => Some(f64::from(i8::MAX)),
        ScalarType::Short => Some(f64::from(i16::MAX)),
        ScalarType::UShort => Some(f64::from(u16::MAX)),
        // Colours declared as int or uint are 0 to 255 all the same.
        _ => Some(255.0),
    }
}
