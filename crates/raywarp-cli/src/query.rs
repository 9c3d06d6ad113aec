//! `raywarp query`.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use raywarp::device::Device;
use raywarp::query::files::{AnswerWriter, Answers, Format, Mode, RayReader};
use raywarp::query::{Batch, Progress, RayCaster};
use raywarp::write::{self, Outputs};
use serde::Serialize;

use crate::failure::{ensure, fail, Context, Result};
use crate::interrupt::Interrupt;
use crate::messages;
use crate::options::QueryOptions;
use crate::output::Target;
use crate::progress::{Bar, Words};
use crate::read_ahead::ReadAhead;
use crate::render::{limit_threads, read};

/// Rays that are read, asked and put aside at once: 128 MiB of them. The next ones are read meanwhile.
const PIECE: usize = 1 << 22;

/// Answers the rays of a file.
pub fn run(options: &QueryOptions) -> Result<()> {
    let interrupt = Interrupt::install();
    let start = Instant::now();
    let mut outputs = Outputs::default();
    outputs.reads(&options.scene)?;
    let mut answers = plan(options, &mut outputs, &interrupt)?;
    // A bad file of rays is told before a large scene is read.
    let rays = RayReader::open(&options.rays)?;
    let shape = rays.shape().map(<[u64]>::to_vec);
    limit_threads(options.machine.threads)?;
    let loaded = read(options.scene.as_deref(), options.strict, &mut outputs)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let device = Device::open(options.machine.device)?;
    let what = options.machine.build(&loaded.scene, &device);
    let caster = RayCaster::from_scene(&loaded.scene, what, &device)?;
    caster.report().dropped.allow(options.strict)?;
    if !options.quiet {
        messages::warnings(&loaded.warnings);
        messages::notes(&loaded.notes);
        messages::dropped(&caster.report().dropped);
        messages::fallback(&device);
        for warning in &caster.report().notes {
            messages::line(&format!("warning: {warning}"));
        }
        if rays.is_rounded() {
            messages::line("note: the rays are float64, and rounded to float32");
        }
    }

    let asking = Instant::now();
    let kernel_seconds = ask(options, &caster, rays, &mut answers)?;
    let query_seconds = asking.elapsed().as_secs_f64();
    let report = Report {
        device: device.description(),
        accel: what.kind.to_string(),
        mode: options.mode.to_string(),
        triangles: caster.report().triangles as u64,
        rays: answers.rays(),
        hits: answers.hits(),
        million_rays_per_second: 1e-6 * answers.rays() as f64 / kernel_seconds.max(1e-9),
        seconds: Seconds {
            load: load_seconds,
            build: caster.report().build_seconds,
            kernel: kernel_seconds,
            query: query_seconds,
            save: 0.0,
        },
    };
    let saving = Instant::now();
    save(options, answers, shape.as_deref(), Target { run: &outputs, interrupt: &interrupt })?;
    conclude(options, report, saving.elapsed().as_secs_f64(), start.elapsed().as_secs_f64())
}

/// What a run did.
#[derive(Debug, Serialize)]
struct Report {
    device: String,
    accel: String,
    mode: String,
    triangles: u64,
    rays: u64,
    /// Hits of all rays; for `closest` and `any` rays with a hit.
    hits: u64,
    /// By the time of the kernels.
    million_rays_per_second: f64,
    seconds: Seconds,
}

/// Where the time went.
#[derive(Debug, Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    kernel: f64,
    /// Reading rays, copying and answers included.
    query: f64,
    save: f64,
}

/// Where the answers go, once it is known that they can.
fn plan(options: &QueryOptions, run: &mut Outputs, interrupt: &Interrupt) -> Result<AnswerWriter> {
    let (mode, output) = (options.mode, options.output.as_path());
    ensure!(
        options.max_hits.is_none() || matches!(mode, Mode::All | Mode::Count),
        "--max-hits bounds what --mode all and --mode count find, and {mode} finds one hit: leave it out"
    );
    ensure!(
        !options.json || !write::is_dash(output),
        "--json and the answers cannot both go to standard output: give -o a file"
    );
    let format = format(options)?;
    add_files(options, run)?;
    // Trying whether a file can be written makes one for a moment.
    let held = interrupt.hold();
    write::check(output)?;
    drop(held);
    AnswerWriter::new(mode, format, &spool(output)).with_context(|| {
        format!("the answers to --mode {mode} are several arrays, and a .npy file holds one: write .npz or .csv")
    })
}

/// Everything that is read and written beside the scene.
fn add_files(options: &QueryOptions, run: &mut Outputs) -> Result<()> {
    match write::is_dash(&options.rays) {
        true => run.reads_standard_input()?,
        false => run.reads([&options.rays])?,
    }
    run.add(&options.output)?;
    match options.json {
        true => Ok(run.add(Path::new(write::STANDARD))?),
        false => Ok(()),
    }
}

fn format(options: &QueryOptions) -> Result<Format> {
    let output = options.output.as_path();
    match options.format.or_else(|| Format::of(output)) {
        Some(format) => Ok(format),
        None if write::is_dash(output) => Ok(Format::Csv),
        None => fail!(
            "cannot write {}: its name does not end in .npz, .npy or .csv. Give one of these endings, or --format",
            output.display()
        ),
    }
}

/// Where answers wait that do not fit in memory: beside the file, where there has to be room for them anyway.
fn spool(output: &Path) -> PathBuf {
    match std::fs::metadata(output) {
        Ok(metadata) if metadata.is_file() => write::directory_of(output),
        Err(_) if !write::is_dash(output) => write::directory_of(output),
        _ => std::env::temp_dir(),
    }
}

/// Puts the answers to all rays aside; returns the seconds that kernels ran.
fn ask(options: &QueryOptions, caster: &RayCaster, reader: RayReader, answers: &mut AnswerWriter) -> Result<f64> {
    let mut bar = Bar::new(options.quiet, Words::Query);
    let mut kernel_seconds = 0.0;
    let expected = reader.rays();
    let pieces = ReadAhead::new(reader, PIECE);
    while let Some(rays) = pieces.next()? {
        let (before, mut piece_seconds) = (answers.rays(), 0.0);
        let mut watch = |progress: Progress| {
            piece_seconds = progress.kernel_seconds;
            bar.update(before + progress.done as u64, expected);
            ControlFlow::Continue(())
        };
        let batch = caster.batch(&rays).max_hits(options.max_hits.unwrap_or(u32::MAX));
        answer(options.mode, batch.watched(&mut watch), answers)?;
        kernel_seconds += piece_seconds;
        pieces.done(rays);
    }
    Ok(kernel_seconds)
}

/// Asks a batch and puts its answers aside.
fn answer(mode: Mode, batch: Batch, answers: &mut AnswerWriter) -> Result<()> {
    let kept = match mode {
        Mode::Closest => answers.add(Answers::Closest(&batch.closest()?)),
        Mode::Any => answers.add(Answers::Any(&batch.any()?)),
        Mode::Count => answers.add(Answers::Count(&batch.count()?)),
        Mode::All => {
            let mut kept = Ok(());
            let asked = batch.all_by_parts(&mut |part| {
                kept = answers.add(Answers::All(&part));
                match kept {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(_) => ControlFlow::Break(()),
                }
            });
            // Where there was no room the work was stopped, and that is no news.
            if kept.is_ok() {
                asked?;
            }
            kept
        }
    };
    kept.context("the answers do not fit in memory, and cannot be put aside beside the output")
}

fn save(options: &QueryOptions, mut answers: AnswerWriter, shape: Option<&[u64]>, target: Target) -> Result<()> {
    let output = options.output.as_path();
    let bytes = answers.bytes()?;
    // A pipe may wait for its reader for ever: Ctrl-C has to work there, and leaves no file.
    let _held = (!write::is_dash(output)).then(|| target.interrupt.hold());
    target.run.with(output, bytes, |file| answers.write(shape, &mut target.interrupt.stop(file)))?;
    Ok(())
}

fn conclude(options: &QueryOptions, mut report: Report, save_seconds: f64, total: f64) -> Result<()> {
    report.seconds.save = save_seconds;
    if options.json {
        messages::results(&report, true, String::new)?;
    }
    if !options.quiet {
        let name = messages::output_name(&options.output);
        messages::line(&format!(
            "{name}: {} rays, {} {} on {} in {} (kernels {}, {:.1} million rays a second)",
            report.rays,
            report.hits,
            if matches!(options.mode, Mode::Any | Mode::Closest) { "with a hit" } else { "hits" },
            report.device,
            messages::seconds(total),
            messages::seconds(report.seconds.kernel),
            report.million_rays_per_second,
        ));
    }
    Ok(())
}
