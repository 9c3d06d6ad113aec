//! The kernels of a build in their order.

use raywarp_core::arch::BLOCK;
use raywarp_core::build::emit::EmitNodes;
use raywarp_core::build::gather::GatherTriangles;
use raywarp_core::build::hploc::Hploc;
use raywarp_core::build::morton::MortonCodes;
use raywarp_core::build::node::Node;
use raywarp_core::build::radix_sort::{CountDigits, ScanDigits, ScatterDigits, BITS, DIGITS};
use raywarp_core::build::subtrees::FindSubtrees;
use raywarp_core::build::survey::{Findings, Survey};
use raywarp_core::kernels::Kernel;
use raywarp_device::kernels::Views;

use super::scratch::{runs, Scratch};
use super::{stats_of, DeviceTree, NodeSizes};
use crate::accel::bounds::Bounds;
use crate::accel::{bvh2_quantized, BuildError};
use crate::device::{Buffer, Device, DeviceError};
use crate::Triangle;

/// Bits of a key.
const KEY_BITS: u32 = 32;

/// Sorts the triangles and merges them into a binary tree, all in `scratch`, which has room for them and was cleared.
pub(super) fn merge(device: &Device, scratch: &mut Scratch, triangles: &Buffer<Triangle>) -> Result<(), DeviceError> {
    let (list, count) = (triangles.view(), triangles.len());
    let runs = runs(count as usize) as u32;
    in_blocks(device, &Survey { triangles: list, findings: scratch.findings.view_mut() }, runs)?;
    let [first, _] = &mut scratch.pairs;
    let codes = MortonCodes { triangles: list, findings: scratch.findings.view(), keys: first.view_mut() };
    in_threads(device, &codes, count)?;
    sort(device, scratch, count, runs)?;
    let [sorted, _] = &scratch.pairs;
    let hploc = Hploc {
        triangles: list,
        findings: scratch.findings.view(),
        sorted: sorted.view(),
        ends: scratch.ends.view_mut(),
        lists: scratch.lists.view_mut(),
        nodes: scratch.nodes.view_mut(),
    };
    in_threads(device, &hploc, count)?;
    // The lists of clusters have done their work.
    let find = FindSubtrees {
        tree: scratch.nodes.view(),
        given: count,
        findings: scratch.findings.view_mut(),
        subtrees: scratch.lists.view_mut(),
    };
    in_threads(device, &find, count)
}

/// Sorts the first `count` pairs; there is an even number of digits, so the last array that is written is the first one.
fn sort(device: &Device, scratch: &mut Scratch, count: u32, runs: u32) -> Result<(), DeviceError> {
    const { assert!((KEY_BITS / BITS).is_multiple_of(2)) };
    for digit in 0..KEY_BITS / BITS {
        let shift = digit * BITS;
        let [a, b] = &mut scratch.pairs;
        let (from, to) = if digit % 2 == 0 { (a, b) } else { (b, a) };
        let pairs = from.view().part(0, count);
        in_blocks(device, &CountDigits { pairs, shift, runs, counts: scratch.counts.view_mut() }, runs)?;
        let (counts, totals) = (scratch.counts.view_mut(), scratch.totals.view_mut());
        in_blocks(device, &ScanDigits { runs, counts, totals }, DIGITS)?;
        let (counts, totals) = (scratch.counts.view(), scratch.totals.view());
        in_blocks(device, &ScatterDigits { pairs, shift, runs, counts, totals, sorted: to.view_mut() }, runs)?;
    }
    Ok(())
}

/// Makes the tree of the merged one in `scratch`, which has this root and is not too deep.
pub(super) fn emit(
    device: &Device,
    scratch: &mut Scratch,
    triangles: &Buffer<Triangle>,
    sizes: NodeSizes,
    (found, root): &(Findings, Node),
) -> Result<DeviceTree, BuildError> {
    let grid = bvh2_quantized::grid(&Bounds { low: root.low.to_array(), high: root.high.to_array() });
    let (nodes, count) = (root.nodes.max(1) as usize, root.count as usize);
    let bytes = DeviceTree::bytes(nodes, count, sizes);
    device.reserve(bytes, "the tree")?;
    let mut tree = DeviceTree::reserve(device, nodes, count, sizes, grid, stats_of(root, bytes))?;
    tree.reach = reach(root);
    write_nodes(device, scratch, triangles, &mut tree, found.subtrees)?;
    let order = scratch.order.view();
    let gather = GatherTriangles { triangles: triangles.view(), order, ordered: tree.triangles.view_mut() };
    in_threads(device, &gather, count as u32)?;
    Ok(tree)
}

fn write_nodes(
    device: &Device,
    scratch: &mut Scratch,
    triangles: &Buffer<Triangle>,
    tree: &mut DeviceTree,
    subtrees: u32,
) -> Result<(), DeviceError> {
    let emit = EmitNodes {
        tree: scratch.nodes.view(),
        triangles: triangles.view(),
        subtrees: scratch.lists.view().part(0, subtrees),
        sorted: scratch.pairs[0].view(),
        grid: tree.grid,
        full: tree.full.view_mut(),
        small: tree.small.view_mut(),
        order: scratch.order.view_mut(),
    };
    in_threads(device, &emit, subtrees)
}

/// See [`Bvh2::reach`](crate::accel::bvh2::Bvh2::reach).
fn reach(root: &Node) -> crate::Vec3 {
    let far = |axis| root.low[axis].abs().max(root.high[axis].abs());
    crate::Vec3::new(far(0), far(1), far(2))
}

fn in_blocks<K: Kernel>(device: &Device, kernel: &K, blocks: u32) -> Result<(), DeviceError> {
    in_threads(device, kernel, blocks * BLOCK)
}

fn in_threads<K: Kernel>(device: &Device, kernel: &K, threads: u32) -> Result<(), DeviceError> {
    // SAFETY: the views are of buffers of the device that outlive this call, and what is done with them afterwards waits
    // in the order of its own stream. The indices in them are places below the number of triangles, for which all have
    // room, and the kernels before have written them.
    unsafe { device.launch(kernel, [threads, 1]) }
}
