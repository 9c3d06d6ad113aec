//! Whether a picture can be held at all, before anything is computed.

use raywarp::device::{Device, DeviceChoice, DeviceError};
use raywarp::image::Format;

use crate::failure::{ensure, fail, Result};
use crate::messages;
use crate::options::RenderOptions;
use crate::output::Plan;

/// Refuses a picture of a size, or the part of it that the options ask for, that is not there or cannot be held.
/// Columns and rows that are rendered.
pub fn check(size: [u32; 2], options: &RenderOptions, plan: &Plan) -> Result<[u32; 2]> {
    let region = region(size, options.crop)?;
    check_memory(region, plan, plan.needs_tests() || options.stats.is_some())?;
    Ok(region)
}

/// Columns and rows that are rendered.
///
/// # Errors
/// Where the crop leaves the picture.
fn region(size: [u32; 2], crop: Option<[u32; 4]>) -> Result<[u32; 2]> {
    let [width, height] = size;
    let Some([x0, y0, x1, y1]) = crop else { return Ok(size) };
    ensure!(
        x1 <= width && y1 <= height,
        "--crop {x0},{y0},{x1},{y1} leaves the picture of {width}x{height} pixels: give columns up to {width} and rows \
         up to {height}"
    );
    Ok([x1 - x0, y1 - y0])
}

/// Refuses a picture that cannot be held in memory, with the numbers.
fn check_memory([width, height]: [u32; 2], plan: &Plan, counted: bool) -> Result<()> {
    let pixels = u64::from(width) * u64::from(height);
    let needed = pixels.saturating_mul(bytes_a_pixel(plan, counted));
    let host = Device::open(DeviceChoice::Cpu)?;
    if let Err(DeviceError::Memory { available, .. }) = host.reserve(needed, "the picture") {
        fail!(
            "a picture of {width}x{height} pixels needs about {} of memory, and {} are free; choose a smaller --size, \
             or render parts of it with --crop",
            messages::bytes(needed),
            messages::bytes(available)
        );
    }
    ensure!(
        u32::try_from(pixels).is_ok(),
        "a picture of {width}x{height} has {pixels} pixels, and raywarp counts up to {}; render parts of it with --crop",
        u32::MAX
    );
    Ok(())
}

/// The film, the picture made of it, and what encoding takes.
fn bytes_a_pixel(plan: &Plan, counted: bool) -> u64 {
    let film = 2 * 16;
    let tests = if counted { 2 * 12 } else { 0 };
    let layers = if plan.layers().is_empty() { 0 } else { 2 * 64 };
    let has = |format: Format| plan.pictures().iter().any(|picture| picture.1 == format);
    let png = if has(Format::Png) { 6 } else { 0 };
    let exr = if has(Format::Exr) { 32 + layers } else { 0 };
    film + tests + layers + png + exr
}
