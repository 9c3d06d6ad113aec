//! The PTX of each kernel, a module each: the driver compiles only what is launched.
//!
//! `cargo xtask ptx` writes the files beside this one. A kernel without its file does not compile.

use crate::{Module, PtxInfo};

macro_rules! modules {
    ($($name:ident: $kernel:ty),* $(,)?) => {
        /// Every kernel of this crate.
        pub(crate) const MODULES: &[Module] = &[$(Module {
            name: stringify!($name),
            source: include_str!(concat!(stringify!($name), ".ptx")),
        }),*];
    };
}

raywarp_core::for_each_kernel!(modules);

/// What the head of a module says of all of them.
pub(crate) fn info() -> PtxInfo {
    let module = MODULES.first().map_or("", |module| module.source);
    let after = |start: &str| {
        let found = module.lines().take(5).find_map(|line| line.strip_prefix(start));
        found.unwrap_or("unknown").to_owned()
    };
    PtxInfo { target: after(".target "), isa: after(".version "), producer: after("// Made with ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_holds_its_kernel_and_says_where_it_comes_from() {
        for Module { name, source } in MODULES {
            assert!(source.contains(&format!(".visible .entry {name}(")), "{name}");
        }
        let info = info();
        assert_eq!(info.target, "sm_75");
        assert!(info.isa.starts_with(|digit: char| digit.is_ascii_digit()), "{info:?}");
        assert!(info.producer.starts_with("rustc "), "{info:?}");
    }
}
