//! Takes the compiler's one large PTX module apart into one small module a kernel.
//!
//! The driver compiles a module as a whole when it is loaded, so a kernel's module holds the kernel and what it reaches,
//! no more. The text depends on the source and the tool chain alone: the compiler's names carry hashes of where the
//! source lies, and its labels count through all kernels, so both get new names. A kernel that did not change keeps its
//! text whatever else did.

use std::collections::HashMap;

use anyhow::{bail, Result};

use super::source::{identifiers, parse, pieces, Item, Kind, Source};
use super::{bounds, Kernel};

/// New names of a module's functions and data.
type Names<'a> = HashMap<&'a str, String>;

/// Splits a module into one for each of its kernels, sorted by name.
pub fn split(text: &str, versions: &str) -> Result<Vec<Kernel>> {
    let source = parse(text)?;
    let entries = source.items.iter().filter(|item| item.kind == Kind::Entry);
    let mut kernels = entries.map(|entry| module(entry, &source, versions)).collect::<Result<Vec<_>>>()?;
    kernels.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(kernels)
}

/// The tool chain that a module's second line names.
pub fn versions(module: &str) -> Option<&str> {
    module.lines().nth(1)?.strip_prefix("// Made with ")
}

fn module(entry: &Item, source: &Source, versions: &str) -> Result<Kernel> {
    let symbols = source.items.iter().map(|item| (item.symbol.as_str(), item)).collect();
    let mut reached = Vec::new();
    reach(entry, &symbols, &mut Vec::new(), &mut reached)?;
    reached.sort_by_key(|item| item.kind != Kind::Data);
    let names = names(&reached);
    let name = entry.symbol.clone();
    let title = format!("// Kernel {name} of raywarp, written by `cargo xtask ptx`\n// Made with {versions}\n");
    let items: String = reached.iter().map(|item| definition(item, &names)).collect();
    Ok(Kernel { name, text: title + &source.head + &items })
}

/// Lists what an item needs and then itself: PTX wants names defined before they are used.
fn reach<'a>(
    item: &'a Item,
    symbols: &HashMap<&str, &'a Item>,
    open: &mut Vec<&'a str>,
    reached: &mut Vec<&'a Item>,
) -> Result<()> {
    if open.contains(&item.symbol.as_str()) && item.kind != Kind::Data {
        bail!("{} calls itself, which a kernel's stack cannot hold: write it as a loop", readable(&item.symbol));
    }
    if reached.iter().any(|known| known.symbol == item.symbol) {
        return Ok(());
    }
    open.push(&item.symbol);
    for needed in identifiers(&item.text).filter_map(|name| symbols.get(name)) {
        if needed.symbol != item.symbol {
            reach(needed, symbols, open, reached)?;
        }
    }
    open.pop();
    reached.push(item);
    Ok(())
}

fn names<'a>(items: &[&'a Item]) -> Names<'a> {
    let mut names: Names = HashMap::new();
    for (number, item) in items.iter().enumerate() {
        let mut name = match item.kind {
            Kind::Data => format!("data{number}"),
            Kind::Entry | Kind::Function => readable(&item.symbol),
        };
        while names.values().any(|taken| *taken == name) {
            name += "_";
        }
        names.insert(&item.symbol, name);
    }
    names
}

/// A name without the hashes: `<raywarp_core::surface::Scene>::surface` becomes `raywarp_core_surface_Scene_surface`.
fn readable(symbol: &str) -> String {
    let path = format!("{:#}", rustc_demangle::demangle(symbol));
    let words = path.split(|character: char| !character.is_ascii_alphanumeric() && character != '_');
    words.filter(|word| !word.is_empty()).collect::<Vec<_>>().join("_")
}

/// An item's text with its new names, and its launch bounds if it is a kernel.
fn definition(item: &Item, names: &Names) -> String {
    let parameter = format!("{}_param_", item.symbol);
    let mut labels = HashMap::new();
    let mut text = String::with_capacity(item.text.len());
    for (piece, is_name) in pieces(&item.text) {
        if let Some(name) = names.get(piece).filter(|_| is_name) {
            text += name;
        } else if let Some(number) = piece.strip_prefix(&parameter) {
            text += &format!("arg{number}");
        } else if piece.starts_with("$L") {
            let number = labels.len();
            text += &format!("$L{}", labels.entry(piece).or_insert(number));
        } else if piece.starts_with("__local_depot") {
            text += "depot";
        } else {
            text += piece;
        }
    }
    match item.kind {
        Kind::Entry => text.replacen("\n{\n", &format!("\n{}{{\n", bounds::directives(&item.symbol)), 1),
        Kind::Function | Kind::Data => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(hash: &str, number: u32) -> String {
        let function = format!("_RNvCs{hash}_5crate8function");
        format!(
            ".version 6.3\n.global .b8 anon_{hash}[1] = {{1}};\n.func unused()\n{{\n\tret;\n}}\n\
             .visible .entry kernel(\n\t.param .b64 kernel_param_0\n)\n{{\n\t.local .b8 \t__local_depot{number}[8];\n\
             \tcall.uni {function}, (a);\n$L__BB{number}_2:\n\tbra \t$L__BB{number}_2;\n}}\n\
             .func {function}(\n\t.param .b64 {function}_param_0\n)\n{{\n\tld.b8 \t%r1, [anon_{hash}+1];\n}}\n"
        )
    }

    #[test]
    fn text_does_not_depend_on_hashes_or_neighbours() {
        let [one, other] = [("1a2b", 0), ("3c4d5", 17)]
            .map(|(hash, number)| split(&source(hash, number), "v").unwrap().remove(0).text);
        assert_eq!(one, other);
        assert_eq!(versions(&one), Some("v"));
        assert_eq!(
            one.lines().skip(2).collect::<Vec<_>>().join("\n"),
            ".version 6.3\n.global .b8 data0[1] = {1};\n.func crate_function(\n.param .b64 arg0\n)\n{\n\
             ld.b8 %r1, [data0+1];\n}\n.visible .entry kernel(\n.param .b64 arg0\n)\n.maxntid 128, 1, 1\n{\n\
             .local .b8 depot[8];\ncall.uni crate_function, (a);\n$L0:\nbra $L0;\n}"
        );
    }

    #[test]
    fn recursion_is_an_error() {
        let text = ".visible .entry k()\n{\ncall f;\n}\n.func f()\n{\ncall g;\n}\n.func g()\n{\ncall f;\n}\n";
        assert!(split(text, "v").is_err_and(|error| error.to_string().contains("calls itself")));
    }
}
