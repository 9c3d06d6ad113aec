//! What the program `raywarp` is made of, for it and for the programs beside it: its window and its laboratory.
//!
//! No library for others: whatever is here may change with the next commit.

#[doc(hidden)]
pub mod advice;
#[doc(hidden)]
pub mod bench;
mod browser;
#[doc(hidden)]
pub mod columns;
mod completions;
mod doctor;
#[doc(hidden)]
pub mod failure;
mod frames;
mod guess;
mod info;
#[doc(hidden)]
pub mod interrupt;
mod limits;
mod man;
#[doc(hidden)]
pub mod messages;
#[doc(hidden)]
pub mod options;
#[doc(hidden)]
pub mod output;
#[doc(hidden)]
pub mod paper;
mod progress;
mod provenance;
mod query;
mod read_ahead;
#[doc(hidden)]
pub mod render;
#[doc(hidden)]
pub mod report;
mod serve;
#[doc(hidden)]
pub mod values;
mod view;

use std::ffi::OsString;
use std::process::ExitCode;

use options::{Command, RenderOptions};

/// Does what the command line asks.
pub fn main() -> ExitCode {
    run(std::env::args_os().collect()).into()
}

/// Does what the words of a command line ask, the first of which is the program's name; returns what the shell is told. Where help is
/// asked for, or the options make no sense, this process ends.
pub fn run(words: Vec<OsString>) -> u8 {
    let options = match guess::parse(words) {
        Ok(options) => options,
        Err(error) => return failure::of_options(&error),
    };
    let done = match options.command {
        None => render::run(&RenderOptions::built_in()),
        Some(Command::Render(options)) => render::run(&options),
        Some(Command::View(options)) => view::run(&options),
        Some(Command::Query(options)) => query::run(&options),
        Some(Command::Serve(options)) => serve::run(&options),
        Some(Command::Info(options)) => info::run(&options),
        Some(Command::Bench(options)) => bench::run(&options),
        Some(Command::Doctor) => doctor::run(),
        Some(Command::Completions(options)) => completions::run(&options),
        Some(Command::Man(options)) => man::run(&options),
    };
    match done {
        Ok(()) => 0,
        Err(failure) => failure.tell(),
    }
}
