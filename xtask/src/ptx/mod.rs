//! `cargo xtask ptx`: writes the committed PTX and the table of what it needs, or checks them.
//!
//! The steps in order: [`toolchain`] finds or installs a compiler for the GPU, [`compile`] runs it, [`module`] takes its
//! output apart into one self-contained and machine-independent module a kernel, [`bounds`] adds the launch bounds,
//! [`assembler`] sees that every GPU accepts it, [`report`] is the table.

mod assembler;
mod bounds;
mod check;
mod compile;
mod module;
mod report;
mod source;
mod toolchain;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{bail, Context, Result};

use crate::process;
use assembler::Assembler;
use toolchain::{Kind, Toolchain};

/// Kernels that are compiled and committed together.
struct List {
    /// Folder of the crate of entry points.
    crate_folder: &'static str,
    /// What that crate's PTX is called.
    output: &'static str,
    /// Where a host crate includes the modules from.
    modules: &'static str,
    /// The table of registers, stack and spills.
    report: &'static str,
    /// Its heading.
    title: &'static str,
    /// Every entry point.
    names: &'static [&'static str],
    /// Where they are listed.
    source: &'static str,
}

const LISTS: [List; 2] = [
    List {
        crate_folder: "crates/raywarp-ptx",
        output: "raywarp_ptx.ptx",
        modules: "crates/raywarp-device/src/cuda/ptx",
        report: "docs/kernels.md",
        title: "What the kernels need",
        names: raywarp_core::kernels::NAMES,
        source: "crates/raywarp-core/src/kernels.rs",
    },
    List {
        crate_folder: "lab/raywarp-lab-ptx",
        output: "raywarp_lab_ptx.ptx",
        modules: "lab/raywarp-lab/src/ptx",
        report: "lab/docs/kernels.md",
        title: "What the kernels of the laboratory need",
        names: raywarp_lab_core::kernels::NAMES,
        source: "lab/raywarp-lab-core/src/kernels.rs",
    },
];

/// Compile the kernels to PTX and write the committed files.
#[derive(clap::Args)]
pub struct Arguments {
    /// Write nothing: compare with the committed files, and fail if they differ.
    #[arg(long)]
    check: bool,
    /// With --check: assemble for the oldest, the usual and the newest GPU alone, and leave the table of registers out.
    #[arg(long, requires = "check")]
    few: bool,
    /// Fetch what is missing of the tool chain: packages by apt-get or rustup, ptxas by pip.
    #[arg(long)]
    install: bool,
    /// Which compiler to use. [default: Debian's if it is there, else rustup's nightly]
    #[arg(long)]
    toolchain: Option<Kind>,
}

/// Folders that the steps share, and the kernels that they are about.
pub struct Places {
    root: PathBuf,
    /// Everything that is fetched or built on the way; below `target`, so that `cargo clean` removes it.
    work: PathBuf,
    list: &'static List,
}

impl Places {
    fn of(list: &'static List) -> Self {
        let root = process::root();
        Self { work: root.join("target/ptx"), root, list }
    }

    fn committed_modules(&self) -> PathBuf {
        self.root.join(self.list.modules)
    }

    fn fresh_modules(&self) -> PathBuf {
        self.work.join("modules").join(self.list.output)
    }

    fn report(&self) -> PathBuf {
        self.root.join(self.list.report)
    }
}

/// One kernel's module as text.
pub struct Kernel {
    name: String,
    text: String,
}

/// Does what the command line asks.
pub fn run(arguments: &Arguments) -> Result<()> {
    let work = process::root().join("target/ptx");
    let toolchain = Toolchain::find(&work, arguments.toolchain, arguments.install)?;
    let assembler = Assembler::find(&work, arguments.install)?;
    println!("compiling with {}, assembling with ptxas {}", toolchain.versions, assembler.version);
    for places in LISTS.iter().map(Places::of) {
        let kernels = make(&places, &toolchain)?;
        if arguments.check {
            check::check(&places, &toolchain, &assembler, &kernels, arguments.few)?;
        } else {
            write(&places, &toolchain, &assembler, &kernels)?;
        }
    }
    Ok(())
}

/// Compiles every kernel, and leaves the modules in a folder of their own too.
fn make(places: &Places, toolchain: &Toolchain) -> Result<Vec<Kernel>> {
    let text = compile::compile(places, toolchain)?;
    let kernels = module::split(&text, &toolchain.versions)?;
    see_that_all_are_there(places.list, &kernels)?;
    save(&places.fresh_modules(), &kernels)?;
    Ok(kernels)
}

fn see_that_all_are_there(list: &List, kernels: &[Kernel]) -> Result<()> {
    let made: Vec<&str> = kernels.iter().map(|kernel| kernel.name.as_str()).collect();
    let missing: Vec<&str> = list.names.iter().copied().filter(|name| !made.contains(name)).collect();
    let extra: Vec<&str> = made.iter().copied().filter(|name| !list.names.contains(name)).collect();
    if !missing.is_empty() || !extra.is_empty() {
        bail!(
            "the PTX is not what is listed: it lacks {missing:?} and has {extra:?} beyond it. Make {} export exactly the \
             list in {}",
            list.crate_folder,
            list.source
        );
    }
    Ok(())
}

fn write(places: &Places, toolchain: &Toolchain, assembler: &Assembler, kernels: &[Kernel]) -> Result<()> {
    save(&places.committed_modules(), kernels)?;
    let table = report::table(places, toolchain, assembler, kernels)?;
    let path = places.report();
    fs::create_dir_all(path.parent().unwrap_or(&places.root))
        .with_context(|| format!("cannot make room for {}", path.display()))?;
    fs::write(&path, table).with_context(|| format!("cannot write {}", path.display()))?;
    let bytes: usize = kernels.iter().map(|kernel| kernel.text.len()).sum();
    let List { modules, report, .. } = places.list;
    println!("wrote {} modules ({} kB) to {modules}, and {report}", kernels.len(), bytes / 1000);
    Ok(())
}

/// Leaves exactly these modules in the folder.
fn save(folder: &Path, kernels: &[Kernel]) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for stale in module_names(folder)? {
        remove_unless(&folder.join(stale + ".ptx"), kernels)?;
    }
    for kernel in kernels {
        let path = folder.join(format!("{}.ptx", kernel.name));
        fs::write(&path, &kernel.text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

fn remove_unless(path: &Path, kernels: &[Kernel]) -> Result<()> {
    let wanted = kernels.iter().any(|kernel| path.file_stem().is_some_and(|stem| stem == kernel.name.as_str()));
    if wanted {
        return Ok(());
    }
    fs::remove_file(path).with_context(|| format!("cannot remove {}", path.display()))
}

/// Names of the modules in a folder, sorted.
fn module_names(folder: &Path) -> Result<Vec<String>> {
    let entries = fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let mut names = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("cannot list {}", folder.display()))?.path();
        if path.extension().is_some_and(|extension| extension == "ptx") {
            names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        }
    }
    names.sort();
    Ok(names)
}
