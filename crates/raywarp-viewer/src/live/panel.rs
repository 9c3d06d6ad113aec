//! The side panel as data: each front end lays it out in its own way.

use serde::{Deserialize, Serialize};

/// All controls.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Panel {
    /// From top to bottom.
    pub sections: Vec<Section>,
}

/// Controls that belong together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// For [`Event::Reset`](super::Event::Reset): resets all rows.
    pub id: String,
    /// Its heading.
    pub title: String,
    /// From top to bottom.
    pub rows: Vec<Row>,
}

/// One control.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// For [`Event::Set`](super::Event::Set); stays the same from one panel to the next.
    pub id: String,
    /// For people.
    pub label: String,
    /// What it says now.
    pub value: Value,
    /// How it can be changed.
    pub control: Control,
    /// Whether it differs from its default, so that there is something to undo.
    pub changed: bool,
}

/// How a value can be changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Control {
    /// Only shown.
    Text,
    /// On or off.
    Flag,
    /// A number within a range, in steps; a step of 0 is any.
    Number {
        /// Smallest.
        min: f32,
        /// Largest.
        max: f32,
        /// Between neighbours on a slider.
        step: f32,
    },
    /// One of these.
    Choice {
        /// All that can be chosen.
        options: Vec<String>,
    },
    /// A linear colour, each channel from 0 to `max`.
    Color {
        /// Largest channel.
        max: f32,
    },
    /// Three numbers, such as a place in scene units.
    Vector {
        /// What one notch of a drag changes.
        step: f32,
    },
    /// A button: `Set` with any value does it.
    Action,
}

/// What a control says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Of a flag or an action.
    Flag(bool),
    /// Of a number.
    Number(f32),
    /// Of a colour or a vector.
    Triple([f32; 3]),
    /// Of a choice or a text.
    Text(String),
}
