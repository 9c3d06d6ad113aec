//! What rays cost.

use super::super::format::{count, number, percent, round_percent};
use super::super::plot::{Histograms, Panel};
use super::Page;
use crate::study::findings::{SceneStudy, TestCost};
use raywarp_cli::columns::{left, right};
use raywarp_cli::failure::Result;
use raywarp_cli::paper;

/// The rays whose histograms are shown.
const SHOWN: &str = "primary";

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("tests", "Tests per ray");
    page.document.say(
        "Every node that a ray visits and every triangle that it tests is counted, a triangle that is tested twice as two. \
         The shares are the mean of the triangles tested over all references of the structure, and over all triangles of \
         the scene.",
    );
    page.beside(&format!(
        "a ray tests about {} triangles, {} of all references and {} of all triangles; {} at most.",
        count(paper::TESTS_PER_RAY),
        round_percent(paper::SHARE_OF_REFERENCES),
        round_percent(paper::SHARE_OF_TRIANGLES),
        count(paper::MOST_TESTS)
    ));
    page.each_scene("counts of tests", |scene| !scene.tests.is_empty(), scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    let rows: Vec<&TestCost> = scene.tests.iter().collect();
    let columns = [
        left("structure", |row: &&TestCost| row.structure.clone()),
        left("rays", |row: &&TestCost| row.rays.clone()),
        right("rays counted", |row: &&TestCost| count(row.counted)),
        right("nodes, mean", |row: &&TestCost| number(row.nodes.mean)),
        right("median", |row: &&TestCost| number(row.nodes.median)),
        right("95 % within", |row: &&TestCost| number(row.nodes.p95)),
        right("most", |row: &&TestCost| number(row.nodes.most)),
        right("triangles, mean", |row: &&TestCost| number(row.triangles.mean)),
        right("median", |row: &&TestCost| number(row.triangles.median)),
        right("95 % within", |row: &&TestCost| number(row.triangles.p95)),
        right("most", |row: &&TestCost| number(row.triangles.most)),
        right("of references", |row: &&TestCost| percent(row.share_of_references)),
        right("of triangles", |row: &&TestCost| percent(row.share_of_triangles)),
    ];
    page.document.table("Nodes visited and triangles tested by a ray.", &columns, &rows);

    let panel = |row: &'_ &TestCost| -> bool { row.rays == SHOWN && !row.triangles.histogram.is_empty() };
    let panels: Vec<Panel> = (rows.iter().copied().filter(panel))
        .map(|row| Panel {
            name: row.structure.clone(),
            colour: page.structures.series(&row.structure).colour,
            distribution: &row.triangles,
        })
        .collect();
    if !panels.is_empty() {
        let title = format!("{}: triangles tested by a {SHOWN} ray", scene.name);
        let svg = Histograms { title, axis: "triangles tested".to_owned(), panels }.svg()?;
        let caption = format!(
            "How many triangles a {SHOWN} ray tests: share of the rays in each column. Columns are drawn equally wide."
        );
        page.plot(scene, "tests", svg, caption);
    }
    Ok(())
}
