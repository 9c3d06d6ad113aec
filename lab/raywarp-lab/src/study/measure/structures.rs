//! Every structure: how large, how good, how fast.

use raywarp::accel::{Accel, Quality};
use raywarp::query::{RayCaster, Workload};
use raywarp::Ray;
use raywarp_lab::structures::{Build, StructureKind, Tree};

use super::frames::Timed;
use super::rate;
use super::scene::{Stage, PLAIN};
use crate::study::findings::{Rate, Structure};

use raywarp_cli::failure::Result;

/// Arithmetic of a triangle's test on the way that most take: nine differences, six products of three with their sums,
/// three determinants of two products. Comparisons are not counted, nor what only hits need.
const TEST_FLOPS: f64 = 9.0 + 6.0 * 5.0 + 3.0 * 3.0;

/// Rays that fill a large GPU a few times.
const FEWEST: usize = 500_000;

/// A structure that was built.
pub struct Entrant {
    pub name: &'static str,
    pub build: Build,
    pub tree: Tree,
}

/// What is compared, and what it is called.
const STRUCTURES: [(StructureKind, Quality, &str); 14] = [
    (StructureKind::BRUTE, Quality::Medium, "brute force"),
    (StructureKind::Staged, Quality::Medium, "brute force, staged"),
    (StructureKind::KD, Quality::Medium, "k-d tree of the paper"),
    (StructureKind::KdSah, Quality::Medium, "k-d tree, SAH"),
    (StructureKind::KdTrail, Quality::Medium, "k-d tree, SAH, short stack"),
    (StructureKind::BVH2, Quality::Fast, "BVH2, fast"),
    (StructureKind::BVH2, Quality::Medium, "BVH2, medium"),
    (StructureKind::BVH2, Quality::High, "BVH2, high"),
    (StructureKind::Bvh2c, Quality::Medium, "BVH2, 16 bits"),
    (StructureKind::BVH, Quality::Medium, "BVH2 in two layouts"),
    (StructureKind::Bvh4, Quality::Medium, "BVH4, 8 bits"),
    (StructureKind::Bvh8, Quality::Medium, "BVH8, compressed"),
    (StructureKind::Bvh8w, Quality::Medium, "BVH8, 8 bits"),
    (StructureKind::BVH8F, Quality::Medium, "BVH8, full"),
];

/// What the report calls a structure.
pub fn name(build: Build) -> &'static str {
    let same = |(kind, quality, _): &&(StructureKind, Quality, _)| (*kind, *quality) == (build.kind, build.quality);
    STRUCTURES.iter().find(same).map_or("", |(_, _, name)| name)
}

/// Builds all of them; what can be had from another is made of it.
pub fn entrants(stage: &Stage) -> Result<Vec<Entrant>> {
    let mut entrants: Vec<Entrant> = Vec::new();
    for (kind, quality, name) in STRUCTURES {
        stage.say(&format!("building {name}"));
        let build = Build { kind, quality };
        let tree = match (&stage.tree, &entrants.last()) {
            (Tree::Product(Accel::Bvh2(tree)), _) if kind.is_hierarchy() && quality == PLAIN.quality => {
                Tree::laid_out(kind, tree.clone())?
            }
            (_, Some(Entrant { tree: Tree::KdSah(tree), .. })) if kind == StructureKind::KdTrail => {
                Tree::KdTrail(tree.clone())
            }
            _ => Tree::build(build, stage.triangles.clone())?,
        };
        entrants.push(Entrant { name, build, tree });
    }
    Ok(entrants)
}

/// Rays a second by each structure.
pub fn rates(stage: &Stage, entrants: &[Entrant]) -> Result<Vec<Vec<Rate>>> {
    let of = |entrant: &Entrant| {
        stage.say(&format!("rays by {}", entrant.name));
        let caster = entrant.tree.caster(stage.setting.device)?;
        let of_kind = |workload: &Workload| rate_of(stage, entrant, &caster, workload).transpose();
        stage.workloads.iter().filter(|workload| !workload.rays.is_empty()).filter_map(of_kind).collect()
    };
    entrants.iter().map(of).collect()
}

fn rate_of(stage: &Stage, entrant: &Entrant, caster: &RayCaster, workload: &Workload) -> Result<Option<Rate>> {
    let kind = entrant.build.kind;
    let most = match kind.is_exhaustive() {
        true => (stage.setting.most_tests / stage.triangles.len() as u64) as usize,
        false => usize::MAX,
    };
    if stage.setting.device.is_cuda() && most < workload.rays.len().min(FEWEST) {
        return Ok(None);
    }
    let rays = thinned(&workload.rays, most);
    let [warmup, repeats] = stage.setting.times_of(kind);
    let seconds = caster.timed(&rays, workload.kind.any_hit())?.time(warmup, repeats)?;
    Ok(Some(Rate { rays: workload.kind.to_string(), count: rays.len(), mrays_per_s: rate(rays.len(), seconds) }))
}

/// Every n-th run of 32 rays, with the smallest n that leaves at most `most`, or a single run.
fn thinned(rays: &[Ray], most: usize) -> Vec<Ray> {
    let step = rays.len().div_ceil(most.max(32)).max(1);
    rays.chunks(32).step_by(step).flatten().copied().collect()
}

/// What the report says of each.
pub fn rows(stage: &Stage, entrants: Vec<Entrant>, rates: Vec<Vec<Rate>>, frames: &[Timed]) -> Vec<Structure> {
    let peak = stage.setting.peak_flops;
    let row = |(entrant, rates): (Entrant, Vec<Rate>)| {
        let build = entrant.build;
        let frames = frames.iter().filter(|timed| timed.structure == entrant.name).map(|timed| timed.frame.clone());
        // Every camera ray tests every triangle.
        let tests = |rate: &Rate| rate.mrays_per_s.median * 1e6 * stage.triangles.len() as f64;
        let share = |peak: f64| rates.first().map(|rate| tests(rate) * TEST_FLOPS / peak);
        Structure {
            name: entrant.name.to_owned(),
            accel: build.kind.to_string(),
            tree: build.kind.is_hierarchy().then(|| build.quality.to_string()),
            stats: entrant.tree.stats(),
            share_of_peak: peak.filter(|_| build.kind.is_exhaustive()).and_then(share),
            frames: frames.collect(),
            rates,
        }
    };
    entrants.into_iter().zip(rates).map(row).collect()
}
