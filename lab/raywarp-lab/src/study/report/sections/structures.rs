//! How large and how good the structures are, and how long they take to build.

use super::super::format::{count, number, percent};
use super::super::plot::{Bar, Bars, Group};
use super::Page;
use crate::study::findings::{SceneStudy, Structure};
use raywarp_cli::columns::{left, right, Column};
use raywarp_cli::failure::Result;
use raywarp_cli::messages;
use raywarp_cli::paper;

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("structures", "Structures");
    page.document.say(
        "Each structure is built over the same triangles, once, by all threads of the CPU, and its arrays are counted. \
         Layouts of one BVH2 are made of it, and their time is that of both. A reference is a triangle in a leaf; a \
         triangle in several leaves is a reference in each. The cost is what the surface area heuristic expects of a ray, \
         at one for a node and one for a triangle.",
    );
    let (triangles, references) = (count(paper::TRIANGLES), count(paper::REFERENCES));
    page.beside(&format!("{triangles} triangles become {references} references in the k-d tree."));
    page.each_scene("structures", |scene| !scene.structures.is_empty(), scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    let rows: Vec<&Structure> = scene.structures.iter().collect();
    page.document.table("Size, quality and time to build of each structure.", &columns(scene.triangles), &rows);

    let title = format!("{}: references over triangles", scene.name);
    let value = |one: &Structure| growth(one.stats.references, scene.triangles);
    let svg = bars(page, scene, title, "references over triangles", Some(1.0), value).svg()?;
    page.plot(scene, "references", svg, "References over triangles; the line is one reference a triangle.");

    let title = format!("{}: time to build", scene.name);
    let svg = bars(page, scene, title, "time to build, s (logarithmic)", None, |one| one.stats.build_seconds).svg()?;
    page.plot(scene, "build", svg, "Time to build each structure, on a logarithmic axis.");
    Ok(())
}

fn columns<'a>(triangles: usize) -> Vec<Column<'a, &'a Structure>> {
    vec![
        left("structure", |one: &&Structure| one.name.clone()),
        left("accel", |one: &&Structure| one.accel.clone()),
        left("tree", |one: &&Structure| one.tree.clone().unwrap_or_default()),
        right("nodes", |one: &&Structure| count(one.stats.nodes)),
        right("leaves", |one: &&Structure| count(one.stats.leaves)),
        right("references", |one: &&Structure| count(one.stats.references)),
        right("duplicates", |one: &&Structure| count(one.stats.duplicates)),
        right("duplicates over triangles", move |one: &&Structure| percent(growth(one.stats.duplicates, triangles))),
        right("depth", |one: &&Structure| count(one.stats.depth)),
        right("largest leaf", |one: &&Structure| count(one.stats.largest_leaf)),
        right("SAH cost", |one: &&Structure| number(one.stats.sah_cost)),
        right("memory", |one: &&Structure| messages::bytes(one.stats.bytes as u64)),
        right("build,\u{a0}s", |one: &&Structure| number(one.stats.build_seconds)),
    ]
}

/// A bar for each structure, in its colour; logarithmic where there is no line to compare with.
fn bars(
    page: &Page,
    scene: &SceneStudy,
    title: String,
    axis: &str,
    line: Option<f64>,
    value: impl Fn(&Structure) -> f64,
) -> Bars {
    let group = |one: &Structure| {
        let bar =
            Bar { value: value(one), label: number(value(one)), colour: page.structures.series(&one.name).colour };
        Group { name: one.name.clone(), bars: vec![bar] }
    };
    let groups = scene.structures.iter().map(group).collect();
    Bars { title, axis: axis.to_owned(), log: line.is_none(), line, groups, legend: Vec::new() }
}

fn growth(count: usize, triangles: usize) -> f64 {
    count as f64 / triangles as f64
}
