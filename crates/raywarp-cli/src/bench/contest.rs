//! One scene: its rays, and everyone who answers them.

use std::path::Path;

use raywarp::accel::Quality;
use raywarp::device::Device;
use raywarp::query::{opaque_triangles, Answers, Cost, RayKind, RaySource, Timed, Workload};
use raywarp::render::default_camera;
use raywarp::scene::Scene;
use raywarp::Triangle;

use super::exchange::{write_rays, write_scene};
use super::options::BenchOptions;
use super::peers::Peer;
use super::results::{differing, Agreement, PeerRow, Results, Row, Speed, Task};
use super::structures::{Built, Structures};
use super::suite::Subject;
use crate::failure::{ensure, Context, Result};
use crate::messages;

/// Rays of a kind that are counted at most.
const COUNTED: usize = 100_000;

/// Everyone who answers, on one device.
pub struct Contest<'a> {
    /// What the command line says.
    pub options: &'a BenchOptions,
    /// Whoever builds.
    pub structures: &'a dyn Structures,
    /// Names of structures and their qualities.
    pub builds: Vec<(String, Quality)>,
    /// Kinds of rays.
    pub kinds: Vec<RayKind>,
    /// Where raywarp runs.
    pub device: &'a Device,
    /// Those that still run.
    pub peers: Vec<Peer>,
    /// Where peers find the scene and the rays.
    pub folder: &'a Path,
}

/// A structure over the scene, on the host and on the device.
struct Entrant {
    name: String,
    quality: Quality,
    built: Built,
}

/// A structure with rays before it.
struct Runner<'a> {
    entrant: &'a Entrant,
    batch: Timed,
    seconds: Vec<f64>,
}

impl Contest<'_> {
    /// Has everyone answer all rays of a scene.
    ///
    /// # Errors
    /// The scene is empty or has no view, or the device fails. A peer that fails is noted, and out.
    pub fn measure(&mut self, subject: &Subject, scene: &Scene, results: &mut Results) -> Result<()> {
        let triangles = opaque_triangles(scene)?;
        ensure!(!triangles.is_empty(), "the scene '{}' has no triangle that a ray can hit", subject.name);
        let camera = subject.view.adjust(default_camera(scene));
        let source = RaySource::new(&triangles, &camera, results.size)?;
        let entrants = self.entrants(&subject.name, &triangles)?;
        self.show_scene(&triangles, results)?;

        let primary = source.primary();
        let first = entrants.first().context("there is no structure to measure")?;
        let spots = source.spots(&primary.rays, &first.built.caster.hits(&primary.rays)?);
        for kind in self.kinds.clone() {
            let workload = source.workload(kind, &spots, self.options.min_rays as usize);
            if workload.rays.is_empty() {
                results.note(&subject.name, format!("the camera sees nothing that {kind} rays could start from"));
                continue;
            }
            let (scene, count) = (subject.name.clone(), workload.rays.len());
            let any_hit = kind.any_hit();
            let task = Task { scene, triangles: triangles.len(), rays: kind, any_hit, count };
            self.race(&task, &workload, &entrants, results)?;
        }
        Ok(())
    }

    /// Builds every structure and copies it to the device.
    fn entrants(&self, scene: &str, triangles: &[Triangle]) -> Result<Vec<Entrant>> {
        let entrant = |(name, quality): &(String, Quality)| {
            messages::line(&format!("{scene}: building {name}, {quality} ..."));
            let built = self.structures.build(name, *quality, triangles, self.device)?;
            Ok(Entrant { name: name.clone(), quality: *quality, built })
        };
        self.builds.iter().map(entrant).collect()
    }

    /// Has the peers build their trees.
    fn show_scene(&mut self, triangles: &[Triangle], results: &mut Results) -> Result<()> {
        if !self.peers.is_empty() {
            write_scene(self.folder, triangles).context("cannot write the scene for the peers")?;
        }
        let folder = self.folder;
        self.ask_peers(results, |peer| peer.scene(folder));
        Ok(())
    }

    /// Asks every peer for something. Those that fail are noted, and out.
    fn ask_peers(&mut self, results: &mut Results, mut ask: impl FnMut(&mut Peer) -> Result<()>) {
        self.peers.retain_mut(|peer| {
            let done = ask(peer);
            if let Err(error) = &done {
                results.note(&peer.about.name, format!("it failed, and is left out from here on: {error}"));
            }
            done.is_ok()
        });
    }

    /// Has everyone answer the same rays.
    fn race(&mut self, task: &Task, workload: &Workload, entrants: &[Entrant], results: &mut Results) -> Result<()> {
        messages::line(&format!("{}: {} {} rays ...", task.scene, task.count, task.rays));
        let runner = |entrant| Runner::new(entrant, task, workload);
        let mut runners = entrants.iter().map(runner).collect::<Result<Vec<_>>>()?;
        if !self.peers.is_empty() {
            write_rays(self.folder, &workload.rays).context("cannot write the rays for the peers")?;
        }
        let folder = self.folder;
        self.ask_peers(results, |peer| peer.rays(folder, task.any_hit));
        for (warmup, repeats) in self.turns(results) {
            for runner in &mut runners {
                runner.seconds.extend(runner.batch.time(warmup, repeats)?);
            }
            self.ask_peers(results, |peer| peer.time(warmup, repeats));
        }

        let mut reference = None;
        for runner in runners {
            let tests = &runner.entrant.built.tests;
            let cost = || Cost::mean(&tests(&workload.rays, task.any_hit, COUNTED));
            let cost = self.options.counts.then(cost);
            let (row, answers) = runner.finish(task)?;
            let differ = reference.as_ref().map_or(0, |reference| differing(&answers, reference));
            results.rows.push(Row { differ, cost, ..row });
            reference.get_or_insert(answers);
        }
        let answers = reference.context("there is no structure to measure")?;
        let mut rows = Vec::new();
        self.ask_peers(results, |peer| peer_row(peer, task, &answers, folder).map(|row| rows.extend(row)));
        results.peers.extend(rows);
        Ok(())
    }

    /// Warm-ups and repeats, in the order in which all have their turn. A GPU does all of one in a row, as the caches
    /// and the clock like it; on a CPU they take turns, as others may have work for it now and then.
    fn turns(&self, results: &Results) -> Vec<(u32, u32)> {
        match self.device.is_cuda() {
            true => vec![(results.warmup, results.repeats)],
            false => (0..results.repeats).map(|turn| (if turn == 0 { results.warmup } else { 0 }, 1)).collect(),
        }
    }
}

impl<'a> Runner<'a> {
    fn new(entrant: &'a Entrant, task: &Task, workload: &Workload) -> Result<Self> {
        Ok(Self { entrant, batch: entrant.built.caster.timed(&workload.rays, task.any_hit)?, seconds: Vec::new() })
    }

    fn finish(mut self, task: &Task) -> Result<(Row, Answers)> {
        let kernel = self.batch.kernel_info()?;
        let answers = self.batch.answers()?;
        let Entrant { name, quality, built: Built { stats, triangle_bytes, .. } } = self.entrant;
        let triangle_bytes = *triangle_bytes;
        let row = Row {
            task: task.clone(),
            layout: name.clone(),
            tree: *quality,
            speed: Speed::of(task.count, self.seconds),
            hit_share: answers.hits() as f64 / task.count as f64,
            differ: 0,
            node_bytes: stats.bytes.saturating_sub(triangle_bytes),
            triangle_bytes,
            sah_cost: stats.sah_cost,
            build_seconds: stats.build_seconds,
            kernel,
            cost: None,
        };
        Ok((row, answers))
    }
}

/// The row of a peer's fastest variant.
fn peer_row(peer: &mut Peer, task: &Task, answers: &Answers, folder: &Path) -> Result<Option<PeerRow>> {
    let Some(fastest) = peer.fastest() else { return Ok(None) };
    let distances = peer.answers(fastest, folder)?;
    ensure!(distances.len() == task.count, "it has {} answers to {} rays", distances.len(), task.count);
    let variant = &peer.variants[fastest];
    Ok(Some(PeerRow {
        task: task.clone(),
        peer: peer.about.clone(),
        variant: variant.name.clone(),
        speed: Speed::of(task.count, variant.seconds.clone()),
        build_seconds: variant.build_seconds,
        agreement: Agreement::of(answers, &distances),
    }))
}
