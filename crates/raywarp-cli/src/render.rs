//! `raywarp render`.

use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use raywarp::accel::{Build, Dropped};
use raywarp::backend::Device;
use raywarp::image::Layers;
use raywarp::render::{self, Rendering, Tracer};
use raywarp::scene::{load, Camera, LoadOptions, Loaded, RenderDefaults};

use crate::interrupt::Interrupt;
use crate::limits;
use crate::options::{RenderOptions, StatsForm};
use crate::output::{Plan, Results};
use crate::progress::{Bar, Words};
use crate::report::{SceneCounts, Seconds, Statistics, TestCounts};
use crate::say;
use crate::viewpoint;

/// Renders a scene to files.
pub fn run(options: &RenderOptions) -> anyhow::Result<()> {
    let interrupt = Interrupt::install();
    let plan = plan(options, &interrupt)?;
    if let Some(size) = options.size {
        // Better told before a large scene is read.
        limits::check(size, options, &plan)?;
    }
    limit_threads(options.machine.threads)?;

    let start = Instant::now();
    let loaded = read(options.scene.as_deref(), options.strict)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let wishes = options.wishes().or(&loaded.scene.render);
    limits::check(wishes.options().size, options, &plan)?;
    let chosen = options.camera.as_deref().map(|name| viewpoint::named(&loaded.scene.cameras, name)).transpose()?;
    let device = Device::open(options.machine.device)?;
    let what = options.machine.build(&loaded.scene, &device);
    let tracer = Tracer::new(&loaded.scene, what, &device)?;
    refuse_dropped(options.strict, &tracer.report().dropped)?;
    say_notes(options, &loaded, &device, &tracer);
    let camera = viewpoint::adjusted(chosen.unwrap_or(tracer.default_camera()).clone(), &options.into());

    let shot = Shot { options, wishes, what, plan: &plan, tracer: &tracer, camera: &camera };
    let taken = shot.take()?;
    let saving = Instant::now();
    let results = Results {
        picture: &taken.rendering.picture,
        layers: &shot.layers(&taken)?,
        development: wishes.development(),
        heatmap_max: options.heatmap_max,
    };
    plan.write(&results, &interrupt, options.quiet)?;

    let mut statistics = statistics(&shot, &device, &loaded, &taken);
    statistics.seconds.load = load_seconds;
    statistics.seconds.save = saving.elapsed().as_secs_f64();
    conclude(options, &plan, &statistics, start.elapsed().as_secs_f64())
}

fn plan(options: &RenderOptions, interrupt: &Interrupt) -> anyhow::Result<Plan> {
    // Trying whether files can be written makes some for a moment.
    let _held = interrupt.hold();
    Plan::new(options)
}

/// All that the tracer tells of a picture.
fn statistics(shot: &Shot, device: &Device, loaded: &Loaded, taken: &Taken) -> Statistics {
    let (report, rendering) = (shot.tracer.report(), &taken.rendering);
    Statistics {
        device: device.description(),
        accel: shot.what.kind.to_string(),
        size: [rendering.picture.width, rendering.picture.height],
        spp: shot.wishes.options().spp,
        scene: SceneCounts::new(&loaded.scene, report),
        tree: (&report.tree).into(),
        device_bytes: report.device_bytes,
        seconds: Seconds {
            flatten: report.flatten_seconds,
            build: report.build_seconds,
            upload: report.upload_seconds,
            kernel: rendering.kernel_seconds,
            render: taken.seconds,
            ..Seconds::default()
        },
        launches: rendering.launches,
        non_finite: rendering.non_finite,
        tests: TestCounts::new(taken.counted(), rendering.kernel_seconds),
    }
}

/// The scene of a file, or the built-in one.
pub fn read(path: Option<&Path>, strict: bool) -> anyhow::Result<Loaded> {
    Ok(match path {
        Some(path) => load::load(path, &LoadOptions { strict })?,
        None => load::builtin()?,
    })
}

/// The CPU's threads, if there is a wish.
pub fn limit_threads(threads: Option<u32>) -> anyhow::Result<()> {
    let Some(threads) = threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
    pool.build_global().with_context(|| format!("cannot start {threads} threads"))
}

/// With `--strict`, triangles that cannot be hit are an error as every other warning is.
pub fn refuse_dropped(strict: bool, dropped: &Dropped) -> anyhow::Result<()> {
    let count = dropped.without_area + dropped.not_finite;
    anyhow::ensure!(
        !strict || count == 0,
        "triangles without area or with coordinates that are not finite, {count} of them, would be dropped (an error \
         because of --strict); mend the scene or leave --strict out"
    );
    Ok(())
}

fn say_notes(options: &RenderOptions, loaded: &Loaded, device: &Device, tracer: &Tracer) {
    if options.quiet {
        return;
    }
    say::warnings(&loaded.warnings);
    say::dropped(&tracer.report().dropped);
    let aimed = options.eye.is_some() && options.target.is_some();
    for note in tracer.report().notes.iter().filter(|note| !(aimed && note.contains("framed"))) {
        say::line(&format!("note: {note}"));
    }
    say::fallback(device);
}

/// One picture to be taken.
struct Shot<'a> {
    what: Build,
    options: &'a RenderOptions,
    /// Those of the options and of the scene.
    wishes: RenderDefaults,
    plan: &'a Plan,
    tracer: &'a Tracer,
    camera: &'a Camera,
}

/// A picture taken.
struct Taken {
    rendering: Rendering,
    seconds: f64,
    /// The same again with tests counted, where the first was to be timed without.
    counted: Option<Rendering>,
}

impl Taken {
    fn counted(&self) -> &Rendering {
        self.counted.as_ref().unwrap_or(&self.rendering)
    }
}

impl Shot<'_> {
    fn take(&self) -> anyhow::Result<Taken> {
        // Counting costs time: where times are asked for, it gets a run of its own.
        let timed = self.options.stats.is_some();
        let start = Instant::now();
        let rendering = self.render(self.plan.needs_tests() && !timed)?;
        let seconds = start.elapsed().as_secs_f64();
        let counted = timed.then(|| self.render(true)).transpose()?;
        Ok(Taken { rendering, seconds, counted })
    }

    fn render(&self, count_tests: bool) -> anyhow::Result<Rendering> {
        let mut bar = Bar::new(self.options.quiet, Words::Render);
        Ok(self
            .tracer
            .render(self.camera, &self.library_options(count_tests), &mut |p| bar.update(p.done, Some(p.total)))?)
    }

    fn layers(&self, taken: &Taken) -> anyhow::Result<Layers> {
        let (width, height) = (taken.rendering.picture.width, taken.rendering.picture.height);
        let asked = !self.plan.layers().is_empty();
        let surfels = if asked { self.tracer.layers(self.camera, &self.library_options(false))? } else { Vec::new() };
        Ok(Layers { width, height, surfels, tests: taken.counted().tests.clone() })
    }

    fn library_options(&self, count_tests: bool) -> render::RenderOptions {
        render::RenderOptions { crop: self.options.crop, count_tests, ..self.wishes.options() }
    }
}

fn conclude(options: &RenderOptions, plan: &Plan, statistics: &Statistics, total: f64) -> anyhow::Result<()> {
    match options.stats {
        Some(StatsForm::Json) => say::out(format!("{}\n", serde_json::to_string_pretty(statistics)?).as_bytes())?,
        Some(StatsForm::Table) => say::line(statistics.table().trim_end()),
        None => {}
    }
    if !options.quiet {
        let ([width, height], seconds) = (statistics.size, &statistics.seconds);
        say::line(&format!(
            "{}: {width}x{height} pixels on {} in {} (rendering {}, kernels {})",
            plan.names(),
            statistics.device,
            say::seconds(total),
            say::seconds(seconds.render),
            say::seconds(seconds.kernel),
        ));
    }
    Ok(())
}
