//! The interactive core, without any window.
//!
//! A [`LiveScene`] holds the scene on its device and what people changed about it; a [`Viewer`] is one pair of eyes on it:
//! camera, options and picture. A window has one viewer; a server has one for each browser, all before one live scene. Both
//! belong to one thread: what takes long (reading, building, compiling kernels) runs beside it, and
//! [`LiveScene::poll`] takes what is ready.

pub mod boxes;
pub mod camera_control;
mod control_value;
pub mod edits;
mod event;
mod export;
mod help;
pub mod keys;
mod live_scene;
mod meter;
pub mod object_drag;
mod outcome;
pub mod outline;
mod pace;
mod panel;
pub mod panel_rows;
mod parameter_control;
pub mod pick;
pub mod pointer;
mod status;
pub mod view_settings;
mod viewer;
pub mod watch;

pub use event::{Button, Event, Modifiers};
pub use export::{Export, Ticket};
pub use help::HELP;
pub use live_scene::{LiveScene, LiveSceneOptions, LiveSceneVersion, Source};
pub use outcome::Outcome;
pub use panel::{Control, Panel, Row, Section, Value};
pub use status::{Legend, Notice, Status};
pub use viewer::{Picture, Viewer};
