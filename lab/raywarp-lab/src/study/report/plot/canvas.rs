//! What all plots share: the card, its title, legends, texts and the frame of the axes.

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::Shift;
use plotters::prelude::{Cartesian2d, DrawingArea, IntoDrawingArea, PathElement, Rectangle, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, RGBColor, TextStyle, WHITE};

use super::axis::Axis;
use super::palette::Series;
use crate::study::report::document::clean;

use raywarp_cli::failure::{Failure, Result};

/// Width of every plot.
pub const WIDTH: i32 = 760;
/// Free at the edges of the card.
pub const MARGIN: i32 = 14;
/// Under an axis, for its marks and its name.
pub const AXIS_HEIGHT: i32 = 44;

/// Text, and the quieter kind.
pub const INK: RGBColor = RGBColor(0x22, 0x26, 0x2b);
pub const FAINT: RGBColor = RGBColor(0x60, 0x66, 0x6e);
const MESH: RGBColor = RGBColor(0xe2, 0xe5, 0xe9);

const TITLE_SIZE: i32 = 15;
const LEGEND_ROW: i32 = 18;
/// `plotters` takes heights of lines and writes heights of letters.
const LINE_HEIGHT: f64 = 1.24;
/// Letters of a title at most, so that it does not leave the card.
const TITLE_LETTERS: usize = 88;

/// A card under the pen.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// A pair of axes on it: x of the plot's own kind, y in pixels or shares.
pub type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// A white card of some height with a title, and what `draw` puts on it.
pub fn card(height: i32, title: &str, draw: impl FnOnce(&Area) -> Result<()>) -> Result<String> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (WIDTH as u32, height.max(1) as u32)).into_drawing_area();
        area.fill(&WHITE).map_err(failed)?;
        let style = TextStyle::from(font(TITLE_SIZE).style(FontStyle::Bold)).color(&INK);
        area.draw_text(&shortened(title, TITLE_LETTERS), &style, (MARGIN, MARGIN)).map_err(failed)?;
        draw(&area)?;
        area.present().map_err(failed)?;
    }
    Ok(svg)
}

/// Where the title of a card ends.
pub const UNDER_TITLE: i32 = MARGIN + TITLE_SIZE + 12;

/// Height of a legend.
pub fn legend_height(series: &[Series]) -> i32 {
    LEGEND_ROW * legend_places(series).last().map_or(0, |place| place.1 + 1) + 6
}

/// Swatches and names, line after line from `top`.
pub fn legend(area: &Area, top: i32, series: &[Series]) -> Result<()> {
    for (one, (x, row)) in series.iter().zip(legend_places(series)) {
        let y = top + row * LEGEND_ROW;
        let swatch = Rectangle::new([(x, y + 2), (x + 11, y + 13)], one.colour.filled());
        area.draw(&swatch).map_err(failed)?;
        text(area, &legend_name(one), (x + 16, y + 8), 12, INK, HPos::Left)?;
    }
    Ok(())
}

fn legend_name(series: &Series) -> String {
    shortened(&series.name, 60)
}

/// Column in pixels and row of each entry.
fn legend_places(series: &[Series]) -> Vec<(i32, i32)> {
    let (mut x, mut row) = (MARGIN, 0);
    let place = |one: &Series| {
        let width = 16 + text_width(&legend_name(one), 12) + 18;
        if x > MARGIN && x + width > WIDTH - MARGIN {
            (x, row) = (MARGIN, row + 1);
        }
        let here = (x, row);
        x += width;
        here
    };
    series.iter().map(place).collect()
}

/// A line of text whose middle is at `y`.
pub fn text(area: &Area, text: &str, at: (i32, i32), size: i32, colour: RGBColor, side: HPos) -> Result<()> {
    let style = TextStyle::from(font(size)).color(&colour).pos(Pos::new(side, VPos::Center));
    area.draw_text(&clean(text), &style, at).map_err(failed)
}

fn font(size: i32) -> plotters::style::FontDesc<'static> {
    ("sans-serif", f64::from(size) * LINE_HEIGHT).into_font()
}

/// About how wide a text is. Fonts differ, and this is for a wide one.
pub fn text_width(text: &str, size: i32) -> i32 {
    (0.56 * f64::from(size) * text.chars().count() as f64).ceil() as i32
}

/// A text of at most so many letters.
pub fn shortened(text: &str, letters: usize) -> String {
    let text = clean(text);
    if text.chars().count() <= letters {
        return text;
    }
    let kept: String = text.chars().take(letters.saturating_sub(1)).collect();
    format!("{}…", kept.trim_end())
}

/// Axes in a part of a card, with the marks and the name of the lower one.
pub fn lower_axis<'a, 'b>(
    area: &'a Area<'b>,
    (left, top, right, bottom): (i32, i32, i32, i32),
    (x, y): (Axis, Axis),
    name: &str,
    side: Side,
) -> Result<Chart<'a, 'b>> {
    let mut chart = ChartBuilder::on(area)
        .margin_left(left - side.width())
        .margin_top(top)
        .margin_right(right)
        .margin_bottom(bottom)
        .x_label_area_size(AXIS_HEIGHT)
        .y_label_area_size(side.width())
        .build_cartesian_2d(x, y)
        .map_err(failed)?;
    let mut mesh = chart.configure_mesh();
    mesh.bold_line_style(MESH)
        .axis_style(MESH)
        .label_style(TextStyle::from(font(11)).color(&FAINT))
        .axis_desc_style(TextStyle::from(font(12)).color(&INK))
        .x_desc(shortened(name, 90));
    match side {
        Side::Bare => {
            mesh.disable_y_axis().disable_y_mesh();
        }
        Side::Marked(name) => {
            mesh.y_desc(name);
        }
    }
    mesh.draw().map_err(failed)?;
    Ok(chart)
}

/// What is at the left of a plot.
#[derive(Clone, Copy)]
pub enum Side {
    /// Nothing of the axis: bars have their names there.
    Bare,
    /// Marks, and this name.
    Marked(&'static str),
}

impl Side {
    fn width(self) -> i32 {
        match self {
            Self::Bare => 0,
            Self::Marked(_) => 58,
        }
    }
}

/// A filled box of the chart, by its values.
pub fn fill(chart: &mut Chart, corners: [(f64, f64); 2], colour: RGBColor) -> Result<()> {
    chart.draw_series([Rectangle::new(corners, colour.filled())]).map_err(failed)?;
    Ok(())
}

/// A line through the chart, by its values.
pub fn stroke(chart: &mut Chart, points: Vec<(f64, f64)>, colour: RGBColor, width: u32) -> Result<()> {
    chart.draw_series([PathElement::new(points, colour.stroke_width(width))]).map_err(failed)?;
    Ok(())
}

/// The sentence of a plot that could not be drawn.
pub fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::new(format_args!("cannot draw a plot of the report: {error}"))
}
