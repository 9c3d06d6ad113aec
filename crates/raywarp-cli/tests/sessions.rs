//! The commands of the program that wait for people, browsers and signals, as one test program; a file here is a module:
//! `cargo test -p raywarp-cli --test sessions browser::`. Apart from the others, which would keep all cores busy: some of these are
//! about time.

mod browser;
mod common;
mod serve;
mod served;
mod signals;
mod view;
