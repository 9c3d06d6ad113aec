//! A progress bar for people who wait.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// What a frame counts in [`Words::Frames`].
pub const THOUSAND: u64 = 1000;

/// A bar on standard error that comes after a second, on a terminal only.
pub struct Bar {
    wanted: bool,
    start: Instant,
    bar: Option<ProgressBar>,
    words: Words,
}

/// What a bar says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Words {
    /// Samples of a picture.
    Render,
    /// Frames, in thousandths of one.
    Frames,
    /// Rays, and how many a second.
    Query,
}

impl Bar {
    /// No bar yet.
    pub fn new(quiet: bool, words: Words) -> Self {
        Self { wanted: !quiet && io::stderr().is_terminal(), start: Instant::now(), bar: None, words }
    }

    /// Moves the bar; where nobody knows how far there is to go, it only counts.
    pub fn update(&mut self, done: u64, total: Option<u64>) {
        if !self.wanted || (self.bar.is_none() && self.start.elapsed() < PATIENCE) {
            return;
        }
        let words = self.words;
        self.bar.get_or_insert_with(|| words.bar(total)).set_position(done);
    }
}

impl Words {
    fn bar(self, total: Option<u64>) -> ProgressBar {
        let template = match (self, total) {
            (Self::Render, _) => "render [{bar:40}] {percent}%, {elapsed} gone, {eta} to go",
            (Self::Frames, _) => "render [{bar:40}] {frames} frames, {elapsed} gone, {eta} to go",
            (Self::Query, Some(_)) => "query [{bar:40}] {percent}%, {rate}, {elapsed} gone, {eta} to go",
            (Self::Query, None) => "query {spinner} {human_pos} rays, {rate}, {elapsed} gone",
        };
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let frames = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            let (done, total) = (state.pos() / THOUSAND, state.len().unwrap_or_default() / THOUSAND);
            let _ = write!(text, "{done} of {total}");
        };
        let style = style.with_key("frames", frames);
        let bar = total.map_or_else(ProgressBar::new_spinner, ProgressBar::new).with_elapsed(PATIENCE);
        bar.with_style(style.with_key("rate", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            // A word that cannot be shown is left out.
            let _ = write!(text, "{:.2} million a second", 1e-6 * state.per_sec());
        }))
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
