//! Histograms side by side.

use plotters::style::text_anchor::HPos;
use plotters::style::RGBColor;

use super::axis::Axis;
use super::canvas::{card, fill, lower_axis, shortened, stroke, text, Side};
use super::canvas::{AXIS_HEIGHT, FAINT, INK, MARGIN, UNDER_TITLE, WIDTH};
use crate::study::findings::Distribution;
use crate::study::report::format::number;

use raywarp_cli::failure::Result;

/// All histograms of a plot.
pub struct Histograms<'a> {
    /// Over the plot.
    pub title: String,
    /// Under each axis: what is spread, and its unit.
    pub axis: String,
    /// Two in a row.
    pub panels: Vec<Panel<'a>>,
}

/// One histogram.
pub struct Panel<'a> {
    /// Over it.
    pub name: String,
    /// Of its columns.
    pub colour: RGBColor,
    /// What it shows.
    pub distribution: &'a Distribution,
}

const COLUMNS: usize = 2;
const PANEL_WIDTH: i32 = WIDTH / COLUMNS as i32;
const PANEL_HEIGHT: i32 = 232;
/// Under its axis, before the next.
const UNDER_PANEL: i32 = 20;
/// At the right of an axis, where half of its last mark is.
const RIGHT: i32 = 28;
/// Over the axes of a panel: its name, and two numbers.
const HEAD: i32 = 44;

impl Histograms<'_> {
    /// As an SVG file.
    ///
    /// # Errors
    /// Where `plotters` fails, with its reason.
    pub fn svg(&self) -> Result<String> {
        let rows = self.panels.len().div_ceil(COLUMNS).max(1) as i32;
        let height = UNDER_TITLE + rows * PANEL_HEIGHT + MARGIN - UNDER_PANEL;
        card(height, &self.title, |area| {
            for (index, panel) in self.panels.iter().enumerate() {
                let left = PANEL_WIDTH * (index % COLUMNS) as i32;
                let top = UNDER_TITLE + PANEL_HEIGHT * (index / COLUMNS) as i32;
                let bottom = height - top - PANEL_HEIGHT + UNDER_PANEL;
                self.draw(area, panel, (left, top, bottom))?;
            }
            Ok(())
        })
    }

    fn draw(&self, area: &super::canvas::Area, panel: &Panel, (left, top, bottom): (i32, i32, i32)) -> Result<()> {
        let Distribution { median, p95, .. } = *panel.distribution;
        text(area, &shortened(&panel.name, 48), (left + MARGIN, top + 8), 12, INK, HPos::Left)?;
        let numbers = format!("median {} (line), 95 % within {} (pale line)", number(median), number(p95));
        text(area, &numbers, (left + MARGIN, top + 25), 11, FAINT, HPos::Left)?;

        let bins = panel.distribution.histogram.iter().filter(|bin| bin.from < bin.to);
        let x = Axis::edges(bins.clone().flat_map(|bin| [bin.from, bin.to]).collect());
        let y = Axis::linear(bins.clone().map(|bin| 100.0 * bin.share));
        let far = y.far();
        let right = WIDTH - left - PANEL_WIDTH + RIGHT;
        let edges = (left + MARGIN + 50, top + HEAD, right, bottom);
        let mut chart = lower_axis(area, edges, (x.clone(), y), &self.axis, Side::Marked("share, %"))?;
        for bin in bins.filter(|bin| bin.share.is_finite() && bin.share > 0.0) {
            fill(&mut chart, [(bin.from, 0.0), (bin.to, 100.0 * bin.share)], panel.colour)?;
        }
        for (value, colour) in [(p95, FAINT), (median, INK)] {
            if (x.near()..=x.far()).contains(&value) {
                stroke(&mut chart, vec![(value, 0.0), (value, far)], colour, 1)?;
            }
        }
        Ok(())
    }
}

const _: () = assert!(PANEL_HEIGHT > HEAD + AXIS_HEIGHT + UNDER_PANEL);
