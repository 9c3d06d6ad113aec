//! The side panel of a viewer: made from its options, its camera, the edits and what is picked, and applied to them.
//!
//! Every value from outside is checked against the control that it is for: a refusal is a sentence, and changes nothing.

mod camera;
mod rendering;
#[cfg(test)]
mod tests;

use raywarp::accel::Build;

use super::camera_control::CameraControl;
use super::edits::{Edits, Touched};
use super::keys::Action;
use super::pick::Pick;
use super::view_settings::ViewSettings;
use super::{control_value, Control, Panel, Row, Section, Value};

/// What the panel shows.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// The viewer's options.
    pub view_settings: &'a ViewSettings,
    /// Those that nobody has changed.
    pub usual: &'a ViewSettings,
    /// The structure as it is and as it was at first.
    pub tree: [Build; 2],
    /// The camera, once there is a scene.
    pub camera: Option<&'a CameraControl>,
    /// The edits, once there is a scene.
    pub edits: Option<&'a Edits>,
    /// What is picked.
    pub pick: Option<&'a Pick>,
}

/// What the panel changes: the same, in the hands of one who may.
pub struct CommandContext<'a> {
    /// The viewer's options.
    pub view_settings: &'a mut ViewSettings,
    /// Those that nobody has changed.
    pub usual: &'a ViewSettings,
    /// The structure as it is and as it was at first.
    pub tree: [Build; 2],
    /// The camera, once there is a scene.
    pub camera: Option<&'a mut CameraControl>,
    /// The edits, once there is a scene.
    pub edits: Option<&'a mut Edits>,
}

/// What remains to be done after a change.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Lines beside the picture changed, or nothing did.
    Overlay,
    /// The same samples are to be shown otherwise.
    ToneMapFilm,
    /// The picture starts again: options or camera changed.
    Picture,
    /// Another structure is wanted.
    Build(Build),
    /// The scene changed; nothing in the list: it did not.
    Scene(Vec<Touched>),
    /// A button that does what a key does: save, reload, screenshot, copy, undo, redo.
    Act(Action),
}

/// Buttons of the last section: name, label, and what they do.
const BUTTONS: [(&str, &str, Action); 6] = [
    ("file.undo", "Undo", Action::Undo),
    ("file.redo", "Redo", Action::Redo),
    ("file.save", "Save the scene", Action::Save),
    ("file.reload", "Read the scene again", Action::Reload),
    ("file.screenshot", "Save the picture", Action::Screenshot),
    ("file.copy_camera", "Copy the camera", Action::CopyCamera),
];

/// All controls.
pub fn panel(shown: &Shown) -> Panel {
    let mut sections = vec![rendering::section([shown.view_settings, shown.usual], &shown.tree)];
    sections.extend(shown.camera.map(camera::section));
    if let Some(edits) = shown.edits {
        if let Some(pick) = shown.pick {
            sections.extend(edits.material_section(pick.material));
            sections.extend(edits.instance_section(pick.instance));
        }
        sections.extend(edits.light_sections());
        sections.push(edits.background_section());
    }
    let button = |(id, label, _): (&str, &str, Action)| row(id, label, [Value::Flag(false)], Control::Action);
    let rows = BUTTONS.into_iter().map(button).collect();
    sections.push(Section { id: "file".to_owned(), title: "File".to_owned(), rows });
    Panel { sections }
}

impl CommandContext<'_> {
    /// Gives the value of a row.
    ///
    /// # Errors
    /// A sentence where there is no such row or it cannot take the value; then nothing changes.
    pub fn set(&mut self, id: &str, value: &Value) -> Result<Effect, String> {
        if let Some((_, _, action)) = BUTTONS.iter().find(|button| button.0 == id) {
            return Ok(Effect::Act(*action));
        }
        let early = || "there is no scene yet".to_owned();
        match id.split('.').next().unwrap_or_default() {
            "look" | "tree" => rendering::set(self.view_settings, self.usual, &self.tree, id, value),
            "camera" => camera::set(self.camera.as_deref_mut().ok_or_else(early)?, id, value),
            "lights" if id == "lights.add" => {
                let (edits, camera) = (self.edits.as_deref_mut().ok_or_else(early)?, self.camera.as_deref());
                edits.add_light(camera.ok_or_else(early)?.camera()).map(Effect::Scene)
            }
            _ => self.edits.as_deref_mut().ok_or_else(early)?.set(id, value).map(Effect::Scene),
        }
    }

    /// Back to the default: of a row, of a section, or with an empty name of everything. Several effects may remain to
    /// be seen to.
    pub fn reset(&mut self, id: &str) -> Vec<Effect> {
        let mut effects = rendering::reset(self.view_settings, self.usual, &self.tree, id);
        if let Some(control) = self.camera.as_deref_mut() {
            effects.extend(camera::reset(control, id));
        }
        if let Some(edits) = self.edits.as_deref_mut() {
            effects.extend(Some(edits.reset(id)).filter(|touched| !touched.is_empty()).map(Effect::Scene));
        }
        effects
    }
}

/// Whether a reset of `wanted` is about a row of a section.
fn is_meant(wanted: &str, section: &str, row: &str) -> bool {
    wanted.is_empty() || wanted == section || wanted == row
}

/// A row that says the first value, and has the last one as its default.
fn row<const N: usize>(id: &str, label: &str, values: [Value; N], control: Control) -> Row {
    let changed = values.first() != values.last();
    let value = values.into_iter().next().unwrap_or(Value::Flag(false));
    Row { id: id.to_owned(), label: label.to_owned(), value, control, changed }
}

/// The value if its row takes it.
fn checked(rows: &[Row], id: &str, value: &Value) -> Result<(), String> {
    let row =
        rows.iter().find(|row| row.id == id).ok_or_else(|| format!("there is nothing called '{id}' to change"))?;
    control_value::check(&row.control, value).map_err(|why| format!("{} {why}", row.label))
}
