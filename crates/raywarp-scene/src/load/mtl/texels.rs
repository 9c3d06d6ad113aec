//! What a picture is, judged by its texels: MTL does not say.

use crate::{Channel, Image};

/// Channels this close are the same: lossy compression spreads them a little.
const SAME: u8 = 16;

/// Whether a picture has no colours, up to one texel in a hundred.
pub(super) fn is_grey(image: &Image) -> bool {
    let coloured = |texel: &&[u8; 4]| {
        let [r, g, b, _] = **texel;
        r.max(g).max(b) - r.min(g).min(b) > SAME
    };
    image.texels.iter().filter(coloured).count() <= image.texels.len() / 100
}

/// Whether a picture has an alpha channel that says something.
pub(super) fn has_alpha(image: &Image) -> bool {
    image.texels.iter().any(|texel| texel[3] != 255)
}

/// Whether a channel is nearly all 0 or 255: a shape cut out, its edge softened at most.
///
/// The soft edge of fine leaves may be a tenth of the picture, spread over all values; a pane of glass has a value of
/// its own, which many texels share.
pub(super) fn is_cutout(image: &Image, channel: Channel) -> bool {
    let mut counts = [0; 256];
    for &texel in &image.texels {
        counts[usize::from(value(texel, channel))] += 1;
    }
    let between = &counts[usize::from(SAME)..=usize::from(255 - SAME)];
    let most = between.iter().copied().max().unwrap_or(0);
    between.iter().sum::<usize>() <= image.texels.len() / 5 && most <= image.texels.len() / 50
}

fn value([r, g, b, a]: [u8; 4], channel: Channel) -> u8 {
    match channel {
        Channel::Red => r,
        Channel::Green => g,
        Channel::Blue => b,
        Channel::Alpha => a,
        Channel::Rgb | Channel::Luminance => {
            ((2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b)) / 10_000) as u8
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of 1000 texels, half of them empty, some with these alphas, the rest full.
    fn with_alphas(between: impl Iterator<Item = u8>) -> Image {
        let alphas = between.chain(std::iter::repeat_n(0, 500)).chain(std::iter::repeat(255));
        let texels = alphas.take(1000).map(|alpha| [50, 60, 70, alpha]).collect();
        Image { name: String::new(), width: 1000, height: 1, texels }
    }

    #[test]
    fn soft_edges_are_cut_out_and_panes_are_not() {
        let edges = with_alphas((20..235).step_by(2));
        assert!(is_cutout(&edges, Channel::Alpha));
        let pane = with_alphas(std::iter::repeat_n(128, 100));
        assert!(!is_cutout(&pane, Channel::Alpha));
        let gradient = with_alphas((16..240).chain(16..240));
        assert!(!is_cutout(&gradient, Channel::Alpha));
    }

    #[test]
    fn compressed_grey_is_grey() {
        assert!(!is_grey(&with_alphas(std::iter::empty())));
        let grey = Image { texels: vec![[100, 108, 103, 255]; 10], ..Image::default() };
        assert!(is_grey(&grey) && !has_alpha(&grey));
    }
}
