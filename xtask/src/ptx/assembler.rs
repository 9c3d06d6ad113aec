//! `ptxas`: whether every GPU takes the PTX, and what a kernel needs there.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::OnceLock;
use std::thread;

use anyhow::{bail, Context, Result};

use crate::process;

/// The GPUs that the PTX is assembled for.
pub const GPUS: [u32; 6] = [75, 80, 86, 89, 90, 100];

/// Of those, enough to notice what the driver would refuse.
pub const FEW: [u32; 3] = [75, 90, 100];

/// The package that brings `ptxas`, in the version that the committed table was made with.
const PACKAGE: &str = "nvidia-cuda-nvcc==13.5.37";

/// NVIDIA's assembler. It needs no GPU.
pub struct Assembler {
    path: PathBuf,
    /// As in "13.5.37".
    pub version: String,
}

/// What a kernel needs on one GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Usage {
    /// Registers a thread.
    pub registers: u32,
    /// Bytes of stack a thread, called functions included.
    pub stack: u32,
    /// Bytes of registers stored to and loaded from the stack for want of room.
    pub spills: u32,
}

impl Assembler {
    /// Finds `ptxas`, or installs it into the work folder if it may.
    pub fn find(work: &Path, install: bool) -> Result<Self> {
        let environment = work.join("python");
        let path = match find_file(&environment, "ptxas").or_else(on_this_machine) {
            Some(path) => path,
            None if install => fetch(&environment)?,
            None => bail!("ptxas is missing: run `cargo xtask ptx --install`, or `pip install {PACKAGE}`"),
        };
        let text = process::stdout(Command::new(&path).arg("--version"))?;
        let version = text.split_whitespace().find_map(|word| word.strip_prefix('V'));
        let version = version.with_context(|| format!("`{} --version` names no version", path.display()))?.to_owned();
        Ok(Self { path, version })
    }

    /// Assembles each module of the folder for each of these GPUs: a row a module, a column a GPU.
    pub fn assemble_all(&self, folder: &Path, modules: &[String], gpus: &[u32]) -> Result<Vec<Vec<Usage>>> {
        let jobs: Vec<_> = modules.iter().flat_map(|module| gpus.iter().map(move |gpu| (module, gpu))).collect();
        let results: Vec<OnceLock<Result<Usage>>> = jobs.iter().map(|_| OnceLock::new()).collect();
        let next = AtomicUsize::new(0);
        let work = || loop {
            let job = next.fetch_add(1, Ordering::Relaxed);
            let (Some((module, gpu)), Some(result)) = (jobs.get(job), results.get(job)) else { return };
            result.get_or_init(|| self.assemble(&folder.join(format!("{module}.ptx")), **gpu));
        };
        thread::scope(|scope| {
            for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
                scope.spawn(work);
            }
        });
        let usages = results.into_iter().map(|result| result.into_inner().context("a module was not assembled")?);
        Ok(usages.collect::<Result<Vec<_>>>()?.chunks(gpus.len()).map(<[Usage]>::to_vec).collect())
    }

    fn assemble(&self, module: &Path, gpu: u32) -> Result<Usage> {
        let mut command = Command::new(&self.path);
        command.arg("-v").arg(format!("-arch=sm_{gpu}")).arg(module).args(["-o", "/dev/null"]);
        parse(&process::both(&mut command)?).with_context(|| format!("{} says no registers", process::words(&command)))
    }
}

/// Reads what `ptxas -v` prints about a module of one kernel and the functions it calls.
fn parse(text: &str) -> Option<Usage> {
    let stack = numbers(text, " bytes cumulative stack").chain(numbers(text, " bytes stack frame"));
    let spills = numbers(text, " bytes spill stores").chain(numbers(text, " bytes spill loads"));
    Some(Usage { registers: numbers(text, " registers").max()?, stack: stack.max().unwrap_or(0), spills: spills.sum() })
}

/// Every number that stands before these words.
fn numbers<'a>(text: &'a str, words: &'a str) -> impl Iterator<Item = u32> + 'a {
    text.match_indices(words).filter_map(|(at, _)| {
        let before = &text[..at];
        let start = before.rfind(|character: char| !character.is_ascii_digit()).map_or(0, |at| at + 1);
        before[start..].parse().ok()
    })
}

fn fetch(environment: &Path) -> Result<PathBuf> {
    println!("fetching ptxas");
    // Debian's own Python makes environments only with one more package.
    if process::both(Command::new("python3").args(["-m", "venv"]).arg(environment)).is_err() {
        process::run(Command::new("apt-get").args(["install", "-y", "-q", "python3-venv"]))?;
        process::run(Command::new("python3").args(["-m", "venv"]).arg(environment))?;
    }
    process::run(Command::new(environment.join("bin/pip")).args(["install", "--quiet", PACKAGE]))?;
    find_file(environment, "ptxas").with_context(|| format!("{PACKAGE} brought no ptxas"))
}

fn on_this_machine() -> Option<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let folders = env::split_paths(&path).chain([PathBuf::from("/usr/local/cuda/bin")]);
    folders.map(|folder| folder.join("ptxas")).find(|file| file.is_file())
}

fn find_file(folder: &Path, name: &str) -> Option<PathBuf> {
    let entries: Vec<PathBuf> = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path()).collect();
    let here = entries.iter().find(|path| path.is_file() && path.file_name().is_some_and(|file| file == name)).cloned();
    here.or_else(|| {
        entries.iter().filter(|path| path.is_dir() && !path.is_symlink()).find_map(|path| find_file(path, name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usage_is_read() {
        let text = "ptxas info    : Compiling entry function 'k' for 'sm_90'\n\
                    ptxas info    : Function properties for k\n    \
                    112 bytes stack frame, 8 bytes spill stores, 4 bytes spill loads\n\
                    ptxas info    : Used 79 registers, used 0 barriers, 240 bytes cumulative stack size\n\
                    ptxas info    : Function properties for f\n    \
                    0 bytes stack frame, 2 bytes spill stores, 0 bytes spill loads\n";
        assert_eq!(parse(text), Some(Usage { registers: 79, stack: 240, spills: 14 }));
        assert_eq!(parse("nothing"), None);
    }
}
