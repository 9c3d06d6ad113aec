//! The tests of the viewer from outside, as one program; a file here is a module:
//! `cargo test -p raywarp-viewer --test integration edits::`. On the device that `RAYWARP_TEST_DEVICE` names, else on the CPU.

mod edits;
mod live;
mod session;
