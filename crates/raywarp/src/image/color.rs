//! From linear radiance to the bytes of a screen.

use raywarp_core::display::{curve, Tone};
use raywarp_scene::settings::{RenderDefaults, ToneMap};

/// How radiance becomes a displayed colour. EXR files hold the radiance itself and ignore this.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// Stops: radiance is multiplied by 2 to this power.
    pub exposure: f32,
    /// What happens to radiance that a screen cannot show.
    pub tone_map: ToneMap,
}

impl Development {
    /// As the kernels take it.
    pub(crate) fn tone(&self) -> Tone {
        let curve = match self.tone_map {
            ToneMap::Clamp => curve::CLAMP,
            ToneMap::Filmic => curve::FILMIC,
        };
        Tone { gain: self.exposure.exp2(), curve }
    }
}

impl From<&RenderDefaults> for Development {
    /// As the scene or the command line asks for, and else as usual.
    fn from(wanted: &RenderDefaults) -> Self {
        Self { exposure: wanted.exposure(), tone_map: wanted.tone_map() }
    }
}

#[cfg(test)]
mod tests {
    use raywarp_core::display::srgb_byte;

    use raywarp_scene::srgb::srgb_to_linear;

    use super::*;

    fn color(development: &Development, radiance: [f32; 3]) -> [u8; 3] {
        development.tone().color(radiance.into())
    }

    #[test]
    fn every_byte_survives_the_way_to_linear_and_back() {
        for byte in 0..=255u8 {
            assert_eq!(srgb_byte(srgb_to_linear(f32::from(byte) / 255.0)), byte);
        }
    }

    #[test]
    fn one_stop_doubles() {
        let stop = Development { exposure: 1.0, ..Development::default() };
        let plain = Development::default();
        assert_eq!(color(&stop, [0.1, 0.2, 0.3]), color(&plain, [0.2, 0.4, 0.6]));
    }

    #[test]
    fn strange_radiance_has_a_colour() {
        for tone_map in ToneMap::ALL {
            let development = Development { exposure: 0.0, tone_map };
            assert_eq!(color(&development, [f32::INFINITY; 3]), [255; 3]);
            assert_eq!(color(&development, [f32::NEG_INFINITY; 3]), [0; 3]);
            assert_eq!(color(&development, [0.0, f32::NAN, 0.0]), [255, 0, 255]);
        }
    }
}
