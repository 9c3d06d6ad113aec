//! What was measured, on what, and with what.

use super::super::format::{count, number, NONE};
use super::Page;
use crate::study::findings::{About, SceneStudy};
use raywarp_cli::columns::{left, right};
use raywarp_cli::paper;

pub(super) fn show(page: &mut Page) {
    let study = page.study;
    let run = if study.about.quick { "the short run" } else { "the full run" };
    page.document.say(format!(
        "Structures for ray tracing, what rays cost in them, and ways to share out the work, measured on one machine by \
         {run} of this command:"
    ));
    page.document.code(&study.about.command);
    page.document.say(format!(
        "It follows {}, which the sections below call the paper, and gives what that reports where it reports any.",
        paper::CITATION
    ));
    page.document.say("Of repeated measurements the median is given, with the least and the most in brackets.");
    let columns = [left("Machine and program", |row: &Fact| row.0.to_owned()), left("", |row: &Fact| row.1.clone())];
    page.document.table("What was measured on, and with what.", &columns, &facts(&study.about));
    show_scenes(page);
    if !study.notes.is_empty() {
        page.document.say("Notes on this run:");
    }
    page.document.list(study.notes.clone());
}

fn show_scenes(page: &mut Page) {
    let scenes: Vec<&SceneStudy> = page.study.scenes.iter().collect();
    let columns = [
        left("Scene", |scene: &&SceneStudy| scene.name.clone()),
        right("triangles", |scene: &&SceneStudy| count(scene.triangles)),
        right("picture, pixels", |scene: &&SceneStudy| format!("{}×{}", scene.picture[0], scene.picture[1])),
    ];
    if scenes.is_empty() {
        page.document.say("This run has no scene.");
    }
    page.document.table("The scenes; triangles are those that a ray can hit.", &columns, &scenes);
}

type Fact = (&'static str, String);

fn facts(about: &About) -> Vec<Fact> {
    let of = |value: Option<String>| value.unwrap_or(NONE.to_owned());
    let facts = [
        ("device", about.device.clone()),
        ("driver", of(about.driver.clone())),
        ("highest clock, MHz", of(about.clock_mhz.map(count))),
        ("multiprocessors", of(about.multiprocessors.map(count))),
        ("peak single-precision arithmetic, TFLOP/s", of(about.peak_flops.map(|flops| number(1e-12 * flops)))),
        ("CPU threads", count(about.cpu_threads)),
        ("raywarp", about.version.to_owned()),
        ("commit", of(about.commit.map(str::to_owned))),
    ];
    facts.into_iter().filter(|fact| fact.1 != NONE).collect()
}
