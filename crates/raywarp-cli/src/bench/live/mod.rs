//! `raywarp bench --live`: the viewer as people feel it, without its window.
//!
//! [`scripted_pointer`] turns the camera as a drag would and [`watch`] times the pictures that come of it; [`encode`] times what a
//! browser would be sent of them. [`rows`] is what came of it and [`table`] how people read it.

mod case;
mod encode;
mod rows;
mod scripted_pointer;
mod table;
mod watch;

use std::time::Duration;

use raywarp::accel::{AccelKind, Quality};
use raywarp::device::Device;
use raywarp::scene::settings::Part;
use raywarp::scene::RenderDefaults;
use raywarp_viewer::live::view_settings::ViewSettings;
use raywarp_viewer::live::{LiveScene, LiveSceneOptions, Source};

use super::machine::Machine;
use super::options::BenchOptions;
use super::results::Note;
use super::suite::{subjects, Subject};
use crate::failure::{ensure, Result};
use crate::interrupt::Interrupt;
use crate::messages;
use crate::render::limit_threads;
use case::Case;
use rows::{Live, Row};
use scripted_pointer::ScriptedPointer;

/// Between two looks at what the stage has ready.
const NAP: Duration = Duration::from_millis(5);

/// Measures the viewer with every scene that the options name.
pub fn run(options: &BenchOptions) -> Result<()> {
    let _ends = Interrupt::install();
    let subjects = subjects(&options.subjects)?;
    limit_threads(options.threads)?;
    let device = Device::open(options.device)?;
    let mut live = Live::new(Machine::of(&device), options.seconds, options.warmup);
    for subject in subjects {
        if let Some(reason) = subject.absent() {
            live.notes.push(Note::said(&subject.name, reason));
            continue;
        }
        for build in builds(options)? {
            let mut live_scene = open(&subject, &device, build)?;
            live.measure(&subject, &mut live_scene, options)?;
        }
    }
    ensure!(!live.rows.is_empty(), "nothing was measured; the notes above say why");
    messages::results(&live, options.json, || live.table())
}

/// Every structure with every quality of tree; no structure: the viewer's own choice.
fn builds(options: &BenchOptions) -> Result<Vec<RenderDefaults>> {
    let layouts: Vec<Option<AccelKind>> = match options.layout.is_empty() {
        true => vec![None],
        false => options.layout.iter().map(|name| Ok(Some(name.parse()?))).collect::<Result<_>>()?,
    };
    // As the viewer shows it, whatever the scene says.
    let usual = RenderDefaults { seed: None, ..ViewSettings::default().render.only(&[Part::Shading]) };
    let build = |accel, tree| RenderDefaults { accel, tree: Some(tree), ..usual };
    let qualities = |accel: Option<AccelKind>| match accel.is_none_or(AccelKind::is_hierarchy) {
        true => options.tree.clone(),
        false => vec![Quality::default()],
    };
    let builds = |accel| qualities(accel).into_iter().map(move |tree| build(accel, tree));
    Ok(layouts.into_iter().flat_map(builds).collect())
}

/// The scene with its good tree.
///
/// # Errors
/// What the stage says of a scene that it cannot show.
fn open(subject: &Subject, device: &Device, overrides: RenderDefaults) -> Result<LiveScene> {
    let source = Source { path: subject.file.clone(), ..Source::default() };
    let options = LiveSceneOptions { overrides, viewpoint: subject.view.clone(), ..LiveSceneOptions::default() };
    let mut live_scene = LiveScene::open(source, device.clone(), options);
    let mut said = None;
    while let Some(busy) = live_scene.busy() {
        if said.as_ref() != Some(&busy) {
            messages::line(&format!("{}: {busy} ...", subject.name));
            said = Some(busy);
        }
        std::thread::sleep(NAP);
        live_scene.poll();
    }
    if let Some(error) = live_scene.take_error() {
        return Err(error.into());
    }
    ensure!(live_scene.is_ready(), "cannot read {}", live_scene.name());
    Ok(live_scene)
}

impl Live {
    /// Every size and case of a scene.
    fn measure(&mut self, subject: &Subject, live_scene: &mut LiveScene, options: &BenchOptions) -> Result<()> {
        for size in options.sizes() {
            for case in Case::ALL {
                let row = self.row(subject, live_scene, size, case)?;
                self.rows.push(row);
            }
        }
        Ok(())
    }

    fn row(&self, subject: &Subject, live_scene: &mut LiveScene, size: [u32; 2], case: Case) -> Result<Row> {
        let mut pointer = ScriptedPointer::new(live_scene, size, case, &subject.view)?;
        let status = pointer.status();
        let ([width, height], structure) = (size, &status.accel);
        ensure!(status.triangles > 0, "the scene '{}' has no triangle: there is nothing to look at", subject.name);
        messages::line(&format!("{}: {width}x{height}, {case}, {structure} ...", subject.name));
        let watched = watch::watch(&mut pointer, case, self.seconds, self.warmup)?;
        Row::new(&subject.name, &status, case, &watched, &pointer.rest)
    }
}
