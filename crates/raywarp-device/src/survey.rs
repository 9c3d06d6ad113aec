//! What there is to run on, for `raywarp doctor`.

use super::{cuda, DeviceError};

/// The driver, its devices and the kernels.
#[derive(Debug)]
pub struct Survey {
    /// The CUDA driver, or why there is none.
    pub driver: Result<DriverInfo, DeviceError>,
    /// Every device that the driver shows.
    pub devices: Vec<DeviceInfo>,
    /// The kernels in this program.
    pub ptx: PtxInfo,
}

/// A CUDA driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriverInfo {
    /// Version of its CUDA interface: (13, 0) for CUDA 13.0.
    pub version: (u32, u32),
}

/// A CUDA device.
#[derive(Debug)]
pub struct DeviceInfo {
    /// N of `cuda:N`.
    pub index: usize,
    /// The product's name.
    pub name: String,
    /// (9, 0) for Hopper.
    pub compute_capability: (u32, u32),
    /// Bytes.
    pub memory_total: u64,
    /// Bytes.
    pub memory_free: u64,
    /// Streaming multiprocessors.
    pub multiprocessors: u32,
    /// Highest clock of the multiprocessors, in MHz.
    pub clock_mhz: u32,
    /// Whether the kernels load.
    pub ptx: Result<(), DeviceError>,
}

impl DeviceInfo {
    /// One that the driver shows and that does not answer.
    fn broken(index: usize, error: DeviceError) -> Self {
        Self {
            index,
            name: "a device that does not answer".to_owned(),
            compute_capability: (0, 0),
            memory_total: 0,
            memory_free: 0,
            multiprocessors: 0,
            clock_mhz: 0,
            ptx: Err(error),
        }
    }
}

/// Where the kernels come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PtxInfo {
    /// Lowest architecture that can run them.
    pub target: String,
    /// Version of the PTX instruction set, which the driver must know.
    pub isa: String,
    /// The compiler that made them.
    pub producer: String,
}

/// Asks the driver for everything; nothing that is missing is an error here.
pub fn survey() -> Survey {
    let driver = cuda::driver_version().map(|version| DriverInfo { version });
    let count = if driver.is_ok() { cuda::device_count().unwrap_or(0) } else { 0 };
    let devices =
        (0..count).map(|index| cuda::device_info(index).unwrap_or_else(|e| DeviceInfo::broken(index, e))).collect();
    Survey { driver, devices, ptx: cuda::ptx_info() }
}
