//! `raywarp bench`: the paper's comparison of structures, on the device at hand.

use anyhow::Context;
use raywarp::accel::AccelKind;
use raywarp::backend::{survey, Device};
use raywarp::render::{RenderOptions, Rendering, Tracer};
use raywarp::scene::Scene;
use serde::Serialize;

use crate::options::BenchOptions;
use crate::render::read;
use crate::report::TestCounts;
use crate::say;

/// Seconds that the paper gives for its figure of 17,000 triangles at 1920x1080, on a GPU that it does not name.
const PAPER_SECONDS: f64 = 165.0;

/// Name of the scene without a file.
const BUILT_IN: &str = "built-in";

/// A whole run.
#[derive(Debug, Serialize)]
struct Bench {
    device: String,
    /// CUDA version of the driver and highest clock of the device; null on the CPU.
    cuda: Option<(u32, u32)>,
    clock_mhz: Option<u32>,
    version: &'static str,
    /// Of the sources that the program was built from, where the build said.
    commit: Option<&'static str>,
    scene: String,
    triangles: usize,
    size: [u32; 2],
    repeats: usize,
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

/// Over the repeats.
#[derive(Clone, Copy, Debug, Serialize)]
struct Spread {
    median: f64,
    least: f64,
    most: f64,
}

/// Times every structure on a scene.
pub fn run(options: &BenchOptions) -> anyhow::Result<()> {
    let loaded = read(options.scene.as_deref(), false)?;
    let device = Device::open(options.device)?;
    let mut bench = Bench::new(options, &device);
    for &accel in &options.accel {
        bench.measure(&loaded.scene, accel, &device, options)?;
    }
    let text = if options.json { serde_json::to_string_pretty(&bench)? + "\n" } else { bench.table() };
    say::out(text.as_bytes()).context("cannot write the table")
}

impl Bench {
    fn new(options: &BenchOptions, device: &Device) -> Self {
        let survey = survey();
        let gpu = survey.devices.iter().find(|gpu| Some(gpu.index) == device.cuda_index());
        let scene = options.scene.as_ref().map_or(BUILT_IN.into(), |path| path.display().to_string());
        Self {
            device: device.description(),
            cuda: gpu.and_then(|_| survey.driver.as_ref().ok().map(|driver| driver.version)),
            clock_mhz: gpu.map(|gpu| gpu.clock_mhz),
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("RAYWARP_COMMIT"),
            scene,
            triangles: 0,
            size: options.size,
            repeats: options.repeats as usize,
            rows: Vec::new(),
        }
    }

    fn measure(
        &mut self,
        scene: &Scene,
        accel: AccelKind,
        device: &Device,
        options: &BenchOptions,
    ) -> anyhow::Result<()> {
        let tracer = Tracer::new(scene, accel, device)?;
        self.triangles = tracer.report().triangles;
        let camera = tracer.default_camera();
        let render = |max_depth, shadows, count_tests| -> anyhow::Result<Rendering> {
            let picture = RenderOptions { size: options.size, max_depth, shadows, count_tests, ..Default::default() };
            Ok(tracer.render(camera, &picture, &mut |_| ())?)
        };
        for (rays, max_depth, shadows) in [("primary", 0, false), ("all", 5, true)] {
            say::line(&format!("{accel}, {rays} rays ..."));
            // The counting run compiles and warms up; its own time does not count.
            let counted = render(max_depth, shadows, true)?;
            render(max_depth, shadows, false)?;
            let times: anyhow::Result<Vec<f64>> =
                (0..options.repeats).map(|_| Ok(render(max_depth, shadows, false)?.kernel_seconds)).collect();
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
            self.scene, self.triangles, self.device, self.repeats
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
        self.scene == BUILT_IN && self.size == [1920, 1080]
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
        format!(" {:.0} times as long |\n", PAPER_SECONDS * 1e3 / self.kernel_ms.median)
    }
}

impl Spread {
    /// Of at least one time, in seconds.
    fn of(mut seconds: Vec<f64>) -> Self {
        seconds.sort_by(f64::total_cmp);
        let at = |index: usize| seconds.get(index).copied().unwrap_or(0.0) * 1e3;
        Self { median: at(seconds.len() / 2), least: at(0), most: at(seconds.len().saturating_sub(1)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_one() {
        let spread = Spread::of(vec![0.003, 0.001, 0.002]);
        assert_eq!((spread.median, spread.least, spread.most), (2.0, 1.0, 3.0));
    }
}
