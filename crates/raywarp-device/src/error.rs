//! What can go wrong with a device, as sentences that state facts: what to do about them depends on who is told.

/// Why a device cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A shape that no kernel is compiled for.
    #[error("blocks of {}x{} threads cannot be launched: a block has 1 to {most} threads, on a GPU a multiple of 32", block[0], block[1])]
    Block {
        /// Columns and rows.
        block: [u32; 2],
        /// Most threads.
        most: u32,
    },

    /// No `libcuda` on this machine.
    #[error("there is no CUDA driver on this machine (libcuda was not found)")]
    NoDriver,
    /// The driver is there and does not start.
    #[error("the CUDA driver does not start: {reason}")]
    Driver {
        /// The driver's words.
        reason: String,
    },
    /// The driver is there and has no device.
    #[error("the CUDA driver finds no GPU")]
    NoDevice,
    /// There are devices, but not this one.
    #[error("there is no CUDA device {index}: this machine has {count}, counted from 0")]
    NoSuchDevice {
        /// The index asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// The GPU is older than the kernels.
    #[error("{device} has compute capability {}.{}, and raywarp's kernels need 7.5 (Turing, 2018) or newer", has.0, has.1)]
    TooOld {
        /// The device.
        device: String,
        /// Its compute capability.
        has: (u32, u32),
    },
    /// The driver refuses the kernels.
    #[error("the driver of {device} cannot load the kernel {kernel}, which is PTX {isa}: {reason}")]
    Ptx {
        /// The device.
        device: String,
        /// The entry point.
        kernel: String,
        /// The driver's words.
        reason: String,
        /// Version of the PTX instruction set that the kernels are written in.
        isa: String,
    },
    /// The scene or the picture does not fit.
    #[error("{device} has not enough memory for {purpose}: {} needed, {} free", gib(*needed), gib(*available))]
    Memory {
        /// The device.
        device: String,
        /// What the memory is for.
        purpose: String,
        /// Bytes.
        needed: u64,
        /// Bytes.
        available: u64,
    },
    /// An array with more items than a 32-bit index counts.
    #[error("{len} items in one array are more than the {} that raywarp can index", u32::MAX)]
    TooMany {
        /// How many.
        len: usize,
    },
    /// Items to be read or written beyond the end of a buffer.
    #[error("{items} items cannot be read or written from item {first} on: the buffer holds {len}")]
    Range {
        /// Index of the first.
        first: usize,
        /// How many there are to read or write.
        items: usize,
        /// How many the buffer holds.
        len: u32,
    },
    /// A buffer or a stream that the device cannot use.
    #[error("the {what} belong to another device than {device}")]
    OtherDevice {
        /// The device.
        device: String,
        /// What belongs to another: "rays".
        what: &'static str,
    },
    /// The device failed at work.
    #[error("{device} failed while it {action}: {reason}")]
    Failed {
        /// The device.
        device: String,
        /// What it did, as a verb: "ran the kernel x".
        action: String,
        /// The driver's words.
        reason: String,
    },
}

/// Bytes for people.
fn gib(bytes: u64) -> String {
    let mib = bytes as f64 / (1 << 20) as f64;
    if mib < 1024.0 {
        format!("{mib:.1} MiB")
    } else {
        format!("{:.1} GiB", mib / 1024.0)
    }
}
