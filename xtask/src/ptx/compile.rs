//! From a crate of entry points to PTX text.

use std::fs;

use anyhow::{Context, Result};

use super::toolchain::Toolchain;
use super::Places;
use crate::process;

/// The oldest GPUs that the PTX runs on.
const TARGET: &str = "sm_75";

/// A panic is a trap, which the host sees as an error; its message would only cost registers, and the location in it
/// would carry a path of this machine into the PTX.
const PANICS: &str = "-Zunstable-options -Cpanic=immediate-abort -Zlocation-detail=none";

/// Compiles all kernels to the text of one module.
pub fn compile(places: &Places, toolchain: &Toolchain) -> Result<String> {
    let target = places.work.join("target");
    let mut cargo = toolchain.cargo()?;
    cargo
        .args(["build", "--release", "--locked", "--target", "nvptx64-nvidia-cuda", "-Zbuild-std=core", "--target-dir"])
        .arg(&target)
        .env("RUSTFLAGS", format!("-Ctarget-cpu={TARGET} {PANICS}"))
        .current_dir(places.root.join(places.list.crate_folder));
    process::run(&mut cargo)?;
    let path = target.join("nvptx64-nvidia-cuda/release").join(places.list.output);
    fs::read_to_string(&path).with_context(|| format!("the build left no {}", path.display()))
}
