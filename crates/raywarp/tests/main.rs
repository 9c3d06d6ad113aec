//! The tests of the library from outside, as one program: each test program links all of the library. A file here is a module;
//! `cargo test -p raywarp --test integration films::` runs those of one. `RAYWARP_TEST_DEVICE` names a device that those are run
//! on that concern devices (`cuda`, `cuda:1`, ...), beside the CPU or instead of it.

mod boxes;
mod common;
mod conformance;
mod counts;
mod examples;
mod films;
mod hploc;
mod paths;
mod queries;
mod recount;
mod references;
mod save;
mod scene_file;
mod shading;
mod structures;
mod two_level;
mod watertight;
