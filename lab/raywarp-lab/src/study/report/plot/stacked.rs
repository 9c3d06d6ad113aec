//! Bars of shares that add to one.

use plotters::style::text_anchor::HPos;
use plotters::style::{RGBColor, WHITE};

use super::axis::Axis;
use super::bars::{fitting, names_width};
use super::canvas::{card, fill, legend, legend_height, lower_axis, text, text_width, Side};
use super::canvas::{AXIS_HEIGHT, INK, MARGIN, UNDER_TITLE, WIDTH};
use super::palette::Series;
use crate::study::report::format::percent;

use raywarp_cli::failure::Result;

/// All bars.
#[derive(Clone, Debug)]
pub struct Stacked {
    /// Over the plot.
    pub title: String,
    /// Under the axis: of what the shares are.
    pub axis: String,
    /// What the parts are, from left to right.
    pub parts: Vec<Series>,
    /// From top to bottom.
    pub stacks: Vec<Stack>,
}

/// One bar.
#[derive(Clone, Debug)]
pub struct Stack {
    /// At the left.
    pub name: String,
    /// 0 to 1, in the order of the parts.
    pub shares: Vec<f64>,
}

const THICKNESS: i32 = 20;
const PITCH: i32 = 28;

impl Stacked {
    /// As an SVG file.
    ///
    /// # Errors
    /// Where `plotters` fails, with its reason.
    pub fn svg(&self) -> Result<String> {
        let top = UNDER_TITLE + legend_height(&self.parts);
        let plot_height = PITCH * self.stacks.len().max(1) as i32;
        card(top + plot_height + AXIS_HEIGHT + MARGIN, &self.title, |area| {
            legend(area, UNDER_TITLE, &self.parts)?;
            let left = names_width(self.stacks.iter().map(|stack| stack.name.as_str()));
            let right = MARGIN + 22;
            let axes = (Axis::percents(), Axis::pixels(plot_height));
            let mut chart = lower_axis(area, (left, top, right, MARGIN), axes, &self.axis, Side::Bare)?;
            let width = f64::from(WIDTH - left - right);
            for (index, stack) in self.stacks.iter().enumerate() {
                let y = PITCH * index as i32 + (PITCH - THICKNESS) / 2;
                let middle = top + y + THICKNESS / 2;
                text(area, &fitting(&stack.name), (left - 8, middle), 12, INK, HPos::Right)?;
                let (near, far) = (f64::from(plot_height - y - THICKNESS), f64::from(plot_height - y));
                for (from, to, part) in segments(&self.parts, &stack.shares) {
                    fill(&mut chart, [(100.0 * from, near), (100.0 * to, far)], part.colour)?;
                    let label = percent(to - from);
                    if f64::from(text_width(&label, 11) + 6) < width * (to - from) {
                        let x = left + (width * 0.5 * (from + to)).round() as i32;
                        text(area, &label, (x, middle), 11, over(part.colour), HPos::Center)?;
                    }
                }
            }
            Ok(())
        })
    }
}

/// Where each part begins and ends.
fn segments<'a>(parts: &'a [Series], shares: &[f64]) -> Vec<(f64, f64, &'a Series)> {
    let mut from = 0.0;
    let mut segment = |(part, share): (&'a Series, &f64)| {
        let share = if share.is_finite() { share.clamp(0.0, 1.0 - from) } else { 0.0 };
        let start = from;
        from = (from + share).min(1.0);
        (start, from, part)
    };
    parts.iter().zip(shares).map(&mut segment).collect()
}

/// Letters that read on a colour.
fn over(colour: RGBColor) -> RGBColor {
    let RGBColor(red, green, blue) = colour;
    let light = 0.3 * f64::from(red) + 0.59 * f64::from(green) + 0.11 * f64::from(blue);
    if light > 150.0 {
        INK
    } else {
        WHITE
    }
}
