//! The commands of the program that end by themselves, as one test program; a file here is a module:
//! `cargo test -p raywarp-cli --test integration frames::`. What waits for people and signals is in `sessions`.

mod bench;
mod bench_live;
mod common;
mod errors;
mod feature;
mod frames;
mod help;
mod overwrite;
mod query;
mod scene_file;
mod terminal;
