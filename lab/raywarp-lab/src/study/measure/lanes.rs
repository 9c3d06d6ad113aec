//! What the lanes of a warp do: followed on the CPU, whatever the device, and so the same everywhere.

use raywarp::accel::{Accel, AccelKind};
use raywarp::device::{Device, DeviceChoice};
use raywarp::render::{RenderOptions, Tracer};
use raywarp_lab::clocks::follow;
use raywarp_lab::lanes::{batch, frame, LaneSteps, Log, LoopForm, WARP};
use raywarp_lab::structures::Tree;

use super::scene::Stage;
use crate::study::findings::LaneUse;

use raywarp_cli::failure::Result;

/// Columns and rows of a warp's pixels.
const TILE: [u32; 2] = [8, 4];

/// Batches of every kind by every loop, and whole frames by the renderer's.
pub fn lanes(stage: &Stage) -> Result<Vec<LaneUse>> {
    stage.say("following warps");
    let mut rows = Vec::new();
    let Tree::Product(Accel::Bvh2(tree)) = &stage.tree else { return Ok(rows) };
    for workload in stage.workloads.iter().filter(|workload| !workload.rays.is_empty()) {
        for form in LoopForm::ALL {
            let steps = batch(tree, &workload.rays, workload.kind.any_hit(), form, stage.setting.followed);
            rows.push(row(form, workload.kind.to_string(), &steps));
        }
    }
    let tracer = Tracer::new(stage.scene, AccelKind::Bvh2, &Device::open(DeviceChoice::Cpu)?)?;
    for (rays, max_depth, shadows) in [("frame, primary", 0, false), ("frame, all", 5, true)] {
        let options =
            RenderOptions { size: stage.setting.size, spp: 1, max_depth, shadows, ..RenderOptions::default() };
        let mut sum = LaneSteps::default();
        for pixels in tiles(options.size, stage.setting.followed) {
            let logs: Option<Vec<Log>> = follow(&tracer, &stage.camera, &options, &pixels)?;
            sum = sum.plus(frame(&logs.unwrap_or_default()));
        }
        rows.push(row(LoopForm::WhileWhile, rays.to_owned(), &sum));
    }
    Ok(rows)
}

fn row(form: LoopForm, rays: String, steps: &LaneSteps) -> LaneUse {
    let all = (steps.steps * WARP as u64).max(1) as f64;
    let share = |lanes: u64| lanes as f64 / all;
    LaneUse {
        form: form.name().to_owned(),
        rays,
        steps: steps.steps,
        useful: share(steps.useful),
        boxes: share(steps.boxes),
        leaves: share(steps.leaves),
        finished: share(steps.finished),
        shading: share(steps.shading),
    }
}

/// The pixels of at most so many warps, evenly over the picture.
fn tiles([width, height]: [u32; 2], most: usize) -> Vec<Vec<[u32; 2]>> {
    let [columns, rows] = TILE.map(|side| side as usize);
    let corners = || (0..height).step_by(rows).flat_map(move |y| (0..width).step_by(columns).map(move |x| [x, y]));
    let step = corners().count().div_ceil(most.max(1)).max(1);
    let tile = |[x0, y0]: [u32; 2]| {
        let (x1, y1) = ((x0 + TILE[0]).min(width), (y0 + TILE[1]).min(height));
        (y0..y1).flat_map(|y| (x0..x1).map(move |x| [x, y])).collect()
    };
    corners().step_by(step).map(tile).collect()
}
