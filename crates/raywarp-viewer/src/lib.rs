//! A viewer for raywarp: people walk through their scene.
//!
//! [`live`] is the interactive core, without any window: it takes [events](live::Event) and a time, keeps camera and
//! options, renders on the chosen device, and gives pixels, a [status](live::Status) and a [panel](live::Panel). The
//! front ends are thin: they bring events in, show pixels, lay out the status and the panel, and carry out what an
//! [outcome](live::Outcome) asks for. The page of [`serve`] is one, the program `raywarp-window` another.

pub mod error;
pub mod live;
pub mod serve;

pub use error::ViewerError;
