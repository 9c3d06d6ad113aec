//! The report as files, of studies that are whole, empty or hostile.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use quick_xml::events::Event;
use quick_xml::Reader;
use raywarp::write::Outputs;
use tempfile::TempDir;

use super::{sample, sections, write};
use crate::study::findings::{Bin, Distribution, SceneStudy, Study};
use raywarp_cli::bench::Spread;
use raywarp_cli::failure::Result;
use raywarp_cli::interrupt::Interrupt;
use raywarp_cli::output::Target;

const HOSTILE: &str = "<script>alert(1)</script>& \"'|[x](y)\u{1}\n-->]]>";

const SECTIONS: [&str; 9] = ["structures", "growth", "speed", "stages", "tests", "load", "lanes", "sharing", "paths"];

fn written(study: &Study, folder: &Path) -> Result<Vec<PathBuf>> {
    let (run, interrupt) = (Outputs::default(), Interrupt::install());
    write(study, folder, Target { run: &run, interrupt: &interrupt })
}

/// A report in a folder of its own.
struct Report {
    _folder: TempDir,
    files: Vec<PathBuf>,
}

impl Report {
    fn of(study: &Study) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let files = written(study, &folder.path().join("a/new folder")).unwrap();
        Self { _folder: folder, files }
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.files.iter().find(|file| file.ends_with(name)).unwrap()).unwrap()
    }

    fn ending(&self, extension: &str) -> impl Iterator<Item = &Path> {
        let extension = extension.to_owned();
        let has = move |file: &&Path| file.extension().is_some_and(|end| end == extension.as_str());
        self.files.iter().map(PathBuf::as_path).filter(has)
    }

    /// Every SVG file, and the page.
    fn marked_up(&self) -> Vec<String> {
        self.ending("svg").chain(self.ending("html")).map(|file| fs::read_to_string(file).unwrap()).collect()
    }
}

/// Names of all elements and all attributes with their values. Panics where the text is not well-formed.
fn elements(text: &str) -> Vec<(String, Vec<(String, String)>)> {
    let mut reader = Reader::from_str(text);
    let mut elements = Vec::new();
    let mut depth = 0;
    loop {
        match reader.read_event().unwrap_or_else(|error| panic!("{error} at {}", reader.buffer_position())) {
            Event::Start(tag) => {
                depth += 1;
                elements.push(element(&tag));
            }
            Event::Empty(tag) => elements.push(element(&tag)),
            Event::End(_) => depth -= 1,
            Event::Eof => break,
            _ => (),
        }
    }
    assert_eq!(depth, 0, "an element is not closed");
    elements
}

fn element(tag: &quick_xml::events::BytesStart) -> (String, Vec<(String, String)>) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    let attributes = tag.attributes().map(Result::unwrap);
    let pairs = attributes.map(|attribute| (text(attribute.key.as_ref()), text(&attribute.value)));
    (text(tag.name().as_ref()), pairs.collect())
}

#[test]
fn the_page_has_every_section_and_needs_nothing_else() {
    let report = Report::of(&sample::study(&["test-a.obj", "test-b.obj"]));
    let page = report.text("report.html");
    let elements = elements(&page);
    for section in SECTIONS {
        let heading = |(name, attributes): &(String, Vec<(String, String)>)| {
            name == "h2" && attributes.iter().any(|(key, value)| key == "id" && value == section)
        };
        assert!(elements.iter().any(heading), "no section {section}");
    }
    for (name, attributes) in &elements {
        assert!(!["script", "link", "iframe", "object"].contains(&name.as_str()), "{name}");
        for (key, value) in attributes {
            let own = value.starts_with('#') || value.starts_with("data:image/png;base64,");
            assert!(!["src", "href", "xlink:href"].contains(&key.as_str()) || own, "{name} {key}={value}");
        }
    }
    assert!(!page.contains("http") && !page.contains("@import") && !page.contains("url("), "the page needs a network");
}

#[test]
fn markdown_shows_every_plot_and_no_other() {
    let report = Report::of(&sample::study(&["test-a.obj", "test-b.obj"]));
    let text = report.text("report.md");
    let shown: Vec<&str> = text.split("](plots/").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    let written: Vec<_> = report.ending("svg").chain(report.ending("png")).filter_map(Path::file_name).collect();
    assert!(shown.len() > 20);
    assert_eq!(shown, document_order(&report));
    assert_eq!(shown.len(), written.len());
}

fn document_order(report: &Report) -> Vec<&str> {
    let plots = report.files.iter().filter(|file| file.parent().is_some_and(|folder| folder.ends_with("plots")));
    plots.filter_map(|file| file.file_name()?.to_str()).collect()
}

#[test]
fn page_and_markdown_have_the_same_tables() {
    let report = Report::of(&sample::study(&["test-a.obj"]));
    let rows = report.text("report.html").matches("<tr>").count();
    let text = report.text("report.md");
    let tables = text.lines().filter(|line| line.starts_with("| ---")).count();
    assert_eq!(rows, text.lines().filter(|line| line.starts_with("| ")).count() - tables);
}

#[test]
fn plots_are_xml() {
    let report = Report::of(&sample::study(&["test-a.obj"]));
    let plots: Vec<&Path> = report.ending("svg").collect();
    assert!(plots.len() >= 13, "{plots:?}");
    plots
        .iter()
        .for_each(|plot| assert!(elements(&fs::read_to_string(plot).unwrap()).len() > 10, "{}", plot.display()));
}

#[test]
fn the_data_are_json() {
    let report = Report::of(&sample::study(&["test-a.obj"]));
    let data: serde_json::Value = serde_json::from_str(&report.text("study.json")).unwrap();
    assert_eq!(data["scenes"][0]["name"], "test-a.obj");
}

#[test]
fn a_hostile_name_is_text() {
    let mut study = sample::study(&[HOSTILE]);
    study.about.command = HOSTILE.to_owned();
    study.about.device = HOSTILE.to_owned();
    study.notes.push(HOSTILE.to_owned());
    study.scenes[0].structures[0].name = HOSTILE.to_owned();
    study.scenes[0].sharing[0].way = HOSTILE.to_owned();
    study.scenes[0].sharing[0].rays = HOSTILE.to_owned();
    let report = Report::of(&study);
    let pages = report.marked_up();
    assert!(pages.iter().filter(|page| page.contains("&lt;script&gt;alert(1)")).count() > 10);
    for page in &pages {
        assert!(!page.contains("<script") && !page.contains('\u{1}'));
        assert!(elements(page).iter().all(|element| element.0 != "script"));
    }
    let text = report.text("report.md");
    let outside_code = text.lines().filter(|line| !line.starts_with("    "));
    assert!(outside_code.clone().any(|line| line.contains("&lt;script&gt;")));
    outside_code.for_each(|line| assert!(!line.contains("<script>") && !line.contains("[x](y)"), "{line}"));
    for file in &report.files {
        let name = file.file_name().unwrap().to_str().unwrap();
        assert!(name.chars().all(|letter| letter.is_ascii_alphanumeric() || "-.".contains(letter)), "{name}");
    }
}

#[test]
fn what_was_not_measured_is_a_sentence() {
    let one = Report::of(&sample::empty()).text("report.md");
    assert_eq!(one.matches("This run has no").count(), SECTIONS.len() + 1, "{one}");

    let mut study = sample::study(&["test-a.obj"]);
    study.scenes.push(sample::empty_scene("test-b.obj"));
    let both = Report::of(&study).text("report.md");
    assert_eq!(both.matches("of this scene.").count(), SECTIONS.len() - 1);
    assert!(!both.contains("| --- |\n\n"), "a table without rows");
}

#[test]
fn a_second_report_takes_the_place_of_the_first() {
    let folder = tempfile::tempdir().unwrap();
    written(&sample::study(&["test-a.obj"]), folder.path()).unwrap();
    written(&sample::empty(), folder.path()).unwrap();
    assert!(fs::read_to_string(folder.path().join("report.md")).unwrap().contains("This run has no scene."));
}

#[test]
fn a_folder_that_cannot_be_is_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a file");
    fs::write(&file, "").unwrap();
    let error = written(&sample::empty(), &file).unwrap_err();
    assert!(error.to_string().starts_with("cannot make the folder"), "{error}");
    assert!(error.to_string().ends_with("give a folder that you may write to"), "{error}");

    fs::create_dir_all(folder.path().join("b/report.md")).unwrap();
    let error = written(&sample::empty(), &folder.path().join("b")).unwrap_err();
    assert!(error.to_string().contains("it is a directory"), "{error}");
}

/// Numbers as measurements have them, and as they should not.
fn number() -> impl Strategy<Value = f64> {
    let odd = [0.0, -0.0, -1.0, 1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 5e-324, 1e-300];
    prop_oneof![0.0..1e6f64, proptest::sample::select(odd.to_vec()), any::<f64>()]
}

fn distribution() -> impl Strategy<Value = Distribution> {
    let bin = (number(), number(), number()).prop_map(|(from, to, share)| Bin { from, to, share });
    let histogram = proptest::collection::vec(bin, 0..20);
    (number(), number(), number(), number(), histogram).prop_map(|(mean, median, p95, most, histogram)| Distribution {
        mean,
        median,
        p95,
        most,
        histogram,
    })
}

/// Puts numbers everywhere, each once around.
fn disturb(scene: &mut SceneStudy, numbers: &[f64], distribution: impl Fn() -> Distribution) {
    let mut all = numbers.iter().copied().cycle();
    let mut next = || all.next().unwrap_or_default();
    scene.triangles = next() as usize;
    for one in &mut scene.structures {
        (one.stats.references, one.stats.sah_cost, one.stats.build_seconds, one.share_of_peak) =
            (next() as usize, next(), next(), Some(next()));
        one.rates.iter_mut().for_each(|rate| rate.mrays_per_s = spread(&mut next));
        one.frames.iter_mut().for_each(|frame| frame.ms = spread(&mut next));
    }
    for one in &mut scene.tests {
        (one.nodes, one.triangles, one.share_of_references) = (distribution(), distribution(), next());
    }
    for one in &mut scene.shares {
        (one.generation, one.intersection, one.shading) = (next(), next(), next());
    }
    for one in &mut scene.loads {
        (one.time, one.warp_balance, one.brightest) = (distribution(), next(), next());
    }
    for one in &mut scene.lanes {
        (one.useful, one.boxes, one.leaves, one.finished, one.shading) = (next(), next(), next(), next(), next());
    }
    scene.sharing.iter_mut().for_each(|one| (one.gain, one.mrays_per_s) = (next(), spread(&mut next)));
    scene.paths.iter_mut().for_each(|one| (one.gain, one.mrays_per_s) = (next(), next()));
}

fn spread(next: &mut impl FnMut() -> f64) -> Spread {
    Spread { median: next(), least: next(), most: next() }
}

fn copy(of: &Distribution) -> Distribution {
    let histogram = of.histogram.iter().map(|&Bin { from, to, share }| Bin { from, to, share }).collect();
    Distribution { histogram, ..*of }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_number_stops_the_report(numbers in proptest::collection::vec(number(), 1..60), spread in distribution()) {
        let mut study = sample::study(&["test-a.obj"]);
        let mut all = numbers.iter().copied().cycle();
        study.growth.iter_mut().for_each(|one| one.seconds = all.next().unwrap_or_default());
        study.growth.iter_mut().for_each(|one| one.triangles = all.next().unwrap_or_default() as usize);
        disturb(&mut study.scenes[0], &numbers, || copy(&spread));
        let document = sections::document(&study).unwrap();
        for figure in document.figures() {
            if let super::document::Picture::Svg(text) = &figure.picture {
                let size = text.len();
                prop_assert!(size < 1 << 20, "{} has {size} bytes", figure.file);
                prop_assert!(!text.contains("NaN") && !text.contains("inf\""), "{}", figure.file);
            }
        }
        elements(&super::html::page(&document));
        serde_json::to_vec(&study).unwrap();
    }
}

/// For eyes: `RAYWARP_SAMPLE_REPORT=FOLDER cargo test -p raywarp-cli --bin raywarp -- --ignored sample_to_look_at`.
#[test]
#[ignore = "writes a report to look at"]
fn a_sample_to_look_at() {
    let folder = std::env::var_os("RAYWARP_SAMPLE_REPORT").expect("RAYWARP_SAMPLE_REPORT names a folder");
    let mut study = sample::study(&["test <b> & c"]);
    study.scenes.push(sample::empty_scene("test-empty.obj"));
    written(&study, Path::new(&folder)).unwrap();
}
