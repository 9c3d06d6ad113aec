//! `raywarp bench --frames`: the paper's comparison of structures, on the device at hand.

use std::path::PathBuf;

use raywarp::device::Device;
use raywarp::render::{RenderOptions, Rendering};
use raywarp::scene::Scene;
use serde::Serialize;

use super::machine::Machine;
use super::options::BenchOptions;
use super::spread::Spread;
use super::structures::{fastest_on, Structures};
use super::suite::BUILT_IN;
use crate::failure::{ensure, Result};
use crate::interrupt::Interrupt;
use crate::messages;
use crate::output::to_standard_output;
use crate::paper;
use crate::render::{limit_threads, read};
use crate::report::TestCounts;

/// Repeats, if the options do not say.
const REPEATS: u32 = 9;

/// A whole run.
#[derive(Debug, Serialize)]
struct Bench {
    #[serde(flatten)]
    machine: Machine,
    scene: String,
    triangles: usize,
    size: [u32; 2],
    repeats: u32,
    rows: Vec<Row>,
}

/// One structure and one sort of rays.
#[derive(Debug, Serialize)]
struct Row {
    accel: String,
    /// `primary`: no shadows, no bounces; `all`: shadows and five bounces.
    rays: &'static str,
    kernel_ms: Spread,
    tests: Option<TestCounts>,
}

/// Times every structure on a scene.
pub fn run(options: &BenchOptions, structures: &dyn Structures) -> Result<()> {
    ensure!(
        options.subjects.scenes.len() < 2,
        "--frames takes one scene, and there are {}",
        options.subjects.scenes.len()
    );
    let _ends = Interrupt::install();
    limit_threads(options.threads)?;
    let loaded = read(options.subjects.scenes.first().map(PathBuf::as_path), false, &mut to_standard_output()?)?;
    let device = structures.open(options.device)?;
    let mut bench = Bench::new(options, options.one_size()?, &device);
    let usual = ["brute", "kd", fastest_on(&device)].map(str::to_owned);
    for name in if options.layout.is_empty() { &usual } else { &options.layout[..] } {
        bench.measure(name, &loaded.scene, structures, &device)?;
    }
    messages::results(&bench, options.json, || bench.table())
}

impl Bench {
    fn new(options: &BenchOptions, size: [u32; 2], device: &Device) -> Self {
        let scene = options.subjects.scenes.first().map_or(BUILT_IN.into(), |path| path.display().to_string());
        Self {
            machine: Machine::of(device),
            scene,
            triangles: 0,
            size,
            repeats: options.repeats.unwrap_or(REPEATS),
            rows: Vec::new(),
        }
    }

    fn measure(&mut self, accel: &str, scene: &Scene, structures: &dyn Structures, device: &Device) -> Result<()> {
        let tracer = structures.tracer(accel, scene, device)?;
        self.triangles = tracer.report().triangles;
        let camera = tracer.default_camera();
        let render = |max_depth, shadows, count_tests| -> Result<Rendering> {
            let picture =
                RenderOptions { size: self.size, spp: 1, max_depth, shadows, count_tests, ..Default::default() };
            Ok(tracer.render(camera, &picture, &mut |_| ())?)
        };
        for (rays, max_depth, shadows) in [("primary", 0, false), ("all", 5, true)] {
            messages::line(&format!("{accel}, {rays} rays ..."));
            // The counting run compiles and warms up; its own time does not count.
            let counted = render(max_depth, shadows, true)?;
            render(max_depth, shadows, false)?;
            let times: Result<Vec<f64>> =
                (0..self.repeats).map(|_| Ok(render(max_depth, shadows, false)?.kernel_seconds * 1e3)).collect();
            let kernel_ms = Spread::of(times?);
            let tests = TestCounts::new(&counted, kernel_ms.median * 1e-3);
            self.rows.push(Row { accel: accel.to_string(), rays, kernel_ms, tests });
        }
        Ok(())
    }

    /// Markdown, as the README has it.
    fn table(&self) -> String {
        let [width, height] = self.size;
        let mut text = format!(
            "{}, {} triangles, {width}x{height}, {}; kernel time, median of {} (least to most)\n\n",
            self.scene, self.triangles, self.machine.device, self.repeats
        );
        text += "| structure | rays | kernel time, ms | million rays/s | nodes a ray | triangles a ray |";
        text += if self.is_the_papers() { " the paper's 165 s are |\n" } else { "\n" };
        text += "| --- | --- | ---: | ---: | ---: | ---: |";
        text += if self.is_the_papers() { " ---: |\n" } else { "\n" };
        for row in &self.rows {
            text += &row.markdown();
            text += &if self.is_the_papers() { row.against_the_paper() } else { "\n".to_owned() };
        }
        text
    }

    /// Whether the picture is the one whose time the paper gives.
    fn is_the_papers(&self) -> bool {
        self.scene == BUILT_IN && self.size == paper::FIGURE_SIZE
    }
}

impl Row {
    fn markdown(&self) -> String {
        let Spread { median, least, most } = self.kernel_ms;
        let (mrays, nodes, triangles) =
            self.tests.as_ref().map_or((0.0, 0.0, 0.0), |t| (t.mrays_per_second, t.nodes_per_ray, t.triangles_per_ray));
        format!(
            "| {} | {} | {median:.3} ({least:.3} to {most:.3}) | {mrays:.1} | {nodes:.1} | {triangles:.1} |",
            self.accel, self.rays
        )
    }

    fn against_the_paper(&self) -> String {
        format!(" {:.0} times as long |\n", paper::FIGURE_SECONDS * 1e3 / self.kernel_ms.median)
    }
}
