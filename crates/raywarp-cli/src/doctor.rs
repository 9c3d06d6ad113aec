//! `raywarp doctor`.

use std::fmt::Write;

use raywarp::device::{survey, Device, DeviceChoice, DeviceError, DeviceInfo, Survey};

use crate::failure::{Failure, Result};
use crate::messages;
use crate::report::Table;

/// Says whether a GPU can be used.
///
/// # Errors
/// Where none can, after saying why; the exit code is that of a device error.
pub fn run() -> Result<()> {
    let survey = survey();
    messages::out(describe(&survey).as_bytes())?;
    match problem(survey) {
        None => Ok(()),
        Some(problem) => Err(problem.into()),
    }
}

fn describe(survey: &Survey) -> String {
    let mut table = Table::default();
    table.row("raywarp", env!("CARGO_PKG_VERSION"));
    let ptx = &survey.ptx;
    table.row("kernels", format!("PTX {} for {} and newer, made by {}", ptx.isa, ptx.target, ptx.producer));
    table.row("CPU", Device::open(DeviceChoice::Cpu).map_or_else(|e| e.to_string(), |cpu| cpu.description()));
    match &survey.driver {
        Ok(driver) => table.row("CUDA driver", format!("for CUDA {}.{}", driver.version.0, driver.version.1)),
        Err(_) => table.row("CUDA driver", "cannot be used"),
    }
    for device in &survey.devices {
        table.row(&format!("cuda:{}", device.index), describe_device(device));
    }
    let mut text = table.0;
    if survey.devices.iter().any(|device| device.ptx.is_ok()) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\nAll is well: `--device auto` takes the GPU.");
    } else {
        let _ = writeln!(text, "\nNo GPU can be used; the CPU works: `--device auto` takes it.");
    }
    text
}

fn describe_device(device: &DeviceInfo) -> String {
    let (major, minor) = device.compute_capability;
    let kernels = match &device.ptx {
        Ok(()) => "the kernels load".to_owned(),
        Err(error) => format!("the kernels do not load: {}", Failure::from(error.clone())),
    };
    format!(
        "{}, compute capability {major}.{minor}, {} multiprocessors, {} of {} free; {kernels}",
        device.name,
        device.multiprocessors,
        messages::bytes(device.memory_free),
        messages::bytes(device.memory_total)
    )
}

/// Why no GPU can be used; none where one can.
fn problem(survey: Survey) -> Option<DeviceError> {
    if let Err(error) = survey.driver {
        return Some(error);
    }
    let mut first = None;
    for device in survey.devices {
        match device.ptx {
            Ok(()) => return None,
            Err(error) => first = first.or(Some(error)),
        }
    }
    Some(first.unwrap_or(DeviceError::NoDevice))
}
