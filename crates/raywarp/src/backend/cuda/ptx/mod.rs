//! The PTX of each kernel, a module each: the driver compiles only what is launched.
//!
//! `cargo xtask ptx` writes the files beside this one. A kernel without its file does not compile.

use raywarp_kernels::kernels::NAMES;

use crate::backend::PtxInfo;

macro_rules! sources {
    ($($name:ident: $kernel:ty),* $(,)?) => {
        /// The PTX module of the kernel of this name.
        pub(in crate::backend) fn source(name: &str) -> Option<&'static str> {
            match name {
                $(stringify!($name) => Some(include_str!(concat!(stringify!($name), ".ptx"))),)*
                _ => None,
            }
        }
    };
}

raywarp_kernels::for_each_kernel!(sources);

/// What the head of a module says of all of them.
pub(in crate::backend) fn info() -> PtxInfo {
    let module = NAMES.first().and_then(|name| source(name)).unwrap_or_default();
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
        for name in NAMES {
            let module = source(name).unwrap();
            assert!(module.contains(&format!(".visible .entry {name}(")), "{name}");
        }
        let info = info();
        assert_eq!(info.target, "sm_75");
        assert!(info.isa.starts_with(|digit: char| digit.is_ascii_digit()), "{info:?}");
        assert!(info.producer.starts_with("rustc "), "{info:?}");
    }
}
