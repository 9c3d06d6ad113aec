//! Lines through points, both axes logarithmic.

use plotters::prelude::Circle;
use plotters::style::{Color, RGBColor};

use super::axis::Axis;
use super::canvas::{card, failed, legend, legend_height, lower_axis, stroke, Side};
use super::canvas::{AXIS_HEIGHT, MARGIN, UNDER_TITLE};
use super::palette::Series;

use raywarp_cli::failure::Result;

/// All lines of a plot.
#[derive(Clone, Debug)]
pub struct Lines {
    /// Over the plot.
    pub title: String,
    /// Under the lower axis, and beside the left one.
    pub axes: (String, &'static str),
    /// Each with its points.
    pub lines: Vec<Line>,
}

/// A line.
#[derive(Clone, Debug)]
pub struct Line {
    /// In the legend.
    pub series: Series,
    /// From left to right. Those without a place on a logarithmic axis are left out.
    pub points: Vec<(f64, f64)>,
    /// Whether it is a guide for the eye: thin and without marks.
    pub guide: bool,
}

const HEIGHT: i32 = 300;
const LEFT: i32 = 84;

impl Lines {
    /// As an SVG file.
    ///
    /// # Errors
    /// Where `plotters` fails, with its reason.
    pub fn svg(&self) -> Result<String> {
        let names: Vec<Series> = self.lines.iter().map(|line| line.series.clone()).collect();
        let top = UNDER_TITLE + legend_height(&names);
        card(top + HEIGHT + AXIS_HEIGHT + MARGIN, &self.title, |area| {
            legend(area, UNDER_TITLE, &names)?;
            let all = || self.lines.iter().flat_map(|line| &line.points).filter(|point| has_place(point));
            let axes = (Axis::log(all().map(|point| point.0)), Axis::log(all().map(|point| point.1)));
            let edges = (LEFT, top, MARGIN + 20, MARGIN);
            let mut chart = lower_axis(area, edges, axes, &self.axes.0, Side::Marked(self.axes.1))?;
            // Guides lie under what is measured.
            let (guides, measured): (Vec<&Line>, Vec<&Line>) = self.lines.iter().partition(|line| line.guide);
            for line in guides.into_iter().chain(measured) {
                let points: Vec<(f64, f64)> = line.points.iter().copied().filter(has_place).collect();
                stroke(&mut chart, points.clone(), line.series.colour, if line.guide { 1 } else { 2 })?;
                let colour: RGBColor = line.series.colour;
                let dots =
                    points.into_iter().filter(|_| !line.guide).map(|point| Circle::new(point, 4, colour.filled()));
                chart.draw_series(dots).map_err(failed)?;
            }
            Ok(())
        })
    }
}

fn has_place((x, y): &(f64, f64)) -> bool {
    [x, y].iter().all(|value| value.is_finite() && **value > 0.0)
}
