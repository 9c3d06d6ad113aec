//! What the linkers of some systems must be told where symbols are left to whoever loads a library.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
