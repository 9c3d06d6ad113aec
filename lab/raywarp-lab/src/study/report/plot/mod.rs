//! Plots as SVG, drawn by `plotters` on a white card, so that they read on pages of any colour.
//!
//! [`axis`] is how values become places, [`canvas`] what all plots share, [`palette`] which colour stands for what. Each
//! other module is one kind of plot, told what to show by a plain struct.

mod axis;
mod bars;
mod canvas;
mod histogram;
mod lines;
mod palette;
mod stacked;

pub use bars::{Bar, Bars, Group};
pub use canvas::shortened;
pub use histogram::{Histograms, Panel};
pub use lines::{Line, Lines};
pub use palette::{Palette, Series};
pub use stacked::{Stack, Stacked};
