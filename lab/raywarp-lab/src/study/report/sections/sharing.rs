//! Ways to share out the work.

use super::super::format::{spread, times, NONE};
use super::super::plot::{Bar, Bars, Group};
use super::{distinct, Page};
use crate::study::findings::{BlockShape, SceneStudy, Sharing};
use raywarp_cli::columns::{left, right, Column};
use raywarp_cli::failure::Result;
use raywarp_cli::paper;

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("sharing", "Sharing out the work");
    page.document.say(
        "The same rays are traced through a BVH2, medium, in several ways; the ways of a group differ in one thing alone. \
         The gain is the rate over that of the group's plain way. Whole frames are rendered by blocks of several shapes \
         as well.",
    );
    if page.study.about.multiprocessors.is_none() {
        page.document.say(
            "On a CPU a warp is one thread and a block is what a thread does in a row: loops, queues and blocks are run \
             here to show that they work, and say nothing about a GPU.",
        );
    }
    let [least, most] = paper::EXPECTED_GAIN;
    page.beside(&format!("it expects {least} to {most} times the speed from balancing the load while it runs."));
    let has = |scene: &SceneStudy| !scene.sharing.is_empty() || !scene.shapes.is_empty();
    page.each_scene("ways to share out the work", has, scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    for name in distinct(scene.sharing.iter().map(|row| row.group.as_str())) {
        let rows: Vec<&Sharing> = scene.sharing.iter().filter(|row| row.group == name).collect();
        group(page, scene, name, &rows)?;
    }
    shapes(page, scene);
    Ok(())
}

fn group(page: &mut Page, scene: &SceneStudy, name: &str, rows: &[&Sharing]) -> Result<()> {
    let svg = bars(page, scene, name, rows).svg()?;
    let caption = format!("Gain by {name}; the line is the plain way.");
    page.plot(scene, &format!("sharing {name}"), svg, caption);
    let ways = distinct(rows.iter().map(|row| row.way.as_str()));
    let kinds = distinct(rows.iter().map(|row| row.rays.as_str()));
    let caption = format!("By {name}: million rays a second, and gain over the plain way.");
    page.document.table(caption, &columns(rows, &kinds), &ways);
    Ok(())
}

/// A row a way, two columns a kind of rays.
fn columns<'a>(rows: &'a [&'a Sharing], kinds: &[&'a str]) -> Vec<Column<'a, &'a str>> {
    let mut columns = vec![left("way", |way: &&str| (*way).to_owned())];
    for &kind in kinds {
        let cell = move |way: &str, text: fn(&Sharing) -> String| {
            let found = rows.iter().find(|row| row.way == way && row.rays == kind);
            found.map_or(NONE.to_owned(), |row| text(row))
        };
        columns.push(right(format!("{kind}, Mrays/s"), move |way: &&str| cell(way, |row| spread(row.mrays_per_s))));
        columns.push(right("gain", move |way: &&str| cell(way, |row| times(row.gain))));
    }
    columns
}

fn bars(page: &Page, scene: &SceneStudy, name: &str, rows: &[&Sharing]) -> Bars {
    let bar =
        |row: &&Sharing| Bar { value: row.gain, label: times(row.gain), colour: page.rays.series(&row.rays).colour };
    let group =
        |way: &str| Group { name: way.to_owned(), bars: rows.iter().filter(|row| row.way == way).map(bar).collect() };
    let kinds = distinct(rows.iter().map(|row| row.rays.as_str()));
    Bars {
        title: format!("{}: gain by {name}", scene.name),
        axis: "rate over that of the plain way".to_owned(),
        log: false,
        line: Some(1.0),
        groups: distinct(rows.iter().map(|row| row.way.as_str())).into_iter().map(group).collect(),
        legend: kinds.into_iter().map(|kind| page.rays.series(kind)).collect(),
    }
}

/// A row a shape, a column a frame.
fn shapes(page: &mut Page, scene: &SceneStudy) {
    let mut shapes: Vec<[u32; 2]> = Vec::new();
    for row in &scene.shapes {
        if !shapes.contains(&row.shape) {
            shapes.push(row.shape);
        }
    }
    let name = |shape: &[u32; 2]| format!("{}×{}", shape[0], shape[1]);
    let mut columns = vec![left("block, columns×rows", name)];
    for kind in distinct(scene.shapes.iter().map(|row| row.rays.as_str())) {
        columns.push(right(format!("frame '{kind}', ms"), move |shape: &[u32; 2]| {
            let same = |row: &&BlockShape| row.shape == *shape && row.rays == kind;
            scene.shapes.iter().find(same).map_or(NONE.to_owned(), |row| spread(row.ms))
        }));
    }
    page.document.table("Frames by blocks of several shapes.", &columns, &shapes);
}
