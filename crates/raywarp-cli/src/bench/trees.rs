//! `raywarp bench --trees`: million triangles a second, from triangles to a tree on the device.

use std::time::Instant;

use raywarp::accel::hploc::{NodeSizes, TreeBuilder};
use raywarp::accel::{AccelKind, Build, Quality, TreeStats};
use raywarp::device::Device;
use raywarp::device_scene::Structure;
use raywarp::query::opaque_triangles;
use raywarp::Triangle;
use serde::Serialize;

use super::machine::Machine;
use super::options::BenchOptions;
use super::spread::Spread;
use super::structures::Structures;
use super::suite::subjects;
use crate::failure::{ensure, Result};
use crate::interrupt::Interrupt;
use crate::messages;
use crate::output::to_standard_output;
use crate::render::{limit_threads, read};

/// Repeats of what the device builds, if the options do not say; the host builds once.
const REPEATS: u32 = 20;

/// A whole run.
#[derive(Debug, Serialize)]
struct Results {
    #[serde(flatten)]
    machine: Machine,
    rows: Vec<Row>,
}

/// One scene and one quality.
#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    /// Its triangles that can be hit.
    triangles: usize,
    tree: Quality,
    /// Whether the triangles were on the device before; else on the host, and the tree is copied.
    from_device: bool,
    /// Million triangles a second: the median, the worst and the best.
    mtriangles_per_s: f64,
    mtriangles_per_s_least: f64,
    mtriangles_per_s_most: f64,
    ms: Spread,
    /// The first time, with the memory that it takes and kernels that are loaded.
    first_ms: f64,
    stats: TreeStats,
}

/// Builds trees over every scene that the options name.
pub fn run(options: &BenchOptions, structures: &dyn Structures) -> Result<()> {
    let _ends = Interrupt::install();
    let mut outputs = to_standard_output()?;
    outputs.reads(&options.subjects.suite)?;
    limit_threads(options.threads)?;
    let device = structures.open(options.device)?;
    let mut results = Results { machine: Machine::of(&device), rows: Vec::new() };
    for subject in subjects(&options.subjects)? {
        if let Some(reason) = subject.absent() {
            messages::line(&format!("note: {}: {reason}", subject.name));
            continue;
        }
        let loaded = read(subject.file.as_deref(), false, &mut outputs)?;
        let triangles = opaque_triangles(&loaded.scene)?;
        ensure!(!triangles.is_empty(), "the scene '{}' has no triangle that a ray can hit", subject.name);
        for &quality in &options.tree {
            messages::line(&format!("{}: {} triangles, {quality} ...", subject.name, triangles.len()));
            let measured = match quality {
                Quality::Fast => by_device(options, &triangles, &device)?,
                _ => by_host(options, &triangles, quality, &device)?,
            };
            results.rows.push(measured.row(subject.name.clone(), quality));
        }
    }
    ensure!(!results.rows.is_empty(), "nothing was built; the notes above say why");
    messages::results(&results, options.json, || results.table())
}

/// Seconds of each repeat, and of the first build.
struct Measured {
    from_device: bool,
    first: f64,
    seconds: Vec<f64>,
    stats: TreeStats,
}

/// From triangles on the device to nodes of both sizes there.
fn by_device(options: &BenchOptions, triangles: &[Triangle], device: &Device) -> Result<Measured> {
    let given = device.upload(triangles)?;
    let start = Instant::now();
    let mut builder = TreeBuilder::new(device, triangles.len())?;
    let stats = builder.build(&given, NodeSizes::Both)?.tree.stats();
    device.mark()?.wait()?;
    let first = start.elapsed().as_secs_f64();
    let mut build = || -> Result<f64> {
        let start = device.mark()?;
        start.wait()?;
        let built = builder.build(&given, NodeSizes::Both)?;
        let seconds = device.mark()?.seconds_since(&start)?;
        drop(built);
        Ok(seconds)
    };
    for _ in 0..options.warmup {
        build()?;
    }
    let seconds = (0..options.repeats.unwrap_or(REPEATS)).map(|_| build()).collect::<Result<_>>()?;
    Ok(Measured { from_device: true, first, seconds, stats })
}

/// From triangles on the host to a structure on the device.
fn by_host(options: &BenchOptions, triangles: &[Triangle], quality: Quality, device: &Device) -> Result<Measured> {
    let what = Build { kind: AccelKind::Bvh, quality, cached: false };
    let build = || -> Result<(f64, TreeStats)> {
        let (list, start) = (triangles.to_vec(), Instant::now());
        let structure = Structure::build(device, what, list)?;
        device.mark()?.wait()?;
        Ok((start.elapsed().as_secs_f64(), structure.stats))
    };
    let (first, stats) = build()?;
    let mut seconds = vec![first];
    for _ in 1..options.repeats.unwrap_or(1) {
        seconds.push(build()?.0);
    }
    Ok(Measured { from_device: false, first, seconds, stats })
}

impl Measured {
    fn row(self, scene: String, tree: Quality) -> Row {
        let triangles = self.stats.references - self.stats.duplicates;
        let seconds = Spread::of(self.seconds);
        // A clock too coarse for a few triangles says 0.
        let rates = seconds.falling(|seconds| 1e-6 * triangles as f64 / seconds.max(1e-9));
        Row {
            scene,
            triangles,
            tree,
            from_device: self.from_device,
            mtriangles_per_s: rates.median,
            mtriangles_per_s_least: rates.least,
            mtriangles_per_s_most: rates.most,
            ms: Spread { median: seconds.median * 1e3, least: seconds.least * 1e3, most: seconds.most * 1e3 },
            first_ms: self.first * 1e3,
            stats: self.stats,
        }
    }
}

impl Results {
    /// Markdown.
    fn table(&self) -> String {
        let mut text = format!("{}\n\n", self.machine.sentence());
        text += "| scene | triangles | tree | million triangles/s | ms (least to most) | first, ms | nodes | depth | cost |\n";
        text += "| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
        for Row { scene, triangles, tree, mtriangles_per_s, ms, first_ms, stats, .. } in &self.rows {
            let Spread { median, least, most } = ms;
            text += &format!(
                "| {scene} | {triangles} | {tree} | {mtriangles_per_s:.1} | {median:.3} ({least:.3} to {most:.3}) | \
                 {first_ms:.1} | {} | {} | {:.1} |\n",
                stats.nodes, stats.depth, stats.sah_cost
            );
        }
        text
    }
}
