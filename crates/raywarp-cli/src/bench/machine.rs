//! What was measured on, and with what.

use raywarp::device::{survey, Device, DeviceInfo, Survey};
use serde::Serialize;

/// A device and the program.
#[derive(Debug, Serialize)]
pub struct Machine {
    /// Its name, for people.
    pub device: String,
    /// CUDA version of the driver and highest clock of the device; null on the CPU.
    cuda: Option<(u32, u32)>,
    clock_mhz: Option<u32>,
    /// Of the program.
    pub version: &'static str,
    /// Of the sources that the program was built from, where the build said.
    pub commit: Option<&'static str>,
}

impl Machine {
    /// For the head of a table.
    pub fn sentence(&self) -> String {
        let commit = self.commit.map_or(String::new(), |commit| format!(" ({commit})"));
        format!("{}; raywarp {}{commit}", self.device, self.version)
    }

    pub fn of(device: &Device) -> Self {
        let survey = survey();
        let gpu = among(&survey, device);
        Self {
            device: device.description(),
            cuda: gpu.and_then(|_| survey.driver.as_ref().ok().map(|driver| driver.version)),
            clock_mhz: gpu.map(|gpu| gpu.clock_mhz),
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("RAYWARP_COMMIT"),
        }
    }
}

/// What the driver says of a CUDA device.
pub fn among<'a>(survey: &'a Survey, device: &Device) -> Option<&'a DeviceInfo> {
    survey.devices.iter().find(|gpu| Some(gpu.index) == device.cuda_index())
}
