//! Rays over several bounces: in one kernel, and bounce by bounce through queues.

use raywarp::accel::Accel;
use raywarp::query::RaySource;
use raywarp::study::paths::{PathBatch, Scheme};

use super::milliseconds;
use super::scene::Stage;
use crate::study::findings::PathWay;

/// Rays after the first one, as the paper's scene has them.
const BOUNCES: u32 = 5;

/// How far rays start above a surface, in units of the scene's diagonal: as those of the workloads.
const OFFSET: f32 = 1e-5;

/// Mirrors and diffuse surfaces, by every scheme.
pub fn paths(stage: &Stage) -> anyhow::Result<Vec<PathWay>> {
    stage.say("following paths");
    let mut rows = Vec::new();
    let Accel::Bvh2(tree) = &stage.tree else { return Ok(rows) };
    let source = RaySource::new(&stage.triangles, &stage.camera, stage.setting.size)?;
    let offset = OFFSET * source.diagonal();
    let rays = source.primary().rays;
    for (name, diffuse) in [("reflected", 0), ("diffuse", 1)] {
        let device = stage.setting.device;
        let mut batch = PathBatch::new(device, tree, &stage.triangles, &rays, [BOUNCES, diffuse], offset)?;
        let mut plain = None;
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
            let traced: u64 = batch.trails()?.iter().map(|trail| u64::from(trail.rays)).sum();
            let ms = milliseconds(seconds);
            let mrays_per_s = 1e-3 * traced as f64 / ms.median.max(1e-9);
            let gain = mrays_per_s / *plain.get_or_insert(mrays_per_s);
            let (way, rays, sorting_ms) = (way.to_owned(), name.to_owned(), 1e3 * sorting);
            rows.push(PathWay { way, rays, bounces: BOUNCES, traced, ms, mrays_per_s, sorting_ms, gain });
        }
    }
    Ok(rows)
}
