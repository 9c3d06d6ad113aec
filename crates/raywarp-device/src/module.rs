//! Kernels in a program, as text.

/// The PTX of one kernel. The driver compiles a module as a whole when it is loaded, so each kernel has its own.
#[derive(Clone, Copy, Debug)]
pub struct Module {
    /// Name of the kernel's entry point.
    pub name: &'static str,
    /// The module.
    pub source: &'static str,
}
