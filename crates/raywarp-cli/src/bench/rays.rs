//! `raywarp bench`: rays a second.

use raywarp::accel::Quality;
use raywarp::query::RayKind;

use super::contest::Contest;
use super::machine::Machine;
use super::options::BenchOptions;
use super::peers::Peer;
use super::results::Results;
use super::structures::{fastest_on, Structures};
use super::suite::subjects;
use crate::failure::{ensure, Context, Result};
use crate::interrupt::Interrupt;
use crate::messages;
use crate::output::to_standard_output;
use crate::render::{limit_threads, read};

/// Repeats, if the options do not say.
const REPEATS: u32 = 20;

/// Measures every scene that the options name.
pub fn run(options: &BenchOptions, structures: &dyn Structures) -> Result<()> {
    let interrupt = Interrupt::install();
    let mut outputs = to_standard_output()?;
    outputs.reads(&options.subjects.suite)?;
    let subjects = subjects(&options.subjects)?;
    let device = structures.open(options.device)?;
    // Peers use one thread of the CPU.
    let alone = !options.peers.is_empty() && !device.is_cuda();
    limit_threads(options.threads.or(alone.then_some(1)))?;
    let mut results = Results {
        machine: Machine::of(&device),
        size: options.one_size()?,
        repeats: options.repeats.unwrap_or(REPEATS),
        warmup: options.warmup,
        rows: Vec::new(),
        peers: Vec::new(),
        notes: Vec::new(),
    };
    let folder = tempfile::tempdir().context("cannot make a folder for temporary files")?;
    interrupt.unfinished(folder.path().to_owned());
    let mut contest = Contest {
        options,
        structures,
        builds: Vec::new(),
        kinds: if options.rays.is_empty() { RayKind::ALL.to_vec() } else { options.rays.clone() },
        device: &device,
        peers: Vec::new(),
        folder: folder.path(),
    };
    contest.builds = builds(options, &contest)?;
    contest.peers = peers(options, &contest, &mut results);

    for subject in subjects {
        if let Some(reason) = subject.absent() {
            results.note(&subject.name, reason);
            continue;
        }
        let loaded = read(subject.file.as_deref(), false, &mut outputs)?;
        contest.measure(&subject, &loaded.scene, &mut results)?;
    }
    conclude(options, &results)
}

/// Every structure with every quality that it has.
fn builds(options: &BenchOptions, contest: &Contest) -> Result<Vec<(String, Quality)>> {
    let fastest = [fastest_on(contest.device).to_owned()];
    let layouts = if options.layout.is_empty() { &fastest[..] } else { &options.layout[..] };
    let mut builds = Vec::new();
    for name in layouts {
        let has_several = contest.structures.is_hierarchy(name)?;
        let qualities = if has_several { &options.tree[..] } else { &[Quality::Medium] };
        builds.extend(qualities.iter().map(|&quality| (name.clone(), quality)));
    }
    Ok(builds)
}

/// The peers that run on the device's machine; a note for each that does not.
fn peers(options: &BenchOptions, contest: &Contest, results: &mut Results) -> Vec<Peer> {
    let start = |name: &String| {
        let started = Peer::start(&options.python, contest.folder, name, contest.device);
        started.map_err(|error| results.note(name, format!("left out: {error}"))).ok()
    };
    options.peers.iter().filter_map(start).collect()
}

/// Prints the results, and says what is wrong with them.
fn conclude(options: &BenchOptions, results: &Results) -> Result<()> {
    ensure!(!results.rows.is_empty(), "nothing was measured; the notes above say why");
    messages::results(results, options.json, || results.table())?;
    let differ: usize = results.rows.iter().map(|row| row.differ).sum();
    ensure!(differ == 0, "{differ} answers differ between structures: one of them is wrong; report it");
    Ok(())
}
