//! How the time to build grows.

use super::super::document::Picture;
use super::super::format::{count, number};
use super::super::plot::{Line, Lines, Palette, Series};
use super::{distinct, Page};
use crate::study::findings::Growth;
use raywarp_cli::columns::{left, right};
use raywarp_cli::failure::Result;

/// The name of the line to compare with.
const GUIDE: &str = "N log N through the first point";

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("growth", "Growth of the time to build");
    page.document.say(
        "Each builder is given ever more triangles, strewn evenly in a cube, and timed, by all threads of the CPU: the least \
         of as many builds as fit into 0.3 s, and of one at least. A straight line in the plot is a power of the number \
         of triangles; the thin line is N log N, and begins where the first builder does.",
    );
    let rows: Vec<&Growth> = page.study.growth.iter().collect();
    if rows.is_empty() {
        page.document.say("This run has no times of growing scenes.");
        return Ok(());
    }
    let title = "Time to build over triangles".to_owned();
    let plot = Lines { title, axes: ("triangles".to_owned(), "seconds"), lines: lines(page) };
    let caption = "Time to build over the number of triangles, both axes logarithmic.";
    page.document.figure(&["growth"], Picture::Svg(plot.svg()?), caption);
    let columns = [
        left("builder", |row: &&Growth| row.builder.clone()),
        right("triangles", |row: &&Growth| count(row.triangles)),
        right("build, s", |row: &&Growth| number(row.seconds)),
        right("a triangle, ns", |row: &&Growth| number(1e9 * row.seconds / row.triangles as f64)),
    ];
    page.document.table("Time to build over so many triangles.", &columns, &rows);
    Ok(())
}

fn lines(page: &Page) -> Vec<Line> {
    let growth = &page.study.growth;
    let builders = distinct(growth.iter().map(|one| one.builder.as_str()));
    let points = |builder: &str| {
        let own = growth.iter().filter(|one| one.builder == builder);
        let mut points: Vec<_> = own.map(|one| (one.triangles as f64, one.seconds)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let line = |builder: &&str| Line { series: page.structures.series(builder), points: points(builder), guide: false };
    let mut lines: Vec<Line> = builders.iter().map(line).collect();
    lines.extend(guide(&lines));
    lines
}

/// From the first point of the first line as far as any goes.
fn guide(lines: &[Line]) -> Option<Line> {
    let usable = |point: &&(f64, f64)| point.0 > 1.0 && point.1.is_finite() && point.1 > 0.0;
    let &(first, seconds) = lines.first()?.points.iter().find(usable)?;
    let last = lines.iter().flat_map(|line| &line.points).map(|point| point.0).fold(first, f64::max);
    let steps = 16;
    let at = |step: i32| first * (last / first).powf(f64::from(step) / f64::from(steps));
    let points = (0..=steps).map(at).map(|n| (n, seconds * n * n.ln() / (first * first.ln()))).collect();
    let colour = Palette::guide();
    Some(Line { series: Series { name: GUIDE.to_owned(), colour }, points, guide: true })
}
