//! Reads the compiler's PTX into its top-level definitions.

use std::collections::HashSet;

use anyhow::{bail, Result};

/// A module taken apart.
pub struct Source {
    /// The lines that open every module: version, target, address size.
    pub head: String,
    /// What it defines, in the compiler's order.
    pub items: Vec<Item>,
}

/// One definition.
pub struct Item {
    pub kind: Kind,
    /// Its name, as the compiler spells it.
    pub symbol: String,
    /// The definition without comments and needless blanks, each line ended.
    pub text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Entry,
    Function,
    Data,
}

/// Reads a module. Declarations are left out, for definitions can be put in order; one of something that is not
/// defined is an error.
pub fn parse(text: &str) -> Result<Source> {
    let (mut head, mut items, mut declared) = (String::new(), Vec::new(), Vec::new());
    let (mut open, mut depth) = (String::new(), 0);
    for line in text.lines().map(clean).filter(|line| !line.is_empty()) {
        if open.is_empty() && [".version", ".target", ".address_size"].iter().any(|word| line.starts_with(word)) {
            head += &(line + "\n");
            continue;
        }
        depth += line.matches('{').count() as i32 - line.matches('}').count() as i32;
        let ends = depth == 0 && (line == "}" || line.ends_with(';'));
        open += &(line + "\n");
        if ends {
            let item = item(std::mem::take(&mut open))?;
            let declares = item.kind == Kind::Function && !item.text.contains('{');
            if declares { &mut declared } else { &mut items }.push(item);
        }
    }
    if !open.is_empty() {
        bail!("the PTX ends within a definition: {}", open.lines().next().unwrap_or_default());
    }
    see_that_all_are_defined(&declared, &items)?;
    Ok(Source { head, items })
}

fn see_that_all_are_defined(declared: &[Item], items: &[Item]) -> Result<()> {
    let defined: HashSet<&str> = items.iter().map(|item| item.symbol.as_str()).collect();
    if let Some(Item { symbol, .. }) = declared.iter().find(|item| !defined.contains(item.symbol.as_str())) {
        bail!("the kernels call {symbol}, which nothing defines: use what raywarp-core' `math` and `arch` have");
    }
    Ok(())
}

/// A line without its comment, its blanks single.
fn clean(line: &str) -> String {
    let code = line.split("//").next().unwrap_or_default();
    code.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn item(text: String) -> Result<Item> {
    let kind = match () {
        () if text.contains(".entry ") => Kind::Entry,
        () if text.contains(".func ") => Kind::Function,
        () => Kind::Data,
    };
    let symbol = match kind {
        Kind::Data => text.split(['[', '=', ';']).next().and_then(|start| start.split_whitespace().last()),
        Kind::Entry | Kind::Function => identifiers(signature(&text)).next(),
    };
    match symbol.map(str::to_owned) {
        Some(symbol) => Ok(Item { kind, symbol, text }),
        None => bail!("cannot read this definition in the PTX: {}", text.lines().next().unwrap_or_default()),
    }
}

/// The text of a function from its name on: after the keyword and the returned value.
fn signature(text: &str) -> &str {
    let keyword = text.split_once(".entry ").or_else(|| text.split_once(".func "));
    let rest = keyword.map_or(text, |(_, rest)| rest);
    match rest.strip_prefix('(') {
        Some(returned) => returned.split_once(')').map_or(rest, |(_, rest)| rest),
        None => rest,
    }
}

/// The names in a piece of PTX, in order. Registers, directives and the parts of opcodes are not names.
pub fn identifiers(text: &str) -> impl Iterator<Item = &str> {
    pieces(text).filter(|(_, is_name)| *is_name).map(|(piece, _)| piece)
}

/// The text in pieces, each with whether it is a name.
pub fn pieces(mut text: &str) -> impl Iterator<Item = (&str, bool)> {
    let in_name = |character: char| character.is_ascii_alphanumeric() || "_$%.".contains(character);
    std::iter::from_fn(move || {
        let first = text.chars().next()?;
        let end = text.find(|character| in_name(character) != in_name(first)).unwrap_or(text.len());
        let (piece, rest) = text.split_at(end);
        text = rest;
        Some((piece, first.is_ascii_alphabetic() || "_$".contains(first)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "//\n.version 6.3\n.target sm_75\n.func  (.param .b32 r) f\n(\n\t.param .b32 f_param_0\n)\n;\n\
        .global .align 4 .b8 d[2] = {1, 2};\n.visible .entry k(\n)  // @k\n{\n\tcall.uni (r), f, (a); // here\n\
        $L__BB0_1:\n\tret;\n}\n.func (.param .b32 r) f(\n\t.param .b32 f_param_0\n)\n{\n\tret;\n}\n";

    #[test]
    fn definitions_are_found() {
        let source = parse(TEXT).unwrap();
        let found: Vec<_> = source.items.iter().map(|item| (item.kind, item.symbol.as_str())).collect();
        assert_eq!(found, [(Kind::Data, "d"), (Kind::Entry, "k"), (Kind::Function, "f")]);
        assert_eq!(source.head, ".version 6.3\n.target sm_75\n");
        assert!(source.items[1].text.contains("{\ncall.uni (r), f, (a);\n$L__BB0_1:\n"));
    }

    #[test]
    fn a_call_to_nothing_is_an_error() {
        let declared = ".func g\n(\n)\n;\n";
        assert!(parse(declared).is_err_and(|error| error.to_string().contains("call g")));
        assert!(parse(".func f()\n{").is_err());
    }

    #[test]
    fn names_are_told_from_the_rest() {
        let names: Vec<_> = identifiers("@%p1 bra $L__BB0_1; ld.b32 %r1, [d_$_0+24], 0fFF800000;").collect();
        assert_eq!(names, ["bra", "$L__BB0_1", "ld.b32", "d_$_0"]);
    }
}
