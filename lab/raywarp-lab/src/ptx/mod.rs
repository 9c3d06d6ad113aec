//! The PTX of the laboratory's kernels, a module each. `cargo xtask ptx` writes the files beside this one.

use raywarp::device::Module;

macro_rules! modules {
    ($($name:ident: $kernel:ty),* $(,)?) => {
        /// Every kernel of the laboratory.
        pub const MODULES: &[Module] = &[$(Module {
            name: stringify!($name),
            source: include_str!(concat!(stringify!($name), ".ptx")),
        }),*];
    };
}

raywarp_lab_core::for_each_lab_kernel!(modules);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_module_holds_its_kernel() {
        for Module { name, source } in MODULES {
            assert!(source.contains(&format!(".visible .entry {name}(")), "{name}");
        }
    }
}
