//! `raywarp render --frames`: turntables and camera flights.
//!
//! The scene is read and its tree built once. Each frame is written whole or not at all, so a run that was ended goes on
//! where it was, and several machines can share a flight.

mod animation;
mod files;
mod flight;
mod names;
mod options;
mod orbit;
mod range;

use std::time::Instant;

use raywarp::image::{Layers, Rgb8};
use raywarp::render;
use raywarp::scene::Camera;
use raywarp::write::Outputs;

use crate::failure::{ensure, Result};
use crate::interrupt::Interrupt;
use crate::limits;
use crate::messages;
use crate::options::RenderOptions;
use crate::output::{Plan, Target};
use crate::progress::{Bar, Words, THOUSAND};
use crate::render::{limit_threads, read, say_statistics, Setup, Shot};
use crate::report::{FrameCounts, Statistics};
use crate::values::Backdrop;

use animation::Animation;
use files::{FrameFiles, There};
use flight::Flight;
pub use options::FrameOptions;
use range::Range;

/// Renders frames of a flight to files.
pub fn run(options: &RenderOptions, range: Range) -> Result<()> {
    let interrupt = Interrupt::install();
    let whole = range.whole(options.frames.of)?;
    let mut outputs = Outputs::default();
    outputs.reads(&options.scene)?;
    let files = name(options, range, &mut outputs, &interrupt)?;
    if let Some(size) = options.picture.values.size {
        // Better told before a large scene is read.
        check(size, options, &files.plan(range.first)?)?;
    }
    limit_threads(options.machine.threads)?;

    let start = Instant::now();
    let mut loaded = read(options.scene.as_deref(), options.strict, &mut outputs)?;
    options.change(&mut loaded, &mut outputs)?;
    let load_seconds = start.elapsed().as_secs_f64();
    let path = options.frames.path.as_deref().map(|name| flight::named(&loaded.scene.paths, name)).transpose()?;
    let overrides = options.settings(&loaded.scene);
    let size = check(render::RenderOptions::from(&overrides).size, options, &files.plan(range.first)?)?;
    let setup = Setup::set(options, overrides, &loaded)?;
    let flight = Flight::new(&setup, path, whole);
    flight.check(range)?;

    let open = |path| Animation::open(path, size, range.count(), options.frames.fps, &interrupt);
    let animation = options.frames.animation.as_deref().map(open).transpose()?;
    let statistics = setup.statistics(size);
    let target = Target { run: &outputs, interrupt: &interrupt };
    let mut roll = Roll { setup: &setup, files: &files, flight: &flight, target, animation, statistics };
    let counts = roll.accumulate(range)?;
    let said = roll.animation.take().map(|animation| animation.finish(target)).transpose()?;
    let mut statistics = roll.statistics;
    statistics.seconds.load = load_seconds;
    statistics.frames = Some(counts);
    conclude(options, &files, &statistics, start.elapsed().as_secs_f64(), said)
}

/// The names of the frames' files, once it is known that they can be written.
fn name(options: &RenderOptions, range: Range, outputs: &mut Outputs, interrupt: &Interrupt) -> Result<FrameFiles> {
    // Trying whether files can be written makes some for a moment.
    let _held = interrupt.hold();
    let files = FrameFiles::new(options)?;
    files.check(range, options, outputs)?;
    Ok(files)
}

/// Refuses frames that cannot be held in memory, or in the animation. Columns and rows that are rendered.
fn check(size: [u32; 2], options: &RenderOptions, plan: &Plan) -> Result<[u32; 2]> {
    let region = limits::check(size, options, plan)?;
    if let Some(path) = &options.frames.animation {
        ensure!(
            options.background != Some(Backdrop::None),
            "an animation has no transparent pixels: leave --background none out, or write the frames as pictures"
        );
        animation::check(path, region, options.frames.fps)?;
    }
    Ok(region)
}

/// Frames under way.
struct Roll<'a> {
    setup: &'a Setup<'a>,
    files: &'a FrameFiles,
    flight: &'a Flight,
    target: Target<'a>,
    animation: Option<Animation>,
    statistics: Statistics,
}

impl Roll<'_> {
    /// Renders every frame that is not there.
    fn accumulate(&mut self, range: Range) -> Result<FrameCounts> {
        let mut bar = Bar::new(self.setup.options.quiet, Words::Frames);
        let total = u64::from(range.count()) * THOUSAND;
        let mut counts = FrameCounts::default();
        for (index, frame) in range.frames().enumerate() {
            let before = index as u64 * THOUSAND;
            let plan = self.files.plan(frame)?;
            let camera = self.flight.camera(frame);
            let there = self.there(&plan, &camera)?;
            if there == There::All {
                counts.kept += 1;
                self.show(|| files::read_back(&plan))?;
            } else {
                let mut update = |share: f64| bar.update(before + (share * THOUSAND as f64) as u64, Some(total));
                self.take(&plan, &camera, counts.rendered == 0, &mut update)?;
                counts.rendered += 1;
                counts.renewed += u32::from(there == There::Other);
            }
            bar.update(before + THOUSAND, Some(total));
        }
        Ok(counts)
    }

    fn there(&self, plan: &Plan, camera: &Camera) -> Result<There> {
        if self.setup.options.frames.overwrite {
            return Ok(There::Part);
        }
        let made_of = Shot { setup: self.setup, plan, camera }.origin().provenance();
        files::there(plan, self.statistics.size, &made_of.fingerprint, self.animation.is_some())
    }

    fn take(&mut self, plan: &Plan, camera: &Camera, is_first: bool, progress: &mut dyn FnMut(f64)) -> Result<()> {
        let shot = Shot { setup: self.setup, plan, camera };
        let taken = shot.take(&mut |now| progress(now.done as f64 / now.total.max(1) as f64))?;
        self.statistics.add(&taken);
        let saving = Instant::now();
        let layers: Layers = shot.layers(&taken)?;
        let results = shot.results(&taken, &layers);
        // What the colours mean is said of one frame: of all, it would be a book.
        plan.write(&results, self.target, self.setup.options.quiet || !is_first)?;
        if let Some(animation) = &mut self.animation {
            animation.add(results.shown())?;
        }
        self.statistics.seconds.save += saving.elapsed().as_secs_f64();
        Ok(())
    }

    /// Adds a frame that was not rendered to the animation, if there is one.
    fn show(&mut self, picture: impl FnOnce() -> Result<Rgb8>) -> Result<()> {
        match &mut self.animation {
            Some(animation) => animation.add(&picture()?),
            None => Ok(()),
        }
    }
}

fn conclude(
    options: &RenderOptions,
    files: &FrameFiles,
    statistics: &Statistics,
    total: f64,
    animation: Option<String>,
) -> Result<()> {
    say_statistics(options, statistics)?;
    if options.quiet {
        return Ok(());
    }
    let ([width, height], seconds, counts) =
        (statistics.size, &statistics.seconds, statistics.frames.unwrap_or_default());
    let place = if files.names.is_empty() { String::new() } else { format!("{}: ", files.names) };
    let kept = match counts.kept {
        0 => String::new(),
        kept => format!("; {kept} were there already and are kept, --overwrite renders anew"),
    };
    let renewed = match counts.renewed {
        0 => String::new(),
        renewed => format!("; {renewed} were there of another scene or other options, and are made anew"),
    };
    messages::line(&format!(
        "{place}{} of {width}x{height} pixels on {} in {} (rendering {}, kernels {}){kept}{renewed}",
        messages::count(counts.rendered, "frame"),
        statistics.device,
        messages::seconds(total),
        messages::seconds(seconds.render),
        messages::seconds(seconds.kernel),
    ));
    if let Some(animation) = animation {
        messages::line(&animation);
    }
    Ok(())
}
