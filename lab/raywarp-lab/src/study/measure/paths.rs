//! Rays over several bounces: in one kernel, and bounce by bounce through queues.

use raywarp::accel::Accel;
use raywarp::query::RaySource;
use raywarp_lab::paths::{PathBatch, Scheme, Surfaces};
use raywarp_lab::structures::Tree;

use super::milliseconds;
use super::scene::Stage;
use crate::study::findings::PathWay;

use raywarp_cli::failure::{ensure, Result};

/// Rays after the first one, as the paper's scene has them.
const BOUNCES: u32 = 5;

/// Mirrors and diffuse surfaces, by every scheme.
pub fn paths(stage: &Stage) -> Result<Vec<PathWay>> {
    stage.say("following paths");
    let mut rows = Vec::new();
    let Tree::Product(Accel::Bvh2(tree)) = &stage.tree else { return Ok(rows) };
    let source = RaySource::new(&stage.triangles, &stage.camera, stage.setting.size)?;
    let offset = source.offset();
    let rays = source.primary().rays;
    for (name, surfaces) in [("reflected", Surfaces::Mirrors), ("diffuse", Surfaces::Diffuse)] {
        let device = stage.setting.device;
        let mut batch = PathBatch::new(device, tree, &stage.triangles, &rays, surfaces, BOUNCES, offset)?;
        let (mut plain, mut expected) = (None, None);
        for (way, scheme) in [
            ("one kernel", Scheme::OneKernel),
            ("wavefront", Scheme::Wavefront),
            ("wavefront, sorted", Scheme::SortedWavefront),
        ] {
            let [warmup, repeats] = stage.setting.times;
            let (mut seconds, mut sorting) = (Vec::new(), 0.0);
            for index in 0..warmup + repeats {
                let time = batch.follow(scheme)?;
                if index >= warmup {
                    seconds.push(time.seconds);
                    sorting += time.sorting / f64::from(repeats);
                }
            }
            let trails = batch.trails()?;
            let traced: u64 = trails.iter().map(|trail| u64::from(trail.rays)).sum();
            ensure!(
                *expected.get_or_insert_with(|| trails.clone()) == trails,
                "paths differ between one kernel and {way}: one of them is wrong; report it"
            );
            let ms = milliseconds(seconds);
            let mrays_per_s = 1e-3 * traced as f64 / ms.median.max(1e-9);
            let gain = mrays_per_s / *plain.get_or_insert(mrays_per_s);
            let (way, rays, sorting_ms) = (way.to_owned(), name.to_owned(), 1e3 * sorting);
            rows.push(PathWay { way, rays, bounces: BOUNCES, traced, ms, mrays_per_s, sorting_ms, gain });
        }
    }
    Ok(rows)
}
