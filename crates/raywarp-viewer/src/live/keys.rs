//! Every key and what it does: one table, from which both the behaviour and the help are made.
//!
//! Keys are written as people read them: "Ctrl+Shift+Z", "Space", "Up"; several for one action with ", " between them.
//! The letters W A S D Q E fly and are free of other meanings, with and without Shift (fast) and Alt (slow).

use super::camera_control::{Fly, Preset};
use super::view_settings::View;
use super::{Event, Modifiers};

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Done with the pointer: no key does it.
    Pointer,
    /// Fly that way while the key is held.
    Fly(Fly),
    /// Look from there.
    Preset(Preset),
    /// Between a pinhole and parallel rays.
    Projection,
    /// Whether a drag turns about the target or about the eye.
    Look,
    /// Back to the first view.
    ResetCamera,
    /// See the picked object, or everything.
    Frame,
    /// Orbit about what is under the pointer.
    Focus,
    /// The scene's next camera.
    NextCamera,
    /// The scene's previous camera.
    PreviousCamera,
    /// Show that, or the picture again.
    View(View),
    /// Show the next view.
    NextView,
    /// Show the previous view.
    PreviousView,
    /// Show the boxes of the tree, one level deeper each time.
    DeeperBoxes,
    /// One level up; none at last.
    HigherBoxes,
    /// Half a stop brighter.
    Brighter,
    /// Half a stop darker.
    Darker,
    /// No exposure.
    ResetExposure,
    /// The next tone map.
    ToneMap,
    /// Shadows or none.
    Shadows,
    /// Full size and all samples while the camera moves.
    Reference,
    /// The help, or no help.
    Help,
    /// The panel, or no panel.
    Panel,
    /// The statistics, or none.
    Statistics,
    /// Move the picked object with the pointer while the key is held.
    Grab,
    /// Keep the picture as a file.
    Screenshot,
    /// Read the scene again.
    Reload,
    /// The camera as options of `raywarp render`, to the clipboard.
    CopyCamera,
    /// Keep the scene as it is now.
    Save,
    /// Take the last edit back.
    Undo,
    /// Make it again.
    Redo,
    /// Close the help, else let go of the picked object.
    Escape,
    /// Leave.
    Quit,
}

/// Keys that do one thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// As the help shows them.
    pub keys: &'static str,
    /// What they do.
    pub action: Action,
}

macro_rules! bindings {
    ($($group:literal { $($keys:literal => $action:expr, $words:literal;)* })*) => {
        /// Keys and what they do, in groups.
        pub(super) const HELP: &[(&str, &[(&str, &str)])] = &[$(($group, &[$(($keys, $words)),*])),*];
        /// Every binding, in the order of the help.
        pub const BINDINGS: &[Binding] = &[$($(Binding { keys: $keys, action: $action }),*),*];
    };
}

bindings! {
    "Camera" {
        "drag" => Action::Pointer, "orbit about the target";
        "Ctrl+drag" => Action::Pointer, "look around: turn about the eye";
        "J" => Action::Look, "a drag looks around, or orbits again";
        "Shift+drag, middle drag" => Action::Pointer, "pan";
        "wheel, right drag" => Action::Pointer, "closer, farther";
        "W" => Action::Fly(Fly::Forward), "fly forward; with Shift fast, with Alt slow";
        "S" => Action::Fly(Fly::Back), "fly back";
        "A" => Action::Fly(Fly::Left), "fly left";
        "D" => Action::Fly(Fly::Right), "fly right";
        "Q" => Action::Fly(Fly::Down), "fly down";
        "E" => Action::Fly(Fly::Up), "fly up";
        "F" => Action::Focus, "orbit about what is under the pointer; also middle click";
        "., Home" => Action::Frame, "see the picked object, or everything";
        "R, Enter" => Action::ResetCamera, "first view";
        "1" => Action::Preset(Preset::Front), "from the front";
        "2, Ctrl+1" => Action::Preset(Preset::Back), "from the back";
        "3" => Action::Preset(Preset::Right), "from the right";
        "4, Ctrl+3" => Action::Preset(Preset::Left), "from the left";
        "7" => Action::Preset(Preset::Top), "from above";
        "8, Ctrl+7" => Action::Preset(Preset::Bottom), "from below";
        "9" => Action::Preset(Preset::Isometric), "isometric";
        "5" => Action::Projection, "perspective or parallel";
        "C, PageDown" => Action::NextCamera, "next camera of the scene";
        "Shift+C, PageUp" => Action::PreviousCamera, "previous camera of the scene";
    }
    "Picture" {
        "Space" => Action::Reference, "full quality while moving";
        "+, =" => Action::Brighter, "half a stop brighter";
        "-" => Action::Darker, "half a stop darker";
        "0" => Action::ResetExposure, "no exposure";
        "Y" => Action::ToneMap, "next tone map";
        "U" => Action::Shadows, "shadows";
    }
    "Views" {
        "N" => Action::View(View::Normals), "normals";
        "Z" => Action::View(View::Depth), "depth";
        "O" => Action::View(View::Albedo), "albedo, the own colours";
        "T" => Action::View(View::Primitives), "primitives, a colour a triangle";
        "M" => Action::View(View::Materials), "materials";
        "X" => Action::View(View::Tests), "tests a pixel";
        "L" => Action::View(View::Load), "load";
        "V" => Action::NextView, "next view";
        "Shift+V" => Action::PreviousView, "previous view";
        "B" => Action::DeeperBoxes, "boxes of the tree, a level deeper";
        "Shift+B" => Action::HigherBoxes, "boxes of the tree, a level up";
        "I" => Action::Statistics, "statistics";
    }
    "Scene" {
        "click" => Action::Pointer, "pick";
        "G" => Action::Grab, "hold it and move the pointer: move the picked object; also Alt+drag";
        "Escape" => Action::Escape, "close the help, let go of the picked";
        "Ctrl+Z" => Action::Undo, "undo";
        "Ctrl+Shift+Z, Ctrl+Y" => Action::Redo, "redo";
        "Up" => Action::Reload, "read the scene again";
        "Ctrl+S" => Action::Save, "keep the scene as a file";
    }
    "Window" {
        "H, ?" => Action::Help, "this help";
        "P, Tab" => Action::Panel, "panel";
        "F12" => Action::Screenshot, "keep the picture as a file";
        "Ctrl+C" => Action::CopyCamera, "copy the camera as options of raywarp render";
        "Ctrl+Q" => Action::Quit, "leave";
    }
}

/// What a key that goes down asks for; nothing for other events and for keys without a meaning.
pub fn action(event: &Event) -> Option<Action> {
    let Event::Key { key, down: true, modifiers } = event else { return None };
    let meant = |binding: &&Binding| chords(binding).any(|chord| chord.is(key, *modifiers, binding.action));
    BINDINGS.iter().find(meant).map(|binding| binding.action)
}

/// The way that a key flies, whatever else is held.
pub fn fly(key: &str) -> Option<Fly> {
    BINDINGS.iter().find_map(|binding| match binding.action {
        Action::Fly(way) if chords(binding).any(|chord| chord.key == plain(key)) => Some(way),
        _ => None,
    })
}

/// Whether a key is one of an action's, whatever else is held: for keys that go up.
pub fn is_key_of(key: &str, action: Action) -> bool {
    let mut own = BINDINGS.iter().filter(|binding| binding.action == action);
    own.any(|binding| chords(binding).any(|chord| chord.key == plain(key)))
}

/// A key with what must be held beside it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Chord {
    key: String,
    ctrl: bool,
    shift: bool,
}

fn chords(binding: &Binding) -> impl Iterator<Item = Chord> {
    let keys = if binding.action == Action::Pointer { "" } else { binding.keys };
    keys.split(", ").filter(|keys| !keys.is_empty()).map(Chord::read)
}

impl Chord {
    fn read(mut text: &str) -> Self {
        let (mut ctrl, mut shift) = (false, false);
        loop {
            if let Some(rest) = text.strip_prefix("Ctrl+") {
                (text, ctrl) = (rest, true);
            } else if let Some(rest) = text.strip_prefix("Shift+") {
                (text, shift) = (rest, true);
            } else {
                break;
            }
        }
        let key = match text {
            "Space" => " ".to_owned(),
            "Up" => "ArrowUp".to_owned(),
            _ => plain(text),
        };
        Self { key, ctrl, shift }
    }

    fn is(&self, key: &str, held: Modifiers, action: Action) -> bool {
        let flies = matches!(action, Action::Fly(_));
        // Signs come by way of Shift on some keyboards and without it on others.
        let is_sign = self.key.chars().count() == 1 && !self.key.starts_with(char::is_alphabetic) && self.key != " ";
        let shift = flies || is_sign || self.shift == held.shift;
        self.key == plain(key) && self.ctrl == held.ctrl && shift && (flies || !held.alt)
    }
}

/// A letter in lower case, and every other key as it is.
fn plain(key: &str) -> String {
    if key.chars().count() == 1 {
        key.to_lowercase()
    } else {
        key.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    fn press(key: &str, [ctrl, shift, alt]: [bool; 3]) -> Event {
        Event::Key { key: key.to_owned(), down: true, modifiers: Modifiers { shift, ctrl, alt } }
    }

    #[test]
    fn no_key_has_two_meanings_and_those_that_fly_have_no_other() {
        let mut meanings = HashMap::new();
        for binding in BINDINGS {
            for chord in chords(binding) {
                assert_eq!(meanings.insert(chord.clone(), binding.action), None, "{chord:?}");
            }
        }
        for (chord, action) in &meanings {
            assert!(fly(&chord.key).is_none() || chord.ctrl || matches!(action, Action::Fly(_)), "{chord:?}");
        }
    }

    #[test]
    fn every_binding_does_what_the_help_says() {
        let lines = HELP.iter().map(|(_, lines)| lines.len()).sum::<usize>();
        assert_eq!(lines, BINDINGS.len());
        for binding in BINDINGS {
            for chord in chords(binding) {
                let event = press(&chord.key, [chord.ctrl, chord.shift, false]);
                assert_eq!(action(&event), Some(binding.action), "{}", binding.keys);
            }
        }
    }

    #[test]
    fn modifiers_tell_keys_apart() {
        assert_eq!(action(&press("c", [true, false, false])), Some(Action::CopyCamera));
        assert_eq!(action(&press("C", [false, true, false])), Some(Action::PreviousCamera));
        assert_eq!(action(&press("Z", [true, true, false])), Some(Action::Redo));
        assert_eq!(action(&press("s", [true, false, false])), Some(Action::Save));
        assert_eq!(action(&press("W", [false, true, true])), Some(Action::Fly(Fly::Forward)));
        assert_eq!(action(&press("?", [false, true, false])), Some(Action::Help));
        assert_eq!(action(&press(" ", [false; 3])), Some(Action::Reference));
        assert_eq!(action(&press("w", [true, false, false])), None);
        for key in ["", "Dead", "ß", "F99", "ArrowDown", "+ ", ", "] {
            assert_eq!(action(&press(key, [false; 3])), None, "{key}");
        }
        assert_eq!(action(&Event::Blur), None);
    }
}
