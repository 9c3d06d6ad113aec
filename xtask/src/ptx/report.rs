//! A page of numbers: what each kernel needs on each GPU.

use anyhow::Result;

use super::assembler::{Assembler, Usage, GPUS};
use super::toolchain::Toolchain;
use super::{Kernel, Places};

/// Assembles the modules just made and tells what they need.
pub fn table(places: &Places, toolchain: &Toolchain, assembler: &Assembler, kernels: &[Kernel]) -> Result<String> {
    let usages = assembler.assemble_all(&places.fresh_modules(), &names(kernels), &GPUS)?;
    let rows: Vec<(&str, &[Usage])> =
        kernels.iter().zip(&usages).map(|(kernel, usages)| (kernel.name.as_str(), usages.as_slice())).collect();
    let sizes: Vec<String> =
        kernels.iter().map(|kernel| format!("| `{}` | {} |\n", kernel.name, kernel.text.len())).collect();
    let spilling: Vec<_> =
        rows.iter().copied().filter(|(_, usages)| usages.iter().any(|usage| usage.spills > 0)).collect();
    let spills = match spilling[..] {
        [] => "No kernel spills a register on any of these.\n".to_owned(),
        _ => section(&spilling, |usage| usage.spills),
    };
    Ok(format!(
        "# {}\n\n{}\n\nWritten by `cargo xtask ptx`; a column is a compute capability.\n\n\
         ## Registers a thread\n\n{}\n## Stack a thread, bytes\n\nWith that of called functions.\n\n{}\n\
         ## Spilled registers, bytes stored and loaded\n\n{spills}\n\
         ## Size of the PTX, bytes\n\n| kernel | bytes |\n| --- | ---: |\n{}",
        places.list.title,
        made_with(toolchain, assembler),
        section(&rows, |usage| usage.registers),
        section(&rows, |usage| usage.stack),
        sizes.concat(),
    ))
}

/// The line that says which tools the table speaks of.
pub fn made_with(toolchain: &Toolchain, assembler: &Assembler) -> String {
    format!("Compiled with {}; assembled with ptxas {}.", toolchain.versions, assembler.version)
}

/// The names of kernels, in their order.
pub fn names(kernels: &[Kernel]) -> Vec<String> {
    kernels.iter().map(|kernel| kernel.name.clone()).collect()
}

fn section(rows: &[(&str, &[Usage])], number: impl Fn(&Usage) -> u32) -> String {
    let head: String = GPUS.iter().map(|gpu| format!(" sm_{gpu} |")).collect();
    let rule = " ---: |".repeat(GPUS.len());
    let lines = rows.iter().map(|(name, usages)| {
        let cells: String = usages.iter().map(|usage| format!(" {} |", number(usage))).collect();
        format!("| `{name}` |{cells}\n")
    });
    format!("| kernel |{head}\n| --- |{rule}\n{}", lines.collect::<String>())
}
