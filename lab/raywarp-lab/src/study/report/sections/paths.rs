//! Paths of several bounces.

use super::super::format::{count, number, spread, times};
use super::super::plot::{Bar, Bars, Group, Palette};
use super::{distinct, Page};
use crate::study::findings::{PathWay, SceneStudy};
use raywarp_cli::columns::{left, right};
use raywarp_cli::failure::Result;

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("paths", "Paths of several bounces");
    page.document.say(
        "The same paths are traced by one kernel from end to end, and bounce by bounce with rays that have ended taken out \
         between the kernels (a wavefront). 'Reflected' takes every surface for a mirror, 'diffuse' bounces at random. The \
         time is that of all kernels, added up, without what passes between them. The gain is the rate over that of one \
         kernel.",
    );
    page.each_scene("paths", |scene| !scene.paths.is_empty(), scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    let plot = bars(scene);
    page.plot(scene, "paths", plot.svg()?, "Rays of all bounces a second, by kind of path and way, with the gain.");
    let rows: Vec<&PathWay> = scene.paths.iter().collect();
    let columns = [
        left("paths", |row: &&PathWay| row.rays.clone()),
        left("way", |row: &&PathWay| row.way.clone()),
        right("bounces", |row: &&PathWay| count(row.bounces)),
        right("rays traced", |row: &&PathWay| count(row.traced)),
        right("time, ms", |row: &&PathWay| spread(row.ms)),
        right("of it sorting, ms", |row: &&PathWay| number(row.sorting_ms)),
        right("Mrays/s", |row: &&PathWay| number(row.mrays_per_s)),
        right("gain", |row: &&PathWay| times(row.gain)),
    ];
    page.document.table("Paths of several bounces.", &columns, &rows);
    Ok(())
}

fn bars(scene: &SceneStudy) -> Bars {
    let ways = Palette::of(scene.paths.iter().map(|row| row.way.as_str()));
    let bar = |row: &PathWay| Bar {
        value: row.mrays_per_s,
        label: format!("{} ({})", number(row.mrays_per_s), times(row.gain)),
        colour: ways.series(&row.way).colour,
    };
    let group = |kind: &str| Group {
        name: kind.to_owned(),
        bars: scene.paths.iter().filter(|row| row.rays == kind).map(bar).collect(),
    };
    Bars {
        title: format!("{}: paths of several bounces", scene.name),
        axis: "million rays a second".to_owned(),
        log: false,
        line: None,
        groups: distinct(scene.paths.iter().map(|row| row.rays.as_str())).into_iter().map(group).collect(),
        legend: ways.names().iter().map(|way| ways.series(way)).collect(),
    }
}
