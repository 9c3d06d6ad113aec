//! What each pixel cost, as colours.
//!
//! The cost of a pixel is its triangle tests plus its node visits, for all of its rays. The scale is linear from 0 to
//! a maximum, by the ten-colour anchors of matplotlib's "inferno" (Smith and van der Walt 2015): its lightness grows
//! evenly, so that twice as bright is about twice the cost, also in black and white and to the colour-blind. What is
//! above the maximum is shown like the maximum.

use std::fmt;

use raywarp_kernels::traverse::Tests;

use super::{digits, Rgb8};

/// The colours of equal steps from nothing to the maximum, sRGB.
const ANCHORS: [[u8; 3]; 10] = [
    [0x00, 0x00, 0x04],
    [0x1b, 0x0c, 0x42],
    [0x4b, 0x0c, 0x6b],
    [0x78, 0x1c, 0x6d],
    [0xa5, 0x2c, 0x60],
    [0xcf, 0x44, 0x46],
    [0xed, 0x69, 0x25],
    [0xfb, 0x9a, 0x06],
    [0xf7, 0xd0, 0x3c],
    [0xfc, 0xff, 0xa4],
];

/// What the colours of a heat map mean: tests a pixel, nodes and triangles together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// What the brightest colour stands for.
    pub top: u64,
    /// The costliest pixel.
    pub maximum: u64,
    /// Mean over the pixels.
    pub mean: f64,
    /// Half of the pixels cost less than this or as much.
    pub median: u64,
}

impl fmt::Display for Scale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "tests a pixel (nodes + triangles): black is 0, the brightest is {}; mean {:.1}, median {}, maximum {}",
            self.top, self.mean, self.median, self.maximum
        )
    }
}

/// Draws the cost of each pixel over a colour bar with its numbers, which adds rows at the bottom. Without a maximum
/// the costliest pixel is the top of the scale.
pub fn draw(width: u32, height: u32, tests: &[Tests], top: Option<u64>) -> (Rgb8, Scale) {
    let costs: Vec<u64> = tests.iter().map(cost).collect();
    let scale = scale(&costs, top);
    let pixels = costs.iter().map(|&cost| color(cost as f32 / scale.top as f32)).collect();
    let mut picture = Rgb8 { width, height, pixels };
    add_bar(&mut picture, &scale);
    (picture, scale)
}

fn cost(tests: &Tests) -> u64 {
    u64::from(tests.nodes) + u64::from(tests.triangles)
}

fn scale(costs: &[u64], top: Option<u64>) -> Scale {
    let maximum = costs.iter().copied().max().unwrap_or(0);
    let mut sorted = costs.to_vec();
    let middle = costs.len().saturating_sub(1) / 2;
    let median = if sorted.is_empty() { 0 } else { *sorted.select_nth_unstable(middle).1 };
    let sum: f64 = costs.iter().map(|&cost| cost as f64).sum();
    let mean = sum / costs.len().max(1) as f64;
    Scale { top: top.unwrap_or(maximum).max(1), maximum, mean, median }
}

/// The colour of a share of the scale.
fn color(share: f32) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (ANCHORS.len() - 1) as f32;
    let below = (place as usize).min(ANCHORS.len() - 2);
    let weight = place - below as f32;
    let mix = |a: u8, b: u8| (f32::from(a) + weight * (f32::from(b) - f32::from(a))).round() as u8;
    let (a, b) = (ANCHORS[below], ANCHORS[below + 1]);
    [mix(a[0], b[0]), mix(a[1], b[1]), mix(a[2], b[2])]
}

/// A bar of all colours with 0, the middle and the top of the scale under it.
fn add_bar(picture: &mut Rgb8, scale: &Scale) {
    let dot = (picture.width / 320).clamp(1, 6);
    let (bar, gap) = (6 * dot, 2 * dot);
    let first = picture.height;
    picture.height += bar + digits::SIZE[1] * dot + 2 * gap;
    picture.pixels.resize(picture.width as usize * picture.height as usize, [0; 3]);
    let last = picture.width.saturating_sub(1).max(1) as f32;
    for row in first + gap..first + gap + bar {
        for column in 0..picture.width {
            let index = row as usize * picture.width as usize + column as usize;
            picture.pixels[index] = color(column as f32 / last);
        }
    }
    let baseline = first + bar + gap + dot;
    let top_width = digits::width(scale.top, dot);
    let middle_width = digits::width(scale.top / 2, dot);
    // Numbers that would run into each other are left out: the scale is printed as text too.
    if picture.width < 3 * top_width.max(middle_width) {
        return;
    }
    digits::draw(picture, 0, [dot, baseline], dot);
    digits::draw(picture, scale.top / 2, [(picture.width - middle_width) / 2, baseline], dot);
    digits::draw(picture, scale.top, [picture.width - top_width - dot, baseline], dot);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tests(costs: &[u32]) -> Vec<Tests> {
        costs.iter().map(|&nodes| Tests { nodes, triangles: 0, rays: 1 }).collect()
    }

    #[test]
    fn the_scale_is_that_of_the_costs() {
        let (picture, scale) = draw(2, 2, &tests(&[0, 10, 20, 90]), None);
        assert_eq!(scale, Scale { top: 90, maximum: 90, mean: 30.0, median: 10 });
        assert_eq!([picture.pixels[0], picture.pixels[3]], [ANCHORS[0], ANCHORS[9]]);
        assert_eq!(picture.pixels.len(), 2 * picture.height as usize);
    }

    #[test]
    fn a_given_top_cuts_what_is_above() {
        let (picture, scale) = draw(2, 1, &tests(&[50, 100]), Some(50));
        assert_eq!((scale.top, scale.maximum), (50, 100));
        assert_eq!(picture.pixels[0], picture.pixels[1]);
    }

    #[test]
    fn any_size_and_any_count_can_be_drawn() {
        for width in [1, 2, 7, 640, 5000] {
            let (picture, _) = draw(width, 1, &tests(&vec![u32::MAX; width as usize]), None);
            assert!(picture.height > 1);
        }
        assert_eq!(draw(1, 1, &tests(&[0]), Some(0)).1.top, 1);
    }
}
