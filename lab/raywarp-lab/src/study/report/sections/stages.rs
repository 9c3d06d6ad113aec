//! Where the time of a frame goes.

use super::super::format::{percent, round_percent};
use super::super::plot::{Palette, Stack, Stacked};
use super::Page;
use crate::study::findings::{SceneStudy, StageShares};
use raywarp_cli::columns::{left, right};
use raywarp_cli::failure::Result;
use raywarp_cli::paper;

const STAGES: [&str; 3] = ["generation", "intersection", "shading"];

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("stages", "Where the time goes");
    page.document.say(
        "Clocks are read within the kernel around the making of rays, the search for what they hit, and the shading, and \
         added over all threads of a frame. A thread that waits for others of its warp is in the stage where it waits. \
         The kernel with clocks is a little slower than the one without.",
    );
    page.beside(&format!("intersection takes more than {} of the time.", round_percent(paper::INTERSECTION)));
    page.each_scene("times of stages", |scene| !scene.shares.is_empty(), scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    let stages = Palette::of(["intersection", "generation", "shading"]);
    let stack = |row: &StageShares| Stack {
        name: format!("{}, {}", row.structure, row.rays),
        shares: vec![row.generation, row.intersection, row.shading],
    };
    let plot = Stacked {
        title: format!("{}: where the time of a frame goes", scene.name),
        axis: "share of the threads' time, %".to_owned(),
        parts: STAGES.map(|stage| stages.series(stage)).to_vec(),
        stacks: scene.shares.iter().map(stack).collect(),
    };
    page.plot(scene, "stages", plot.svg()?, "Shares of the threads' time, by structure and frame.");
    let rows: Vec<&StageShares> = scene.shares.iter().collect();
    let columns = [
        left("structure", |row: &&StageShares| row.structure.clone()),
        left("frame", |row: &&StageShares| row.rays.clone()),
        right("generation", |row: &&StageShares| percent(row.generation)),
        right("intersection", |row: &&StageShares| percent(row.intersection)),
        right("shading", |row: &&StageShares| percent(row.shading)),
    ];
    page.document.table("Shares of the threads' time.", &columns, &rows);
    Ok(())
}
