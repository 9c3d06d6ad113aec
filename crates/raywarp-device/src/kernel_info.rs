//! What a kernel takes of a CUDA device, as its driver tells.

/// Registers, memory and residency of one kernel on one device.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct KernelInfo {
    /// Name of the entry point.
    pub name: &'static str,
    /// Registers a thread.
    pub registers: u32,
    /// Bytes of local memory a thread: stacks, and registers that did not fit.
    pub local_bytes: u32,
    /// Bytes of shared memory a block, without what a launch adds.
    pub shared_bytes: u32,
    /// Threads of a block, as launched.
    pub block_threads: u32,
    /// Threads that fit on a multiprocessor at once over the most that it can hold, 0 to 1: what registers and shared
    /// memory leave, whatever a run then makes of it.
    pub occupancy: f64,
}
