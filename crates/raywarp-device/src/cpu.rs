//! The CPU as a device: a launch is a parallel loop over tiles of threads.

use std::time::Instant;

use rayon::prelude::*;
use raywarp_core::kernels::{Kernel, Thread};

/// Columns and rows that one task computes: neighbours meet the same nodes.
const TILE: [u32; 2] = [16, 8];

/// Items of a batch that one task computes.
pub(crate) const BATCH: u32 = TILE[0] * TILE[1];

pub(crate) fn description() -> String {
    match rayon::current_num_threads() {
        1 => "CPU, 1 thread".to_owned(),
        threads => format!("CPU, {threads} threads"),
    }
}

/// Threads of a batch of which each thread of the CPU has one task.
pub(crate) fn resident_threads() -> u32 {
    rayon::current_num_threads() as u32 * BATCH
}

/// Runs every thread of the launch; returns the seconds it took.
///
/// # Safety
/// As for [`Device::launch`](super::Device::launch).
pub(crate) unsafe fn launch<K: Kernel>(kernel: &K, extent: [u32; 2], block: Option<[u32; 2]>) -> f64 {
    let start = Instant::now();
    // One row means a batch of items, cut into runs.
    let tile = match (extent[1], block) {
        (1, block) => [block.map_or(BATCH, |[columns, rows]| columns * rows), 1],
        (_, block) => block.unwrap_or(TILE),
    };
    let columns = extent[0].div_ceil(tile[0]) as u64;
    let tiles = columns * extent[1].div_ceil(tile[1]) as u64;
    let run = runner::<K>();
    (0..tiles).into_par_iter().for_each(|index| {
        let corner = [(index % columns) as u32 * tile[0], (index / columns) as u32 * tile[1]];
        let end = [0, 1].map(|i| extent[i].min(corner[i].saturating_add(tile[i])));
        // SAFETY: `runner` asked the processor for the instructions of what it returned, tiles do not overlap, and the
        // views are the caller's promise.
        unsafe { run(kernel, corner, end) };
    });
    start.elapsed().as_secs_f64()
}

type Runner<K> = unsafe fn(&K, [u32; 2], [u32; 2]);

/// The fastest tile loop that this processor can run. All give the same bits; without the fused instruction
/// multiply-adds are computed in software.
fn runner<K: Kernel>() -> Runner<K> {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        return run_tile_fused::<K>;
    }
    run_tile::<K>
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn run_tile_fused<K: Kernel>(kernel: &K, corner: [u32; 2], end: [u32; 2]) {
    // SAFETY: the caller's promise.
    unsafe { run_tile(kernel, corner, end) }
}

#[inline(always)]
unsafe fn run_tile<K: Kernel>(kernel: &K, corner: [u32; 2], end: [u32; 2]) {
    for y in corner[1]..end[1] {
        for x in corner[0]..end[0] {
            // SAFETY: the caller's promise; each thread of the tile once.
            unsafe { kernel.thread(Thread { x, y }) };
        }
    }
}
