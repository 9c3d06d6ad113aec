//! The PTX of each kernel, a module each: the driver compiles only what is launched.
//!
//! `cargo xtask ptx` writes the files beside this one. A kernel without its file does not compile.

macro_rules! sources {
    ($($name:ident: $kernel:ty),* $(,)?) => {
        /// The PTX module of the kernel of this name.
        pub fn source(name: &str) -> Option<&'static str> {
            match name {
                $(stringify!($name) => Some(include_str!(concat!(stringify!($name), ".ptx"))),)*
                _ => None,
            }
        }
    };
}

raywarp_kernels::for_each_kernel!(sources);
