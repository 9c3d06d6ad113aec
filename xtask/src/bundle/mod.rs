//! `cargo xtask bundle`: one folder to copy to a machine that has a GPU and no Rust.

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{bail, Context, Result};
use serde_json::Value;

use crate::process;

/// Programs of a bundle: package and name.
const PROGRAMS: [[&str; 2]; 2] = [["raywarp-cli", "raywarp"], ["raywarp-lab", "raywarp-lab"]];

/// Integration tests of which some run on CUDA when asked to: package and name.
const GPU_TESTS: [[&str; 2]; 3] =
    [["raywarp", "integration"], ["raywarp-viewer", "integration"], ["raywarp-lab", "structures"]];

/// Folders of scenes, and where the tests look for them in a bundle.
const SCENES: [[&str; 2]; 2] = [["scenes", "scenes"], ["crates/raywarp-scene/built-in", "scenes/built-in"]];

/// Most bytes that are still easily copied.
const LIMIT: u64 = 150_000_000;

/// Put the programs, their GPU tests and the scenes into one folder.
#[derive(clap::Args)]
pub struct Arguments {
    /// Where to; what a bundle puts there is replaced.
    #[arg(default_value = "bundle")]
    folder: PathBuf,
}

/// Does what the command line asks.
pub fn run(arguments: &Arguments) -> Result<()> {
    let (root, folder) = (process::root(), &arguments.folder);
    let tests = folder.join("tests");
    fs::create_dir_all(&tests).with_context(|| format!("cannot make {}", folder.display()))?;
    for [package, name] in PROGRAMS {
        copy_program(&executable(&root, &["build", "--package", package], name)?, &folder.join(name))?;
    }
    for [package, name] in GPU_TESTS {
        copy_program(&test(&root, package, name)?, &tests.join(format!("{package}-{name}")))?;
    }
    for [from, to] in SCENES {
        copy_committed(&root.join(from), &folder.join(to))?;
    }
    write_script(&folder.join("run-gpu-tests.sh"))?;
    write(&folder.join("README.md"), include_str!("README.md"))?;
    tell_size(folder)
}

fn test(root: &Path, package: &str, name: &str) -> Result<PathBuf> {
    executable(root, &["test", "--no-run", "--package", package, "--test", name], name)
}

/// Builds, and asks cargo where it put the program.
fn executable(root: &Path, words: &[&str], name: &str) -> Result<PathBuf> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(words).args(["--release", "--message-format", "json-render-diagnostics"]).current_dir(root);
    // `raywarp bench` tells it with its rows.
    let commit = process::stdout(Command::new("git").args(["describe", "--always", "--dirty"]).current_dir(root))?;
    command.env("RAYWARP_COMMIT", commit.trim());
    let messages = process::stdout(&mut command)?;
    let found = messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok()).find_map(|message| {
        let path = message["executable"].as_str().filter(|_| message["target"]["name"] == name)?;
        Some(PathBuf::from(path))
    });
    found.with_context(|| format!("{} built no program '{name}'", process::words(&command)))
}

/// Copies a program without its debug information, which is most of its size.
fn copy_program(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).with_context(|| format!("cannot copy {} to {}", from.display(), to.display()))?;
    process::run(Command::new("strip").arg(to)).context("strip is part of the binutils that every linker comes with")
}

/// Copies what is committed of a folder.
fn copy_committed(from: &Path, folder: &Path) -> Result<()> {
    let files = process::stdout(Command::new("git").args(["ls-files", "-z"]).current_dir(from))?;
    for file in files.split('\0').filter(|file| !file.is_empty()) {
        let to = folder.join(file);
        fs::create_dir_all(to.parent().unwrap_or(folder)).with_context(|| format!("cannot make {}", to.display()))?;
        fs::copy(from.join(file), &to).with_context(|| format!("cannot copy {file} to {}", to.display()))?;
    }
    Ok(())
}

fn write_script(path: &Path) -> Result<()> {
    write(path, include_str!("run-gpu-tests.sh"))?;
    let executable = fs::Permissions::from_mode(0o755);
    fs::set_permissions(path, executable).with_context(|| format!("cannot make {} executable", path.display()))
}

fn write(path: &Path, text: &str) -> Result<()> {
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

fn tell_size(folder: &Path) -> Result<()> {
    let bytes = size(folder)?;
    println!("{}: {:.1} MB", folder.display(), bytes as f64 / 1e6);
    if bytes > LIMIT {
        bail!("the bundle should stay below {} MB: see what grew with `du -a {}`", LIMIT / 1_000_000, folder.display());
    }
    Ok(())
}

fn size(folder: &Path) -> Result<u64> {
    let mut sum = 0;
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))? {
        let path = entry.with_context(|| format!("cannot list {}", folder.display()))?.path();
        let about = fs::metadata(&path).with_context(|| format!("cannot read {}", path.display()))?;
        sum += if about.is_dir() { size(&path)? } else { about.len() };
    }
    Ok(sum)
}
