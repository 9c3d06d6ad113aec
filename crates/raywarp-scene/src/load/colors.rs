//! Vertex colours as programs write them in floating point: from 0 to 1 or from 0 to 255, which all of a file tell.

use crate::srgb::srgb_to_linear_precise;

/// Colours of whole numbers beyond 1 count to 255, and so do those with a channel beyond this: what shines brighter than
/// white is written as a fraction, and seldom so bright.
const BRIGHTEST: f32 = 32.0;

/// Half a step of a byte: nothing is lost that a picture would show.
const UNSEEN: f32 = 0.5 / 255.0;

/// What is known of some channels of all the colours of a file.
#[derive(Clone, Copy)]
pub(super) struct ChannelRange {
    largest: f32,
    whole: bool,
}

impl ChannelRange {
    /// Takes in all channels; what is not finite has no say.
    pub fn of(channels: impl Iterator<Item = f32>) -> Self {
        channels.filter(|channel| channel.is_finite()).fold(Self { largest: 0.0, whole: true }, |range, channel| Self {
            largest: range.largest.max(channel),
            whole: range.whole && channel.fract() == 0.0,
        })
    }

    /// Whether 255 stands for 1.
    pub fn is_bytes(self) -> bool {
        self.largest > 1.0 && (self.whole || self.largest > BRIGHTEST)
    }

    /// The channel from 0 to 1; 0 for NaN.
    pub fn unit(self, channel: f32) -> f32 {
        share(f64::from(channel) / if self.is_bytes() { 255.0 } else { 1.0 }) as f32
    }

    /// Whether a channel is cut off where it can be seen.
    pub fn cuts(self, channel: f32) -> bool {
        channel > if self.is_bytes() { 255.5 } else { 1.0 + UNSEEN }
    }
}

/// From 0 to 1; 0 for NaN.
pub(super) fn share(x: f64) -> f64 {
    if x > 0.0 {
        x.min(1.0)
    } else {
        0.0
    }
}

/// From sRGB, as programs write colours that they show.
pub(super) fn decoded(channel: f32) -> f32 {
    srgb_to_linear_precise(f64::from(channel)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(channels: &[f32]) -> ChannelRange {
        ChannelRange::of(channels.iter().copied())
    }

    #[test]
    fn bytes_are_told_from_shares() {
        for bytes in [&[0.0, 255.0, 128.0][..], &[12.5, 254.75], &[0.0, 2.0]] {
            assert!(range(bytes).is_bytes(), "{bytes:?}");
        }
        for shares in [&[][..], &[0.0, 1.0], &[0.5, 1.25], &[0.1, 7.5, f32::INFINITY, f32::NAN]] {
            assert!(!range(shares).is_bytes(), "{shares:?}");
        }
    }

    #[test]
    fn channels_end_at_one() {
        let (bytes, shares) = (range(&[0.0, 255.0]), range(&[0.5, 1.25]));
        assert_eq!([bytes.unit(51.0), bytes.unit(-3.0), bytes.unit(300.0)], [0.2, 0.0, 1.0]);
        assert_eq!([shares.unit(0.5), shares.unit(1.25), shares.unit(f32::NAN)], [0.5, 1.0, 0.0]);
        assert!(shares.cuts(1.25) && !shares.cuts(1.0001) && !bytes.cuts(255.0));
    }
}
