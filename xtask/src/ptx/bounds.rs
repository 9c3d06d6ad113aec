//! Launch bounds. Rust has no attribute for them, so they are written into the PTX here.

/// What a kernel is promised about its launches, and told about registers.
#[derive(Clone, Copy)]
struct Bounds {
    /// Most threads in a block: the host never launches larger ones.
    threads: u32,
    /// Blocks that should fit on a multiprocessor at once; 0 leaves it to the driver.
    blocks: u32,
    /// Most registers a thread; 0 leaves it to the driver.
    registers: u32,
}

const DEFAULT: Bounds = Bounds { threads: 128, blocks: 0, registers: 0 };

/// Those that blocks of several shapes are tried with. Their registers are given: the driver would make them depend on
/// the size of the block.
const ANY_BLOCK: Bounds = Bounds { threads: 256, ..DEFAULT };

/// What traces through boxes, and nothing else: half of the threads of a multiprocessor fit.
const TRACING: Bounds = Bounds { registers: 64, ..ANY_BLOCK };

/// As [`TRACING`], with a loop for each octant: fewer threads fit, but nothing spills.
const OCTANTS: Bounds = Bounds { registers: 72, ..ANY_BLOCK };

/// Half of what a ray needs is in shared memory: more threads fit where only any hit is looked for.
const PERSISTENT: Bounds = Bounds { registers: 56, ..DEFAULT };

/// The first row whose first column begins a kernel's name holds; [`DEFAULT`] where none does.
/// Tune here, run `cargo xtask ptx`, and read the effect in `docs/kernels.md`.
const TABLE: &[(&str, Bounds)] = &[
    ("whitted_brute", Bounds { registers: 64, ..ANY_BLOCK }),
    ("whitted_kd", Bounds { registers: 72, ..ANY_BLOCK }),
    ("whitted_bvh2", Bounds { registers: 128, ..ANY_BLOCK }),
    ("whitted_two_level", Bounds { registers: 128, ..ANY_BLOCK }),
    ("closest_bvh_persistent", Bounds { registers: 64, ..DEFAULT }),
    ("occluded_bvh_persistent", PERSISTENT),
    ("closest_bvh2", TRACING),
    ("closest_bvh4", TRACING),
    ("closest_bvh8", TRACING),
    ("closest_bvh", OCTANTS),
    ("occluded_bvh", TRACING),
    ("whitted_staged", Bounds { registers: 64, ..DEFAULT }),
    ("closest_ifif", TRACING),
    ("closest_whilewhile", TRACING),
    ("closest_speculative", TRACING),
    ("closest_postponed", TRACING),
    ("closest_queued", TRACING),
    ("closest_refill", TRACING),
    ("occluded_ifif", TRACING),
    ("occluded_whilewhile", TRACING),
    ("occluded_speculative", TRACING),
    ("occluded_postponed", TRACING),
    ("occluded_queued", TRACING),
    ("occluded_refill", TRACING),
    ("paths", TRACING),
    ("bounce", TRACING),
];

/// The directives to put between a kernel's parameters and its body, one a line.
pub fn directives(kernel: &str) -> String {
    let row = TABLE.iter().find(|(start, _)| kernel.starts_with(start));
    let Bounds { threads, blocks, registers } = row.map_or(DEFAULT, |(_, bounds)| *bounds);
    let mut text = format!(".maxntid {threads}, 1, 1\n");
    if blocks > 0 {
        text += &format!(".minnctapersm {blocks}\n");
    }
    if registers > 0 {
        text += &format!(".maxnreg {registers}\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A kernel that was called otherwise would silently get the bounds of another row.
    #[test]
    fn every_row_is_the_first_that_some_kernel_meets() {
        let kernels = || raywarp_core::kernels::NAMES.iter().chain(raywarp_lab_core::kernels::NAMES);
        for (row, (start, _)) in TABLE.iter().enumerate() {
            let first = |kernel: &&&str| TABLE.iter().position(|(start, _)| kernel.starts_with(start)) == Some(row);
            assert!(kernels().any(|kernel| first(&kernel)), "no kernel begins with {start}");
        }
    }
}
