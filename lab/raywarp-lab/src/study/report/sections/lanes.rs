//! How the lanes of a warp are used.

use super::super::format::{count, percent};
use super::super::plot::{Palette, Stack, Stacked};
use super::{distinct, Page};
use crate::study::findings::{LaneUse, SceneStudy};
use raywarp_cli::columns::{left, right};
use raywarp_cli::failure::Result;

/// What a lane may do in a step, as the legend has it.
const USES: [&str; 5] = [
    "useful",
    "waits with triangles while others visit nodes",
    "waits with nodes while others test triangles",
    "its ray is done",
    "has no ray of this kind",
];

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("lanes", "SIMD efficiency");
    page.document.say(
        "A model, the same on every device: warps of 32 lanes are followed on the CPU, all lanes in step, through each form \
         of the traversal loop over a BVH2, medium. A step is a node or a triangle, and costs the same whatever it is; \
         useful are the lanes that do one of their own, and their share is the SIMD efficiency. Warps are taken evenly \
         over the batch or the picture. In frames, rays of the same bounce and towards the same light are in step.",
    );
    page.each_scene("counts of lanes", |scene| !scene.lanes.is_empty(), scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    let uses = Palette::of(USES);
    let kinds = distinct(scene.lanes.iter().map(|row| row.rays.as_str()));
    // Forms of the loop under one another, for each kind of rays.
    let rows: Vec<&LaneUse> =
        kinds.iter().flat_map(|kind| scene.lanes.iter().filter(move |row| row.rays == *kind)).collect();
    let stack = |row: &&LaneUse| Stack {
        name: format!("{}: {}", row.rays, row.form),
        shares: vec![row.useful, row.boxes, row.leaves, row.finished, row.shading],
    };
    let plot = Stacked {
        title: format!("{}: what the lanes of a warp do", scene.name),
        axis: "share of the lanes' steps, %".to_owned(),
        parts: USES.map(|name| uses.series(name)).to_vec(),
        stacks: rows.iter().map(stack).collect(),
    };
    let caption = "What the lanes of a warp do, by kind of rays and form of the loop: shares of the lanes' steps.";
    page.plot(scene, "lanes", plot.svg()?, caption);
    let columns = [
        left("rays", |row: &&LaneUse| row.rays.clone()),
        left("loop", |row: &&LaneUse| row.form.clone()),
        right("warp steps", |row: &&LaneUse| count(row.steps)),
        right("useful", |row: &&LaneUse| percent(row.useful)),
        right("waits with triangles", |row: &&LaneUse| percent(row.boxes)),
        right("waits with nodes", |row: &&LaneUse| percent(row.leaves)),
        right("ray done", |row: &&LaneUse| percent(row.finished)),
        right("no ray", |row: &&LaneUse| percent(row.shading)),
    ];
    page.document.table("Shares of the lanes' steps.", &columns, &rows);
    Ok(())
}
