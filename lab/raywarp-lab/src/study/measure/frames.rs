//! Whole frames: their time by structure, where it goes, how it is spread over threads, and blocks of several shapes.

use raywarp::accel::{AccelKind, Quality};
use raywarp::device_scene::world_triangles;
use raywarp::image::{heatmap, png};
use raywarp::render::{PixelCosts, RenderOptions, Tracer};
use raywarp::Triangle;
use raywarp_lab::clocks::stage_times;
use raywarp_lab::structures::{Build, StructureKind, Tree};

use super::scene::{Stage, PLAIN};
use super::structures::name;
use super::{milliseconds, Setting};
use crate::study::findings::{BlockShape, Distribution, FrameTime, Load, StageShares};

use raywarp_cli::failure::Result;

/// Structures that render frames. Those that test every triangle only do where that takes no longer than a few seconds.
const KINDS: [StructureKind; 7] = [
    StructureKind::BRUTE,
    StructureKind::Staged,
    StructureKind::KD,
    StructureKind::KdSah,
    StructureKind::KdTrail,
    StructureKind::BVH2,
    StructureKind::Bvh2c,
];

/// Those whose threads' load is shown.
const LOADS: [StructureKind; 3] = [StructureKind::KD, StructureKind::KdSah, StructureKind::BVH2];

/// Columns and rows.
const SHAPES: [[u32; 2]; 6] = [[8, 4], [8, 8], [8, 16], [16, 16], [32, 1], [32, 4]];

/// Rays that the paper's frame has for each camera ray, about: for guessing how long it takes.
const RAYS_A_PIXEL: u64 = 5;

/// A frame's time.
pub struct Timed {
    pub structure: &'static str,
    pub frame: FrameTime,
}

/// All that is learnt from frames.
#[derive(Default)]
pub struct Found {
    pub times: Vec<Timed>,
    pub shares: Vec<StageShares>,
    pub loads: Vec<Load>,
    pub shapes: Vec<BlockShape>,
}

/// What a frame has: its name, and its options.
fn sorts(setting: &Setting) -> [(&'static str, RenderOptions); 2] {
    let all = RenderOptions { size: setting.size, spp: 1, ..RenderOptions::default() };
    [("primary", RenderOptions { max_depth: 0, shadows: false, ..all }), ("all", all)]
}

/// Renders the scene by every structure that can.
pub fn frames(stage: &Stage) -> Result<Found> {
    let setting = stage.setting;
    let triangles = world_triangles(stage.scene, &stage.scene.instances, &stage.scene.materials)?;
    let mut tracer = Tracer::new(stage.scene, AccelKind::Bvh2, setting.device)?;
    let mut found = Found::default();
    let sorts = sorts(setting);
    let mut traced = Vec::new();
    for (_, options) in &sorts {
        traced.push(tracer.costs(&stage.camera, options)?.tests.iter().map(|tests| u64::from(tests.rays)).sum());
    }
    for kind in KINDS {
        let build = Build { kind, quality: Quality::Medium };
        if kind.is_exhaustive() && too_long(setting, &triangles) {
            continue;
        }
        stage.say(&format!("frames by {}", name(build)));
        tracer.scene_mut()?.replace(Tree::build(build, triangles.clone())?.structure(build.quality, setting.device)?);
        for ((rays, options), &traced) in sorts.iter().zip(&traced) {
            let (rays, structure) = (*rays, name(build));
            let ms = milliseconds(times(stage, &tracer, options, setting.times_of(kind))?);
            found.times.push(Timed { structure, frame: FrameTime { rays: rays.to_owned(), ms, traced } });
            found.shares.extend(shares(stage, &tracer, options, structure, rays)?);
            if LOADS.contains(&kind) {
                found.loads.push(load(stage, &tracer, options, structure, rays)?);
            }
            if build == PLAIN {
                found.shapes.extend(shapes(stage, &mut tracer, options, rays)?);
            }
        }
    }
    Ok(found)
}

fn too_long(setting: &Setting, triangles: &[Triangle]) -> bool {
    let [width, height] = setting.size.map(u64::from);
    width * height * triangles.len() as u64 * RAYS_A_PIXEL > 10 * setting.most_tests
}

fn times(stage: &Stage, tracer: &Tracer, options: &RenderOptions, [warmup, repeats]: [u32; 2]) -> Result<Vec<f64>> {
    let mut seconds = Vec::new();
    for index in 0..warmup + repeats {
        let rendering = tracer.render(&stage.camera, options, &mut |_| ())?;
        if index >= warmup {
            seconds.push(rendering.kernel_seconds);
        }
    }
    Ok(seconds)
}

/// Shares of the three stages, where the structure has kernels with clocks.
fn shares(
    stage: &Stage,
    tracer: &Tracer,
    options: &RenderOptions,
    structure: &str,
    rays: &str,
) -> Result<Option<StageShares>> {
    let Some(times) = stage_times(tracer, &stage.camera, options)? else { return Ok(None) };
    let sum = times.iter().sum::<u64>().max(1) as f64;
    let [generation, intersection, shading] = times.map(|time| time as f64 / sum);
    let (structure, rays) = (structure.to_owned(), rays.to_owned());
    Ok(Some(StageShares { structure, rays, generation, intersection, shading }))
}

fn load(stage: &Stage, tracer: &Tracer, options: &RenderOptions, structure: &str, rays: &str) -> Result<Load> {
    // The first time may be in cold caches.
    tracer.costs(&stage.camera, options)?;
    let PixelCosts { ticks, tests } = tracer.costs(&stage.camera, options)?;
    let work: Vec<u32> = tests.iter().map(|tests| tests.nodes.saturating_add(tests.triangles)).collect();
    let time = Distribution::of(ticks.iter().map(|&ticks| f64::from(ticks)).collect());
    let [width, height] = options.size;
    // The slowest threads are few: a scale up to them would leave the picture black.
    let top = (2.0 * time.p95).max(1.0).min(time.most.max(1.0)) as u32;
    Ok(Load {
        structure: structure.to_owned(),
        rays: rays.to_owned(),
        unit: if stage.setting.device.is_cuda() { "cycles" } else { "ns" },
        warp_balance: balance(&work, options.size, [8, 4]),
        block_balance: balance(&work, options.size, [8, 16]),
        picture: heat_map(&ticks, [width, height], top)?,
        brightest: f64::from(top),
        time,
    })
}

/// Columns of a heat map at most: a report has many.
const COLUMNS: u32 = 480;

/// Colours for means over squares of pixels.
fn heat_map(ticks: &[u32], [width, height]: [u32; 2], top: u32) -> Result<Vec<u8>> {
    let side = width.div_ceil(COLUMNS).max(1);
    let [columns, rows] = [width, height].map(|pixels| (pixels / side).max(1));
    let mean = |[column, row]: [u32; 2]| {
        let (x0, y0) = (column * side, row * side);
        let square = (y0..y0 + side).flat_map(|y| (x0..x0 + side).map(move |x| (y * width + x) as usize));
        let (sum, count) = square
            .filter_map(|pixel| ticks.get(pixel))
            .fold((0u64, 0), |(sum, count), &ticks| (sum + u64::from(ticks), count + 1));
        (sum / count.max(1)) as u32
    };
    let means: Vec<u32> = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])).map(mean).collect();
    Ok(png::encode(&heatmap::colours(columns, rows, &means, top))?)
}

/// Mean over tiles of the mean work of their pixels over the most.
fn balance(work: &[u32], [width, height]: [u32; 2], [columns, rows]: [u32; 2]) -> f64 {
    let (mut sum, mut tiles) = (0.0, 0);
    for y0 in (0..height).step_by(rows as usize) {
        for x0 in (0..width).step_by(columns as usize) {
            let (x1, y1) = ((x0 + columns).min(width), (y0 + rows).min(height));
            let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| y as usize * width as usize + x as usize));
            let tile: Vec<f64> = pixels.filter_map(|pixel| work.get(pixel)).map(|&work| f64::from(work)).collect();
            let most = tile.iter().copied().fold(0.0, f64::max);
            if most > 0.0 {
                sum += tile.iter().sum::<f64>() / tile.len() as f64 / most;
                tiles += 1;
            }
        }
    }
    if tiles == 0 {
        1.0
    } else {
        sum / f64::from(tiles)
    }
}

/// The same frame by blocks of several shapes; on the CPU, by tiles.
fn shapes(stage: &Stage, tracer: &mut Tracer, options: &RenderOptions, rays: &'static str) -> Result<Vec<BlockShape>> {
    let mut rows = Vec::new();
    for shape in SHAPES {
        tracer.set_block(Some(shape))?;
        let ms = milliseconds(times(stage, tracer, options, stage.setting.times)?);
        rows.push(BlockShape { shape, rays: rays.to_owned(), ms });
    }
    tracer.set_block(None)?;
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balance_is_the_mean_over_the_most() {
        // Two tiles of 8 x 4: one even, one with a single costly pixel.
        let mut work = vec![10; 16 * 4];
        work[8] = 320;
        let expected = 0.5 * (1.0 + (31.0 * 10.0 + 320.0) / 32.0 / 320.0);
        assert!((balance(&work, [16, 4], [8, 4]) - expected).abs() < 1e-12);
        assert_eq!(balance(&[0; 32], [8, 4], [8, 4]), 1.0);
    }
}
