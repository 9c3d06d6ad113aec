//! `raywarp-lab` as a process.

mod bench;
mod place;
mod report;
