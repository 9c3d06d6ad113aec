//! How long the threads of a frame take.

use super::super::document::Picture;
use super::super::format::{number, percent};
use super::super::plot::{Histograms, Panel};
use super::{distinct, Page};
use crate::study::findings::{Load, SceneStudy};
use raywarp_cli::columns::{left, right};
use raywarp_cli::failure::Result;

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("load", "Load");
    page.document.say(
        "Every thread, one a pixel, measures its own time in a frame, by the kernel that counts tests. On a GPU the threads \
         of a warp wait for each other before the last clock is read, so their times are about the same. Balance is \
         therefore by work, nodes and triangles of a pixel: the mean over the pixels of a warp over the most, 100 % where \
         all have as much; that of a block of 8x16 likewise. The heat maps are what the paper's figure 2 shows; where \
         the picture is wide, a dot is the mean over a square of pixels.",
    );
    page.each_scene("times of threads", |scene| !scene.loads.is_empty(), scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    let rows: Vec<&Load> = scene.loads.iter().collect();
    let columns = [
        left("structure", |row: &&Load| row.structure.clone()),
        left("frame", |row: &&Load| row.rays.clone()),
        left("unit", |row: &&Load| row.unit.to_owned()),
        right("mean", |row: &&Load| number(row.time.mean)),
        right("median", |row: &&Load| number(row.time.median)),
        right("95 % within", |row: &&Load| number(row.time.p95)),
        right("most", |row: &&Load| number(row.time.most)),
        right("warp balance", |row: &&Load| percent(row.warp_balance)),
        right("block balance", |row: &&Load| percent(row.block_balance)),
    ];
    page.document.table("Time of a thread.", &columns, &rows);
    for load in rows.iter().filter(|load| !load.picture.is_empty()) {
        let caption = format!(
            "Heat map of the time of each pixel's thread: {}, {}, {}. The brightest colour is {} {} or more.",
            scene.name,
            load.structure,
            load.rays,
            number(load.brightest),
            load.unit
        );
        let words = ["heat", &scene.name, &load.structure, &load.rays];
        page.document.figure(&words, Picture::Png(load.picture.clone()), caption);
    }
    for rays in distinct(rows.iter().map(|load| load.rays.as_str())) {
        histograms(page, scene, rays)?;
    }
    Ok(())
}

fn histograms(page: &mut Page, scene: &SceneStudy, rays: &str) -> Result<()> {
    let shown = scene.loads.iter().filter(|load| load.rays == rays && !load.time.histogram.is_empty());
    let panel = |load: &'_ Load| page.structures.series(&load.structure).colour;
    let panels: Vec<Panel> = shown
        .clone()
        .map(|load| Panel { name: load.structure.clone(), colour: panel(load), distribution: &load.time })
        .collect();
    let Some(unit) = shown.map(|load| load.unit).next() else {
        return Ok(());
    };
    let title = format!("{}: time of a thread, frame '{rays}'", scene.name);
    let svg = Histograms { title, axis: format!("time of a thread, {unit}"), panels }.svg()?;
    let caption =
        format!("How long a thread takes in the frame '{rays}': share of the threads in each column. Columns are drawn equally wide.");
    page.plot(scene, &format!("load {rays}"), svg, caption);
    Ok(())
}
