//! What each pixel cost, as colours.
//!
//! The cost of a pixel is its triangle tests plus its node visits, for all of its rays. The scale is linear from 0 to
//! a top, by the colours of [`raywarp_core::false_color::heat`], whose lightness grows evenly, so that twice as
//! bright is about twice the cost, also in black and white and to the colour-blind. What is above the top is shown
//! like the top, which is a percentile: one pixel that costs a hundred times as much as the others would leave them black.

use std::fmt;

use raywarp_core::false_color::{cost, heat};
use raywarp_core::traversal::Tests;

use super::{digits, Rgb8};

/// Percent of the pixels that a scale reaches to.
pub const PERCENT: usize = 99;

/// What the colours of a heat map mean: tests a pixel, nodes and triangles together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// What the brightest colour stands for.
    pub top: u64,
    /// Whether that is what [`PERCENT`] percent of the pixels do not exceed, and was not given.
    pub is_percentile: bool,
    /// The costliest pixel.
    pub maximum: u64,
    /// Mean over the pixels.
    pub mean: f64,
    /// Half of the pixels cost less than this or as much.
    pub median: u64,
}

impl fmt::Display for Scale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tests a pixel (nodes + triangles): black is 0, the brightest is {}", self.top)?;
        if self.is_percentile {
            write!(f, ", which {PERCENT} % of the pixels do not exceed")?;
        }
        write!(f, "; mean {:.1}, median {}, maximum {}", self.mean, self.median, self.maximum)
    }
}

/// Draws the cost of each pixel over a colour bar with its numbers, which adds rows at the bottom. Without a top, what
/// [`PERCENT`] percent of the pixels do not exceed is that of the scale.
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
    let [median, most] = [50, PERCENT].map(|percent| percentile(&mut sorted, percent).unwrap_or(0));
    let sum: f64 = costs.iter().map(|&cost| cost as f64).sum();
    let mean = sum / costs.len().max(1) as f64;
    Scale { top: top.unwrap_or(most).max(1), is_percentile: top.is_none(), maximum, mean, median }
}

/// The smallest value that so many percent of the values, up to 100, do not exceed; nothing where there are none. Changes
/// their order.
pub(crate) fn percentile<T: Copy + Ord>(values: &mut [T], percent: usize) -> Option<T> {
    let rank = (values.len() * percent).div_ceil(100).max(1);
    (rank <= values.len()).then(|| *values.select_nth_unstable(rank - 1).1)
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
        assert_eq!(scale, Scale { top: 90, is_percentile: true, maximum: 90, mean: 30.0, median: 10 });
        assert_eq!([picture.pixels[0], picture.pixels[3]], [HEAT[0], HEAT[9]]);
        assert_eq!(picture.pixels.len(), 2 * picture.height as usize);
    }

    #[test]
    fn one_costly_pixel_does_not_darken_the_others() {
        let mut costs = vec![50; 199];
        costs.push(5000);
        let (picture, scale) = draw(20, 10, &tests(&costs), None);
        assert_eq!((scale.top, scale.maximum), (50, 5000));
        assert!(picture.pixels[..200].iter().all(|&pixel| pixel == HEAT[9]));
        assert!(scale.to_string().contains("the brightest is 50, which 99 % of the pixels do not exceed"), "{scale}");
    }

    #[test]
    fn percentiles_are_values_that_are_there() {
        let mut values: Vec<u32> = (1..=1000).rev().collect();
        let of = |values: &mut [u32], percent| percentile(values, percent);
        assert_eq!(
            [0, 50, 99, 100].map(|percent| of(&mut values, percent)),
            [Some(1), Some(500), Some(990), Some(1000)]
        );
        assert_eq!((of(&mut [7], 99), of(&mut [], 99)), (Some(7), None));
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
