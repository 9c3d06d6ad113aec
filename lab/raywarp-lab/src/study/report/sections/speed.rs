//! Rays a second and time of a frame.

use super::super::format::{count, number, percent, spread, times, NONE};
use super::super::plot::{shortened, Bar, Bars, Group};
use super::{distinct, Page};
use crate::study::findings::{FrameTime, SceneStudy, Structure};
use raywarp_cli::columns::{left, right, Column};
use raywarp_cli::failure::Result;
use raywarp_cli::paper;

/// Structures whose bars a legend can tell apart; with more of them each bar has its name.
const TOLD_APART: usize = 8;
/// Letters of those names at most.
const NAME_LETTERS: usize = 30;

pub(super) fn show(page: &mut Page) -> Result<()> {
    page.document.section("speed", "Speed by structure");
    page.document.say(
        "Batches of rays of a kind are traced by each structure, and whole frames are rendered: 'primary' without shadows \
         and bounces, 'all' with shadows and five bounces. The time is that of the kernels. Brute force gets \
         fewer rays where all would take too long, every n-th run of 32, and what it could only do with too few to fill \
         a GPU is left out. Its share of the peak counts the arithmetic that every test needs, 48 operations.",
    );
    let [width, height] = paper::FIGURE_SIZE;
    page.beside(&format!(
        "its tree is {} times as fast as brute force without secondary rays; the figure in the mirrored box, at \
         {width}×{height}, took {} s.",
        paper::SPEED_UP,
        paper::FIGURE_SECONDS
    ));
    let timed = |one: &Structure| !one.rates.is_empty() || !one.frames.is_empty();
    page.each_scene("times of rays or frames", |scene| scene.structures.iter().any(timed), scene)
}

fn scene(page: &mut Page, scene: &SceneStudy) -> Result<()> {
    let rated: Vec<&Structure> = scene.structures.iter().filter(|one| !one.rates.is_empty()).collect();
    if !rated.is_empty() {
        let svg = bars(page, scene, &rated).svg()?;
        let caption = "Rays a second by kind of ray and structure, median, on a logarithmic axis.";
        page.plot(scene, "rays", svg, caption);
        let caption = "Million rays a second, by kind of ray.";
        page.document.table(caption, &rate_columns(&kinds(&rated)), &rated);
    }
    let brute = scene.structures.iter().find(|one| one.accel == "brute");
    let frames: Vec<Frame> = scene.structures.iter().flat_map(|one| Frame::all_of(one, brute)).collect();
    page.document.table("Whole frames.", &frame_columns(), &frames);
    let share = |one: &Structure| Some(format!("{}, {}", one.name, percent(one.share_of_peak?)));
    let shares: Vec<String> = scene.structures.iter().filter_map(share).collect();
    if !shares.is_empty() {
        let shares = shares.join("; ");
        page.document
            .say(format!("LeafRedistribution of the device's peak arithmetic that triangle tests reach: {shares}."));
    }
    Ok(())
}

/// Kinds of rays, in the order of the first structure that has them.
fn kinds<'a>(structures: &[&'a Structure]) -> Vec<&'a str> {
    distinct(structures.iter().flat_map(|one| &one.rates).map(|rate| rate.rays.as_str()))
}

fn rate_columns<'a>(kinds: &[&'a str]) -> Vec<Column<'a, &'a Structure>> {
    let mut columns = vec![left("structure", |one: &&Structure| one.name.clone())];
    for &kind in kinds {
        columns.push(right(kind, move |one: &&Structure| {
            let rate = one.rates.iter().find(|rate| rate.rays == kind);
            rate.map_or(NONE.to_owned(), |rate| spread(rate.mrays_per_s))
        }));
    }
    columns
}

fn bars(page: &Page, scene: &SceneStudy, structures: &[&Structure]) -> Bars {
    let named = structures.len() > TOLD_APART;
    let bar = |one: &Structure, kind: &str| {
        let rate = one.rates.iter().find(|rate| rate.rays == kind)?;
        let value = rate.mrays_per_s.median;
        let label =
            if named { format!("{} · {}", number(value), shortened(&one.name, NAME_LETTERS)) } else { number(value) };
        Some(Bar { value, label, colour: page.structures.series(&one.name).colour })
    };
    let group = |kind: &str| {
        let bars = structures.iter().filter_map(|one| bar(one, kind)).collect();
        Group { name: kind.to_owned(), bars }
    };
    let legend = structures.iter().map(|one| page.structures.series(&one.name));
    Bars {
        title: format!("{}: rays a second", scene.name),
        axis: "million rays a second (logarithmic)".to_owned(),
        log: true,
        line: None,
        groups: kinds(structures).into_iter().map(group).collect(),
        legend: if named { Vec::new() } else { legend.collect() },
    }
}

/// A frame by a structure, with what brute force takes for it.
struct Frame<'a> {
    structure: &'a str,
    frame: &'a FrameTime,
    brute_ms: Option<f64>,
}

impl<'a> Frame<'a> {
    fn all_of(structure: &'a Structure, brute: Option<&'a Structure>) -> impl Iterator<Item = Self> {
        structure.frames.iter().map(move |frame| {
            let same = brute.and_then(|brute| brute.frames.iter().find(|other| other.rays == frame.rays));
            Self { structure: &structure.name, frame, brute_ms: same.map(|frame| frame.ms.median) }
        })
    }
}

fn frame_columns<'a>() -> Vec<Column<'a, Frame<'a>>> {
    vec![
        left("structure", |row: &Frame| row.structure.to_owned()),
        left("frame", |row: &Frame| row.frame.rays.clone()),
        right("time, ms", |row: &Frame| spread(row.frame.ms)),
        right("rays traced", |row: &Frame| count(row.frame.traced)),
        right("Mrays/s", |row: &Frame| number(1e-3 * row.frame.traced as f64 / row.frame.ms.median)),
        right("speed over brute force", |row: &Frame| {
            row.brute_ms.map_or(NONE.to_owned(), |brute| times(brute / row.frame.ms.median))
        }),
    ]
}
