//! `raywarp-lab study`: the paper's questions, asked again on the device at hand.
//!
//! [`measure`] finds the answers, scene by scene; [`findings`] is what they are; [`report`] shows them.

pub mod findings;
mod measure;
mod options;
mod report;

use findings::Study;
use measure::Setting;
pub use options::StudyOptions;
use raywarp::write::Outputs;
use raywarp_cli::bench::subjects;
use raywarp_cli::failure::{ensure, Result};
use raywarp_cli::interrupt::Interrupt;
use raywarp_cli::messages;
use raywarp_cli::output::Target;
use raywarp_cli::render::{limit_threads, read};

/// Measures, and writes the report.
pub fn run(options: &StudyOptions) -> Result<()> {
    let interrupt = Interrupt::install();
    let mut outputs = Outputs::default();
    outputs.reads(&options.subjects.suite)?;
    let subjects = subjects(&options.subjects)?;
    outputs.reads(subjects.iter().filter_map(|subject| subject.file.as_deref()))?;
    limit_threads(options.threads)?;
    let device = raywarp_lab::open(options.device)?;
    messages::fallback(&device);
    report::check(&options.output, &mut outputs, &interrupt)?;
    let about = measure::about(&device, options.quick);
    let setting = Setting::new(options, &device, &about);
    let mut study = Study { about, scenes: Vec::new(), growth: Vec::new(), notes: Vec::new() };
    for subject in &subjects {
        if let Some(reason) = subject.absent() {
            study.notes.push(format!("{}: {reason}", subject.name));
            messages::line(&format!("note: {}: {reason}", subject.name));
            continue;
        }
        let loaded = read(subject.file.as_deref(), false, &mut outputs)?;
        study.scenes.push(measure::scene(&setting, subject, &loaded.scene, &mut study.notes)?);
    }
    ensure!(!study.scenes.is_empty(), "no scene was studied; the notes above say why");
    study.growth = measure::growth(&setting)?;
    let written = report::write(&study, &options.output, Target { run: &outputs, interrupt: &interrupt })?;
    let first = messages::path(written.first().unwrap_or(&options.output));
    messages::line(&format!("wrote {first} and {} files beside it", written.len().saturating_sub(1)));
    Ok(())
}
