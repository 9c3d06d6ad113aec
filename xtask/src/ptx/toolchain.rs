//! The Rust compiler for the GPU: it needs the library's sources, LLVM's tools and `llvm-bitcode-linker`.
//!
//! Two sources of these are known. Debian packages a compiler that has everything but the linker, whose source it
//! ships. Rustup's nightly has all of it as components.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{bail, Context, Result};

use crate::process;

/// Where a compiler comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// The packages rustc-web, cargo-web, rust-web-src and llvm.
    Debian,
    /// Rustup's nightly with rust-src, llvm-tools and llvm-bitcode-linker.
    Nightly,
}

/// A complete tool chain.
pub struct Toolchain {
    cargo: PathBuf,
    rustc: PathBuf,
    /// Folders of LLVM's tools and of the linker.
    tools: Vec<PathBuf>,
    /// Versions that decide what the PTX looks like.
    pub versions: String,
}

const DEBIAN_RUST: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
const NIGHTLY: &str = "rustup toolchain install nightly -c rust-src -c llvm-tools -c llvm-bitcode-linker";

/// Beginnings of the variables by which one cargo would change what another one builds.
const LEFT_OVER: [&str; 7] =
    ["CARGO_BUILD_", "CARGO_ENCODED_", "CARGO_PROFILE_", "CARGO_TARGET_", "RUSTC", "RUSTFLAGS", "LD_LIBRARY_PATH"];

impl Toolchain {
    /// Finds a tool chain, or installs one if it may.
    pub fn find(work: &Path, kind: Option<Kind>, install: bool) -> Result<Self> {
        match kind {
            Some(Kind::Debian) => debian(work, install),
            Some(Kind::Nightly) => nightly(install),
            None => debian(work, false).or_else(|debian_lacks| {
                nightly(false).or_else(|nightly_lacks| match (install, program("apt-get")) {
                    (true, true) => debian(work, true),
                    (true, false) => nightly(true),
                    (false, _) => bail!("no tool chain for PTX is complete.\n{debian_lacks:#}\nOr: {nightly_lacks:#}"),
                })
            }),
        }
    }

    /// Its cargo, cleared of what the cargo that runs this program left in the environment.
    pub fn cargo(&self) -> Result<Command> {
        let mut command = Command::new(&self.cargo);
        for (name, _) in env::vars_os() {
            if LEFT_OVER.iter().any(|start| name.to_string_lossy().starts_with(start)) {
                command.env_remove(&name);
            }
        }
        let path = env::var_os("PATH").unwrap_or_default();
        let path = env::join_paths(self.tools.iter().cloned().chain(env::split_paths(&path)))
            .context("a folder of the tool chain has a name that cannot be in PATH")?;
        // The features that the kernels need are unstable: this lets a stable compiler take them.
        command.env("RUSTC", &self.rustc).env("RUSTC_BOOTSTRAP", "1").env("PATH", path);
        Ok(command)
    }
}

fn debian(work: &Path, install: bool) -> Result<Toolchain> {
    let (cargo, rustc) = (PathBuf::from("/usr/bin/cargo"), PathBuf::from("/usr/bin/rustc"));
    let sources = Path::new("/usr/lib/rustlib/src/rust");
    if !cargo.exists() || !rustc.exists() || !sources.join("library/core").exists() {
        apt_get(&DEBIAN_RUST, install)?;
    }
    let version = Version::of(&rustc)?;
    let llvm = PathBuf::from(format!("/usr/lib/llvm-{}/bin", version.llvm_major()));
    if !llvm.join("llc").exists() {
        apt_get(&[&format!("llvm-{}", version.llvm_major())], install)?;
    }
    let linker = work.join("linker");
    let versions = version.to_string();
    let mut toolchain = Toolchain { cargo, rustc, tools: vec![llvm], versions };
    if !linker.join("target/release/llvm-bitcode-linker").exists() {
        build_linker(&toolchain, &sources.join("src/tools/llvm-bitcode-linker"), &linker, install)?;
    }
    toolchain.tools.push(linker.join("target/release"));
    Ok(toolchain)
}

fn apt_get(packages: &[&str], install: bool) -> Result<()> {
    if !install {
        bail!(
            "Debian's packages are missing: run `cargo xtask ptx --install`, or `apt-get install {}`",
            packages.join(" ")
        );
    }
    process::run(Command::new("apt-get").args(["update", "-q"]))?;
    let mut command = Command::new("apt-get");
    command.env("DEBIAN_FRONTEND", "noninteractive").args(["install", "-y", "-q", "--no-install-recommends"]);
    process::run(command.args(packages))
}

/// Debian ships the linker's source as a part of the compiler's workspace: a copy of it builds alone.
fn build_linker(toolchain: &Toolchain, source: &Path, copy: &Path, install: bool) -> Result<()> {
    if !install {
        bail!("llvm-bitcode-linker is not built yet: run `cargo xtask ptx --install`");
    }
    println!("building llvm-bitcode-linker");
    fs::create_dir_all(copy).with_context(|| format!("cannot make {}", copy.display()))?;
    process::run(Command::new("cp").arg("-r").arg(source.join("src")).arg(copy))?;
    let manifest = source.join("Cargo.toml");
    let text = fs::read_to_string(&manifest).with_context(|| format!("cannot read {}", manifest.display()))?;
    let alone: String =
        text.lines().filter(|line| !line.contains("workspace")).map(|line| format!("{line}\n")).collect();
    fs::write(copy.join("Cargo.toml"), alone + "\n[workspace]\n").context("cannot write the linker's Cargo.toml")?;
    process::run(toolchain.cargo()?.args(["build", "--release", "--quiet"]).current_dir(copy))
}

fn nightly(install: bool) -> Result<Toolchain> {
    find_nightly().or_else(|lacks| {
        if !install {
            return Err(lacks);
        }
        let mut words = NIGHTLY.split(' ');
        process::run(Command::new(words.next().unwrap_or_default()).args(words))?;
        find_nightly()
    })
}

fn find_nightly() -> Result<Toolchain> {
    let which = |tool| process::both(Command::new("rustup").args(["which", "--toolchain", "nightly", tool]));
    let lacks = || format!("rustup's nightly is missing or lacks components: run `{NIGHTLY}`");
    let rustc = PathBuf::from(which("rustc").with_context(lacks)?.trim());
    let cargo = PathBuf::from(which("cargo").with_context(lacks)?.trim());
    let version = Version::of(&rustc)?;
    let sysroot = process::stdout(Command::new(&rustc).args(["--print", "sysroot"]))?;
    let rustlib = Path::new(sysroot.trim()).join("lib/rustlib");
    let tools = rustlib.join(&version.host).join("bin");
    let needed =
        [rustlib.join("src/rust/library/core"), tools.join("llc"), tools.join("self-contained/llvm-bitcode-linker")];
    if let Some(missing) = needed.iter().find(|path| !path.exists()) {
        return Err(anyhow::anyhow!("{} is not there", missing.display()).context(lacks()));
    }
    Ok(Toolchain { cargo, rustc, tools: vec![tools.join("self-contained"), tools], versions: version.to_string() })
}

fn program(name: &str) -> bool {
    env::split_paths(&env::var_os("PATH").unwrap_or_default()).any(|folder| folder.join(name).is_file())
}

/// What `rustc -vV` says.
struct Version {
    release: String,
    commit: String,
    llvm: String,
    host: String,
}

impl Version {
    fn of(rustc: &Path) -> Result<Self> {
        let text = process::stdout(Command::new(rustc).arg("-vV").env_remove("LD_LIBRARY_PATH"))?;
        let field = |name: &str| {
            let found = text.lines().find_map(|line| line.strip_prefix(name));
            found.map(str::to_owned).with_context(|| format!("`{} -vV` does not say its '{name}'", rustc.display()))
        };
        Ok(Self {
            release: field("release: ")?,
            commit: field("commit-hash: ")?.chars().take(9).collect(),
            llvm: field("LLVM version: ")?,
            host: field("host: ")?,
        })
    }

    fn llvm_major(&self) -> &str {
        self.llvm.split('.').next().unwrap_or(&self.llvm)
    }
}

impl std::fmt::Display for Version {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(out, "rustc {} ({}), LLVM {}", self.release, self.commit, self.llvm)
    }
}
