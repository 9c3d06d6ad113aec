//! Bars from left to right, in groups.

use plotters::style::text_anchor::HPos;
use plotters::style::RGBColor;

use super::axis::Axis;
use super::canvas::{card, fill, legend, legend_height, lower_axis, shortened, stroke, text, text_width, Side};
use super::canvas::{Area, Chart};
use super::canvas::{AXIS_HEIGHT, FAINT, INK, MARGIN, UNDER_TITLE, WIDTH};
use super::palette::Series;

use raywarp_cli::failure::Result;

/// Bars of all groups.
#[derive(Clone, Debug)]
pub struct Bars {
    /// Over the plot.
    pub title: String,
    /// Under the axis: what the length is, and its unit.
    pub axis: String,
    /// Whether the axis is logarithmic; else it starts at zero.
    pub log: bool,
    /// A value that a line is drawn through.
    pub line: Option<f64>,
    /// From top to bottom.
    pub groups: Vec<Group>,
    /// What the colours are; nothing where the groups' names say it.
    pub legend: Vec<Series>,
}

/// Bars under one name.
#[derive(Clone, Debug)]
pub struct Group {
    /// At the left.
    pub name: String,
    /// From top to bottom.
    pub bars: Vec<Bar>,
}

/// One bar.
#[derive(Clone, Debug)]
pub struct Bar {
    /// As the axis has it. None is drawn for what is not a number.
    pub value: f64,
    /// At its end.
    pub label: String,
    /// Of the bar.
    pub colour: RGBColor,
}

/// Pixels between groups.
const GAP: i32 = 10;
/// Letters of a name at most.
const NAME_LETTERS: usize = 40;
/// Letters of values.
const LABEL_SIZE: i32 = 11;

/// Where a plot of bars is on its card, in pixels.
struct Frame {
    left: i32,
    top: i32,
    right: i32,
    height: i32,
    thickness: i32,
}

impl Bars {
    /// As an SVG file.
    ///
    /// # Errors
    /// Where `plotters` fails, with its reason.
    pub fn svg(&self) -> Result<String> {
        let frame = self.frame();
        let Frame { left, top, right, height, .. } = frame;
        card(top + height + AXIS_HEIGHT + MARGIN, &self.title, |area| {
            legend(area, UNDER_TITLE, &self.legend)?;
            let axes = (self.x_axis(), Axis::pixels(height));
            let mut chart = lower_axis(area, (left, top, right, MARGIN), axes, &self.axis, Side::Bare)?;
            let mut y = GAP / 2;
            for group in &self.groups {
                self.draw(group, area, &mut chart, &frame, y)?;
                y += group_height(group, frame.thickness) + GAP;
            }
            if let Some(line) = self.line.filter(|line| line.is_finite()) {
                stroke(&mut chart, vec![(line, 0.0), (line, f64::from(height))], INK, 1)?;
            }
            Ok(())
        })
    }

    /// Draws a group whose upper edge is `y` pixels below that of the plot.
    fn draw(&self, group: &Group, area: &Area, chart: &mut Chart, frame: &Frame, y: i32) -> Result<()> {
        let &Frame { left, top, right, height, thickness } = frame;
        let x = self.x_axis();
        let middle = top + y + group_height(group, thickness) / 2;
        text(area, &fitting(&group.name), (left - 8, middle), 12, INK, HPos::Right)?;
        for (index, bar) in (0..).zip(&group.bars).filter(|(_, bar)| bar.value.is_finite()) {
            let y = y + index * thickness;
            let corners = [(x.near(), f64::from(height - y - thickness + 1)), (bar.value, f64::from(height - y))];
            fill(chart, corners, bar.colour)?;
            let end = left + (x.place(bar.value) * f64::from(WIDTH - left - right)).round() as i32;
            text(area, &bar.label, (end + 5, top + y + thickness / 2), LABEL_SIZE, FAINT, HPos::Left)?;
        }
        Ok(())
    }

    fn frame(&self) -> Frame {
        let (thickness, height) = self.heights();
        let left = names_width(self.groups.iter().map(|group| group.name.as_str()));
        let top = UNDER_TITLE + legend_height(&self.legend);
        Frame { left, top, right: self.labels_width(), height, thickness }
    }

    /// Thickness of a bar, and height of all.
    fn heights(&self) -> (i32, i32) {
        let bars: usize = self.groups.iter().map(|group| group.bars.len().max(1)).sum();
        let thickness = (420 / bars.max(1)).clamp(13, 20) as i32;
        let height = self.groups.iter().map(|group| group_height(group, thickness) + GAP).sum::<i32>();
        (thickness, height.max(thickness))
    }

    fn x_axis(&self) -> Axis {
        let values = self.groups.iter().flat_map(|group| &group.bars).map(|bar| bar.value).chain(self.line);
        if self.log {
            Axis::log(values)
        } else {
            Axis::linear(values)
        }
    }

    /// At the right, for the label of the longest bar.
    fn labels_width(&self) -> i32 {
        let labels = self.groups.iter().flat_map(|group| &group.bars).map(|bar| text_width(&bar.label, LABEL_SIZE));
        labels.max().unwrap_or(0).min(WIDTH / 3) + MARGIN + 6
    }
}

fn group_height(group: &Group, thickness: i32) -> i32 {
    thickness * group.bars.len().max(1) as i32
}

/// At the left, for the longest name.
pub(super) fn names_width<'a>(names: impl Iterator<Item = &'a str>) -> i32 {
    let widest = names.map(|name| text_width(&shortened(name, NAME_LETTERS), 12)).max();
    (widest.unwrap_or(0) + MARGIN + 8).max(40)
}

/// A name as it fits there.
pub(super) fn fitting(name: &str) -> String {
    shortened(name, NAME_LETTERS)
}
