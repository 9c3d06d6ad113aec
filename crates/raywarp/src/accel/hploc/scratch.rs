//! Memory that builds need beside what they read and write.

use raywarp_core::build::node::Node;
use raywarp_core::build::radix_sort::DIGITS;
use raywarp_core::build::survey::Findings;
use raywarp_core::build::TILE;

use crate::device::{Buffer, Device, DeviceError};

/// Arrays for up to so many triangles; see the kernels of [`raywarp_core::build`] for what is in them.
pub(super) struct Scratch {
    pub findings: Buffer<Findings>,
    /// Sorted from one to the other and back.
    pub pairs: [Buffer<[u32; 2]>; 2],
    pub counts: Buffer<u32>,
    pub totals: Buffer<u32>,
    pub ends: Buffer<u32>,
    pub lists: Buffer<u32>,
    pub nodes: Buffer<Node>,
    pub order: Buffer<u32>,
    capacity: u32,
}

/// Runs of so many pairs.
pub(super) fn runs(count: usize) -> usize {
    count.div_ceil(TILE as usize)
}

impl Scratch {
    /// What it takes.
    pub fn bytes(capacity: usize) -> u64 {
        let each = 2 * size_of::<[u32; 2]>() + 3 * size_of::<u32>() + size_of::<Node>();
        (capacity * each + runs(capacity) * DIGITS as usize * size_of::<u32>()) as u64
    }

    pub fn new(device: &Device, capacity: usize) -> Result<Self, DeviceError> {
        let words = |count: usize| device.zeroed::<u32>(count);
        Ok(Self {
            findings: device.zeroed(1)?,
            pairs: [device.zeroed(capacity)?, device.zeroed(capacity)?],
            counts: words(runs(capacity) * DIGITS as usize)?,
            totals: words(DIGITS as usize)?,
            ends: words(capacity)?,
            lists: words(capacity)?,
            nodes: device.zeroed(capacity)?,
            order: words(capacity)?,
            capacity: capacity as u32,
        })
    }

    pub fn capacity(&self) -> u32 {
        self.capacity
    }

    /// For the next build.
    pub fn clear(&mut self) -> Result<(), DeviceError> {
        self.findings.clear()?;
        self.ends.clear()
    }

    /// What a build found out, and the root; waits for it.
    pub fn outcome(&self) -> Result<(Findings, Node), DeviceError> {
        let (found, root) = (self.findings.read(0, 1)?, self.nodes.read(0, 1)?);
        Ok((found[0], root[0]))
    }
}
