//! The machine and the program.

use raywarp::device::{survey, Device, DeviceInfo};

use crate::study::findings::About;
use raywarp_cli::bench::among;

/// What the report's head says.
pub fn about(device: &Device, quick: bool) -> About {
    let survey = survey();
    let gpu = among(&survey, device);
    let driver = gpu.and_then(|_| survey.driver.as_ref().ok()).map(|driver| {
        let (major, minor) = driver.version;
        match kernel_module() {
            Some(version) => format!("CUDA {major}.{minor}, {version}"),
            None => format!("CUDA {major}.{minor}"),
        }
    });
    About {
        device: device.description(),
        driver,
        clock_mhz: gpu.map(|gpu| gpu.clock_mhz),
        multiprocessors: gpu.map(|gpu| gpu.multiprocessors),
        peak_flops: gpu.map(peak),
        cpu_threads: rayon::current_num_threads(),
        version: env!("CARGO_PKG_VERSION"),
        commit: option_env!("RAYWARP_COMMIT"),
        command: command(),
        quick,
    }
}

/// Without the folder that the program is in.
fn command() -> String {
    let rest = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    std::iter::once("raywarp-lab".to_owned()).chain(rest).collect::<Vec<_>>().join(" ")
}

/// The driver's own version, where Linux tells.
fn kernel_module() -> Option<String> {
    let text = std::fs::read_to_string("/proc/driver/nvidia/version").ok()?;
    let numbers = |word: &&str| word.contains('.') && word.chars().all(|c| c.is_ascii_digit() || c == '.');
    text.lines().next()?.split_whitespace().find(numbers).map(str::to_owned)
}

/// Units for single precision of a multiprocessor (CUDA C++ Programming Guide, throughput of native arithmetic), each of
/// which does a fused multiply-add, two operations, a clock.
fn peak(gpu: &DeviceInfo) -> f64 {
    let units = match gpu.compute_capability {
        (7, _) | (8, 0) => 64.0,
        _ => 128.0,
    };
    2.0 * units * f64::from(gpu.multiprocessors) * f64::from(gpu.clock_mhz) * 1e6
}
