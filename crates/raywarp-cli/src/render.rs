//! `raywarp render`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use raywarp::accel::cache::Cache;
use raywarp::accel::Build;
use raywarp::device::Device;
use raywarp::image::{Layers, Picture};
use raywarp::render::{self, Integrator, Progress, Rendering, Tracer};
use raywarp::scene::settings::Part;
use raywarp::scene::{load, Camera, LoadOptions, Loaded, RenderDefaults, Viewpoint};
use raywarp::write::Outputs;

use crate::failure::{Context, Result};
use crate::frames;
use crate::interrupt::Interrupt;
use crate::limits;
use crate::messages;
use crate::options::{RenderOptions, StatsForm};
use crate::output::{Plan, Results, Target};
use crate::progress::{Bar, Words};
use crate::provenance::{digest, Origin};
use crate::report::{SceneCounts, Seconds, Statistics};
use crate::values::Backdrop;

/// Renders a scene to files.
pub fn run(options: &RenderOptions) -> Result<()> {
    if let Some(range) = options.frames.range {
        return frames::run(options, range);
    }
    let interrupt = Interrupt::install();
    let mut outputs = Outputs::default();
    outputs.reads(&options.scene)?;
    let plan = plan(options, &mut outputs, &interrupt)?;
    if let Some(size) = options.picture.values.size {
        // Better told before a large scene is read.
        limits::check(size, options, &plan)?;
    }
    limit_threads(options.machine.threads)?;

    let start = Instant::now();
    let mut loaded = read(options.scene.as_deref(), options.strict, &mut outputs)?;
    options.change(&mut loaded, &mut outputs)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let overrides = options.settings(&loaded.scene);
    let region = limits::check(render::RenderOptions::from(&overrides).size, options, &plan)?;
    let setup = Setup::set(options, overrides, &loaded)?;

    let shot = Shot { setup: &setup, plan: &plan, camera: &setup.camera };
    let mut bar = Bar::new(options.quiet, Words::Render);
    let taken = shot.take(&mut |progress| bar.update(progress.done, Some(progress.total)))?;
    drop(bar);
    say_nothing_seen(&setup, &taken.rendering.picture);
    let saving = Instant::now();
    let target = Target { run: &outputs, interrupt: &interrupt };
    plan.write(&shot.results(&taken, &shot.layers(&taken)?), target, options.quiet)?;

    let mut statistics = setup.statistics(region);
    statistics.add(&taken);
    statistics.seconds.load = load_seconds;
    statistics.seconds.save = saving.elapsed().as_secs_f64();
    conclude(options, &plan, &statistics, start.elapsed().as_secs_f64())
}

fn plan(options: &RenderOptions, outputs: &mut Outputs, interrupt: &Interrupt) -> Result<Plan> {
    // Trying whether files can be written makes some for a moment.
    let _held = interrupt.hold();
    Plan::new(options, outputs)
}

/// The scene of a file, or the built-in one, once it is known that no output of the run is one of its files.
pub fn read(path: Option<&Path>, strict: bool, run: &mut Outputs) -> Result<Loaded> {
    run.reads(path)?;
    let loaded = match path {
        Some(path) => load::load(path, &LoadOptions { strict })?,
        None => load::builtin()?,
    };
    run.reads(&loaded.files)?;
    run.reads(cached_trees())?;
    Ok(loaded)
}

/// Every file of the cache of trees: which of them a scene needs is known only once it is built.
fn cached_trees() -> Vec<PathBuf> {
    let entries = Cache::standard().and_then(|cache| std::fs::read_dir(cache.directory()).ok());
    let paths = entries.into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    paths.filter(|path| path.extension().is_some_and(|extension| extension == "tree")).collect()
}

/// The CPU's threads, if there is a wish.
pub fn limit_threads(threads: Option<u32>) -> Result<()> {
    let Some(threads) = threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
    pool.build_global().with_context(|| format!("cannot start {threads} threads"))
}

fn say_notes(options: &RenderOptions, loaded: &Loaded, device: &Device, tracer: &Tracer) {
    if options.quiet {
        return;
    }
    messages::warnings(&loaded.warnings);
    messages::notes(&loaded.notes);
    messages::dropped(&tracer.report().dropped);
    let camera = &options.camera;
    let placed = camera.eye.is_some() && camera.target.is_some();
    let aimed = placed || camera.viewpoint().frames() || options.frames.path.is_some();
    let lighting = tracer.notes_of(options.settings(&loaded.scene).integrator());
    for note in lighting.iter().chain(&tracer.report().notes).filter(|note| !(aimed && note.contains("framed"))) {
        messages::line(&format!("note: {note}"));
    }
    messages::fallback(device);
}

/// Says so where no ray of the camera met anything, which a crop may mean.
fn say_nothing_seen(setup: &Setup, picture: &Picture) {
    let sees = picture.pixels.iter().any(|pixel| pixel[3] > 0.0);
    if sees || setup.options.quiet || setup.options.crop.is_some() || setup.tracer.report().triangles == 0 {
        return;
    }
    messages::line("note: the camera sees nothing of the scene; --view front frames all of it");
}

/// A scene on a device, with a camera.
pub struct Setup<'a> {
    /// All options.
    pub options: &'a RenderOptions,
    /// The camera that they ask for.
    pub camera: Camera,
    /// The scene, ready.
    pub tracer: Tracer,
    /// What the options and the scene ask for.
    overrides: RenderDefaults,
    loaded: &'a Loaded,
    /// Of the scene's files.
    digest: u128,
    device: Device,
    what: Build,
}

impl<'a> Setup<'a> {
    /// Builds the tree and says what there is to say about the scene.
    pub fn set(options: &'a RenderOptions, overrides: RenderDefaults, loaded: &'a Loaded) -> Result<Self> {
        let [width, height] = overrides.size().map(f64::from);
        let turning = options.frames.orbit.is_some();
        let viewpoint = Viewpoint { turning, ..options.camera.viewpoint() };
        let camera = render::chosen_camera(&loaded.scene, &viewpoint, width / height)?;
        let device = Device::open(options.machine.device)?;
        let what = options.machine.build(&loaded.scene, &device);
        let tracer = Tracer::new(&loaded.scene, what, &device)?;
        tracer.report().dropped.allow(options.strict)?;
        say_notes(options, loaded, &device, &tracer);
        let digest = digest(&loaded.files);
        Ok(Self { options, camera, tracer, overrides, loaded, digest, device, what })
    }

    /// Whether the camera's target is a point that somebody chose: a camera of glTF has a direction alone.
    pub fn has_target(&self) -> bool {
        let extension = self.options.scene.as_deref().and_then(Path::extension).unwrap_or_default();
        let is_gltf = ["gltf", "glb"].iter().any(|gltf| extension.eq_ignore_ascii_case(gltf));
        let viewpoint = self.options.camera.viewpoint();
        viewpoint.target.is_some() || viewpoint.frames() || self.loaded.scene.cameras.is_empty() || !is_gltf
    }

    /// What is known before any picture of a size is taken.
    pub fn statistics(&self, size: [u32; 2]) -> Statistics {
        let report = self.tracer.report();
        Statistics {
            device: self.device.description(),
            accel: self.what.kind.to_string(),
            size,
            spp: render::RenderOptions::from(&self.overrides).spp,
            frames: None,
            scene: SceneCounts::new(&self.loaded.scene, report),
            tree: (&report.tree).into(),
            device_bytes: report.device_bytes,
            seconds: Seconds {
                flatten: report.flatten_seconds,
                build: report.build_seconds,
                upload: report.upload_seconds,
                ..Seconds::default()
            },
            launches: 0,
            non_finite: 0,
            tests: None,
        }
    }
}

/// One picture to be taken.
pub struct Shot<'a> {
    /// Of what.
    pub setup: &'a Setup<'a>,
    /// For which files.
    pub plan: &'a Plan,
    /// From where.
    pub camera: &'a Camera,
}

/// A picture taken.
pub struct Taken {
    /// It.
    pub rendering: Rendering,
    /// How long it took.
    pub seconds: f64,
    /// The same again with tests counted, where the first was to be timed without.
    counted: Option<Rendering>,
}

impl Taken {
    /// The rendering with tests, where they were asked for.
    pub fn counted(&self) -> &Rendering {
        self.counted.as_ref().unwrap_or(&self.rendering)
    }
}

impl Shot<'_> {
    /// Takes it; where statistics are asked for, twice, unless its tests cannot be counted.
    pub fn take(&self, progress: &mut dyn FnMut(Progress)) -> Result<Taken> {
        // Counting costs time: where times are asked for, it gets a run of its own.
        let timed = self.setup.options.stats.is_some();
        let start = Instant::now();
        let rendering = self.render(self.plan.needs_tests() && !timed, progress)?;
        let seconds = start.elapsed().as_secs_f64();
        let counts = timed && self.setup.overrides.integrator() == Integrator::Whitted;
        let counted = counts.then(|| self.render(true, progress)).transpose()?;
        Ok(Taken { rendering, seconds, counted })
    }

    fn render(&self, count_tests: bool, progress: &mut dyn FnMut(Progress)) -> Result<Rendering> {
        let tracer = &self.setup.tracer;
        let mut rendering = tracer.render(self.camera, &self.library_options(count_tests), progress)?;
        if self.setup.options.background == Some(Backdrop::None) {
            tracer.cut_out(&mut rendering.picture, self.camera)?;
        }
        Ok(rendering)
    }

    /// The layers that the files want.
    pub fn layers(&self, taken: &Taken) -> Result<Layers> {
        let (width, height) = (taken.rendering.picture.width, taken.rendering.picture.height);
        let asked = !self.plan.layers().is_empty();
        let options = self.library_options(false);
        let first_hits = if asked { self.setup.tracer.layers(self.camera, &options)? } else { Vec::new() };
        Ok(Layers { width, height, first_hits, tests: taken.counted().tests.clone() })
    }

    /// What the files are made of.
    pub fn results<'a>(&self, taken: &'a Taken, layers: &'a Layers) -> Results<'a> {
        Results::new(&taken.rendering.picture, layers, &self.origin())
    }

    /// What the picture is made of.
    pub fn origin(&self) -> Origin<'_> {
        Origin {
            scene: self.setup.options.scene.as_deref(),
            digest: self.setup.digest,
            settings: self.setup.overrides.or(&RenderDefaults::usual()).only(&[
                Part::Picture,
                Part::Shading,
                Part::Display,
            ]),
            crop: self.setup.options.crop,
            background: self.setup.options.background,
            environment: &self.setup.options.environment,
            scene_up: self.setup.loaded.scene.up,
            camera: self.camera,
            layers: self.plan.layers(),
            heatmap_max: self.setup.options.heatmap_max,
        }
    }

    fn library_options(&self, count_tests: bool) -> render::RenderOptions {
        render::RenderOptions {
            crop: self.setup.options.crop,
            count_tests,
            ..render::RenderOptions::from(&self.setup.overrides)
        }
    }
}

/// The statistics, where they are asked for.
pub fn say_statistics(options: &RenderOptions, statistics: &Statistics) -> Result<()> {
    match options.stats {
        Some(StatsForm::Json) => messages::results(statistics, true, String::new)?,
        Some(StatsForm::Table) => messages::line(statistics.table().trim_end()),
        None => {}
    }
    Ok(())
}

fn conclude(options: &RenderOptions, plan: &Plan, statistics: &Statistics, total: f64) -> Result<()> {
    say_statistics(options, statistics)?;
    if !options.quiet {
        let ([width, height], seconds) = (statistics.size, &statistics.seconds);
        messages::line(&format!(
            "{}: {width}x{height} pixels on {} in {} (rendering {}, kernels {})",
            plan.names(),
            statistics.device,
            messages::seconds(total),
            messages::seconds(seconds.render),
            messages::seconds(seconds.kernel),
        ));
    }
    Ok(())
}
