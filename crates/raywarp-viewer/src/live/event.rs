//! What people do, whichever front end they sit before.

use serde::{Deserialize, Serialize};

use super::Value;

/// One input event. As JSON it has its `kind` beside its fields, in snake case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Event {
    /// The pointer is there: shares of the picture's width, from the left, and of its height, from the top. Outside of
    /// 0 to 1 while a drag leaves the picture.
    Pointer {
        /// From the left.
        x: f32,
        /// From the top.
        y: f32,
    },
    /// A button of the pointer goes down or up where the pointer is.
    Button {
        /// Which.
        button: Button,
        /// Down, or up.
        down: bool,
        /// Keys held meanwhile.
        #[serde(default)]
        modifiers: Modifiers,
    },
    /// The wheel turns by so many notches, away from the user for positive ones: closer.
    Wheel {
        /// Notches; a fraction on touch pads.
        notches: f32,
    },
    /// A key goes down or up, by the name that the web's `KeyboardEvent.key` gives it: "h", "H", "1", "Enter", " ",
    /// "Escape", "F12", "ArrowUp".
    Key {
        /// Its name.
        key: String,
        /// Down, or up. Repeats of a held key are left out.
        down: bool,
        /// Keys held meanwhile.
        #[serde(default)]
        modifiers: Modifiers,
    },
    /// The front end lost the keyboard: nothing is held any more.
    Blur,
    /// The picture is to have so many pixels, at least 1 a side.
    Resize {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A control of the panel was changed.
    Set {
        /// Of its [`Row`](super::Row).
        id: String,
        /// What it is to be.
        value: Value,
    },
    /// A control of the panel goes back to its default, or a section, or for an empty name all of them.
    Reset {
        /// Of the [`Row`](super::Row) or [`Section`](super::Section).
        id: String,
    },
}

/// A button of the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Button {
    /// Orbits.
    Left,
    /// Pans.
    Middle,
    /// Zooms.
    Right,
}

/// Keys that change what others mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Modifiers {
    /// Shift.
    pub shift: bool,
    /// Control, or Command on a Mac.
    pub ctrl: bool,
    /// Alt.
    pub alt: bool,
}
