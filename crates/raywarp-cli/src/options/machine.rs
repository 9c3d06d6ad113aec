//! Options of the device, and of the structure that rays go through.

use clap::Args;
use raywarp::accel::Build;
use raywarp::device::{Device, DeviceChoice};
use raywarp::scene::Scene;

use super::StructureSettings;
use crate::values;

/// Words for devices; `cuda:N` has too many to list.
pub const DEVICES: [&str; 3] = ["auto", "cpu", "cuda"];

/// Where to trace, and through what: options of every command that traces a scene.
#[derive(Debug, Args)]
pub struct MachineOptions {
    /// Where to trace: auto (a GPU if there is one), cpu, cuda, cuda:N
    #[arg(long, value_name = "DEVICE", default_value_t, help_heading = "Machine")]
    #[arg(value_parser = values::words::<DeviceChoice>(DEVICES), hide_possible_values = true)]
    pub device: DeviceChoice,
    #[command(flatten)]
    pub structure: StructureSettings,
    /// Build the tree anew instead of looking for it in the user's cache, or in the folder of RAYWARP_CACHE
    #[arg(long, help_heading = "Machine")]
    pub no_cache: bool,
    /// Threads of the CPU; none: all
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1, 4096), help_heading = "Machine")]
    pub threads: Option<u32>,
}

impl MachineOptions {
    /// What to build of a scene on a device.
    pub fn build(&self, scene: &Scene, device: &Device) -> Build {
        Build::wished(&self.structure.values.or(&scene.render), device, !self.no_cache)
    }
}
