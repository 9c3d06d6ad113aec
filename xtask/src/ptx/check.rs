//! `cargo xtask ptx --check`: whether the committed files are what the sources give.

use std::fs;

use anyhow::{bail, Context, Result};

use super::assembler::{Assembler, FEW, GPUS};
use super::toolchain::Toolchain;
use super::{module, module_names, report, Kernel, Places};

/// Compares the kernels just made with the committed ones, and sees that the assembler takes them.
///
/// Another tool chain gives another text for the same source, so then only the second is checked, of both.
pub fn check(places: &Places, toolchain: &Toolchain, assembler: &Assembler, fresh: &[Kernel], few: bool) -> Result<()> {
    let committed = read(places)?;
    let versions = committed.first().and_then(|kernel| module::versions(&kernel.text)).unwrap_or("nothing");
    if versions == toolchain.versions {
        compare(&committed, fresh)?;
        if few {
            assembler.assemble_all(&places.fresh_modules(), &report::names(fresh), &FEW)?;
        } else {
            compare_report(places, toolchain, assembler, fresh)?;
        }
        println!("the committed PTX in {} is what the sources give, and assembles", places.list.modules);
        return Ok(());
    }
    println!("the committed PTX in {} was made with {versions}: the texts cannot be compared", places.list.modules);
    compare_names(&committed, fresh)?;
    for (folder, kernels) in [(places.committed_modules(), &committed[..]), (places.fresh_modules(), fresh)] {
        let gpus: &[u32] = if few { &FEW } else { &GPUS };
        assembler.assemble_all(&folder, &report::names(kernels), gpus)?;
    }
    println!("the committed PTX assembles, and so does what the sources give here");
    Ok(())
}

fn read(places: &Places) -> Result<Vec<Kernel>> {
    let folder = places.committed_modules();
    let read = |name: String| {
        let path = folder.join(format!("{name}.ptx"));
        let text = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        Ok(Kernel { name, text })
    };
    module_names(&folder)?.into_iter().map(read).collect()
}

fn compare(committed: &[Kernel], fresh: &[Kernel]) -> Result<()> {
    compare_names(committed, fresh)?;
    let differ = committed.iter().zip(fresh).filter(|(old, new)| old.text != new.text);
    let differ: Vec<&str> = differ.map(|(old, _)| old.name.as_str()).collect();
    if !differ.is_empty() {
        bail!(
            "the sources give another PTX for {}: run `cargo xtask ptx` and commit what it writes",
            differ.join(", ")
        );
    }
    Ok(())
}

fn compare_names(committed: &[Kernel], fresh: &[Kernel]) -> Result<()> {
    let (committed, fresh) = (report::names(committed), report::names(fresh));
    let not_in = |these: &[String], those: &[String]| -> Vec<String> {
        these.iter().filter(|name| !those.contains(name)).cloned().collect()
    };
    let (missing, stale) = (not_in(&fresh, &committed), not_in(&committed, &fresh));
    if !missing.is_empty() || !stale.is_empty() {
        bail!("the committed PTX lacks {missing:?} and has {stale:?} too many: run `cargo xtask ptx` and commit what it writes");
    }
    Ok(())
}

/// The table is compared where the same assembler made it; the kernels are assembled in any case.
fn compare_report(places: &Places, toolchain: &Toolchain, assembler: &Assembler, fresh: &[Kernel]) -> Result<()> {
    let path = places.report();
    let committed = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let table = report::table(places, toolchain, assembler, fresh)?;
    if !committed.contains(&report::made_with(toolchain, assembler)) {
        let name = places.list.report;
        println!("{name} was made with another ptxas than {}: its numbers cannot be compared", assembler.version);
    } else if committed != table {
        bail!("{} is not what ptxas says: run `cargo xtask ptx` and commit what it writes", places.list.report);
    }
    Ok(())
}
