//! `raywarp study`: the paper's study of structures, load and divergence, on the device at hand.
//!
//! [`findings`] is what a run found, [`report`] how people read it.

// Until the program has the command.
#![allow(dead_code)]

pub mod findings;
pub mod report;
