//! What each pixel cost, as colours.
//!
//! The cost of a pixel is its triangle tests plus its node visits, for all of its rays. The scale is linear from 0 to
//! a maximum, by the colours of [`raywarp_core::false_color::heat`], whose lightness grows evenly, so that twice as
//! bright is about twice the cost, also in black and white and to the colour-blind. What is above the maximum is shown
//! like the maximum.

use std::fmt;

use raywarp_core::false_color::{cost, heat};
use raywarp_core::traversal::Tests;

use super::{digits, Rgb8};

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
    let pixels = costs.iter().map(|&cost| heat(cost as f32 / scale.top as f32)).collect();
    let mut picture = Rgb8 { width, height, pixels };
    add_bar(&mut picture, &scale);
    (picture, scale)
}

/// As [`draw`], of any cost, and without the bar.
pub fn colours(width: u32, height: u32, costs: &[u32], top: u32) -> Rgb8 {
    Rgb8 { width, height, pixels: costs.iter().map(|&cost| heat(cost as f32 / top.max(1) as f32)).collect() }
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
            picture.pixels[index] = heat(column as f32 / last);
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
    use raywarp_core::false_color::HEAT;

    use super::*;

    fn tests(costs: &[u32]) -> Vec<Tests> {
        costs.iter().map(|&nodes| Tests { nodes, triangles: 0, rays: 1 }).collect()
    }

    #[test]
    fn the_scale_is_that_of_the_costs() {
        let (picture, scale) = draw(2, 2, &tests(&[0, 10, 20, 90]), None);
        assert_eq!(scale, Scale { top: 90, maximum: 90, mean: 30.0, median: 10 });
        assert_eq!([picture.pixels[0], picture.pixels[3]], [HEAT[0], HEAT[9]]);
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
