//! From the window's events to the core's.
//!
//! What is pressed over the panel belongs to the interface until it is released, what is pressed over the picture to the
//! core; so a drag that crosses the border stays what it began as, and nothing is released that was not pressed.

use std::collections::HashSet;

use winit::event::{MouseButton, MouseScrollDelta};
use winit::keyboard::{Key, ModifiersState, NamedKey};

use raywarp_viewer::live::{Button, Event, Modifiers};

/// Pixels, before scaling, that a touch pad moves for one notch of a wheel.
const NOTCH: f64 = 50.0;

/// What is held.
#[derive(Default)]
pub struct Input {
    modifiers: Modifiers,
    buttons: Vec<Button>,
    keys: HashSet<String>,
}

impl Input {
    /// Keys held from now on.
    pub fn set_modifiers(&mut self, state: ModifiersState) {
        let ctrl = state.control_key() || (cfg!(target_os = "macos") && state.super_key());
        self.modifiers = Modifiers { shift: state.shift_key(), ctrl, alt: state.alt_key() };
    }

    /// The pointer is at a place of the window, both in pixels. `over`: the interface is under it.
    pub fn pointer(&self, place: [f64; 2], size: [u32; 2], over: bool) -> Option<Event> {
        let share = |i: usize| (place[i] / f64::from(size[i].max(1))) as f32;
        (!over || !self.buttons.is_empty()).then(|| Event::Pointer { x: share(0), y: share(1) })
    }

    /// A button goes down or up.
    pub fn button(&mut self, button: MouseButton, down: bool, over: bool) -> Option<Event> {
        let button = match button {
            MouseButton::Left => Button::Left,
            MouseButton::Middle => Button::Middle,
            MouseButton::Right => Button::Right,
            _ => return None,
        };
        let held = self.buttons.iter().position(|&held| held == button);
        match (down, held) {
            (true, None) if !over => self.buttons.push(button),
            (false, Some(i)) => drop(self.buttons.remove(i)),
            _ => return None,
        }
        Some(Event::Button { button, down, modifiers: self.modifiers })
    }

    /// The wheel turns.
    pub fn wheel(&self, delta: MouseScrollDelta, scale: f64, over: bool) -> Option<Event> {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, lines) => lines,
            MouseScrollDelta::PixelDelta(pixels) => (pixels.y / (NOTCH * scale.max(0.1))) as f32,
        };
        (!over && notches != 0.0 && notches.is_finite()).then_some(Event::Wheel { notches })
    }

    /// A key goes down or up. `typing`: the interface has the keyboard.
    pub fn key(&mut self, key: &Key, down: bool, repeat: bool, typing: bool) -> Option<Event> {
        let key = name(key)?;
        let known = if down {
            !repeat && !typing && self.keys.insert(key.clone())
        } else {
            // Shift may have gone up since, and the letter be another one.
            self.keys.remove(&key) || self.keys.remove(&other_case(&key))
        };
        known.then_some(Event::Key { key, down, modifiers: self.modifiers })
    }

    /// The keyboard is elsewhere.
    pub fn blur(&mut self) -> Event {
        *self = Self::default();
        Event::Blur
    }
}

/// As the web's `KeyboardEvent.key` names it.
fn name(key: &Key) -> Option<String> {
    match key {
        Key::Character(text) => Some(text.to_string()),
        Key::Named(NamedKey::Space) => Some(" ".to_owned()),
        Key::Named(NamedKey::Super) => Some("Meta".to_owned()),
        // winit takes its names from the same standard.
        Key::Named(named) => Some(format!("{named:?}")),
        Key::Dead(_) => Some("Dead".to_owned()),
        Key::Unidentified(_) => None,
    }
}

fn other_case(key: &str) -> String {
    let (lower, upper) = (key.to_lowercase(), key.to_uppercase());
    if key == lower {
        upper
    } else {
        lower
    }
}

#[cfg(test)]
mod tests {
    use winit::dpi::PhysicalPosition;

    use super::*;

    fn character(text: &str) -> Key {
        Key::Character(text.into())
    }

    #[test]
    fn keys_have_the_names_of_the_web() {
        let expected = [
            (Key::Named(NamedKey::Space), " "),
            (Key::Named(NamedKey::ArrowUp), "ArrowUp"),
            (Key::Named(NamedKey::Escape), "Escape"),
            (Key::Named(NamedKey::Enter), "Enter"),
            (Key::Named(NamedKey::F12), "F12"),
            (Key::Named(NamedKey::Control), "Control"),
            (Key::Named(NamedKey::Super), "Meta"),
            (Key::Named(NamedKey::PageDown), "PageDown"),
            (character("H"), "H"),
            (character("?"), "?"),
        ];
        for (key, expected) in expected {
            assert_eq!(name(&key).as_deref(), Some(expected));
        }
    }

    #[test]
    fn a_held_key_is_told_once_and_released_once() {
        let mut input = Input::default();
        assert!(input.key(&character("w"), true, false, false).is_some());
        assert_eq!(input.key(&character("w"), true, true, false), None);
        // With Shift pressed meanwhile the same key comes up as another letter.
        assert!(matches!(input.key(&character("W"), false, false, false), Some(Event::Key { down: false, .. })));
        assert_eq!(input.key(&character("w"), false, false, false), None);
    }

    #[test]
    fn what_is_typed_into_the_panel_stays_there() {
        let mut input = Input::default();
        assert_eq!(input.key(&character("h"), true, false, true), None);
        assert_eq!(input.key(&character("h"), false, false, true), None);
        // Pressed over the picture, released after the panel took the keyboard.
        assert!(input.key(&character("d"), true, false, false).is_some());
        assert!(input.key(&character("d"), false, false, true).is_some());
    }

    #[test]
    fn a_drag_belongs_to_where_it_began() {
        let mut input = Input::default();
        assert_eq!(input.button(MouseButton::Left, true, true), None);
        assert_eq!(input.pointer([10.0, 10.0], [100, 50], true), None);
        assert_eq!(input.button(MouseButton::Left, false, false), None);

        assert!(input.button(MouseButton::Left, true, false).is_some());
        assert_eq!(input.pointer([150.0, -25.0], [100, 50], true), Some(Event::Pointer { x: 1.5, y: -0.5 }));
        assert!(input.button(MouseButton::Left, false, true).is_some());
        assert_eq!(input.button(MouseButton::Back, true, false), None);
    }

    #[test]
    fn notches_of_wheels_and_of_touch_pads() {
        let input = Input::default();
        let wheel = |delta| input.wheel(delta, 2.0, false);
        assert_eq!(wheel(MouseScrollDelta::LineDelta(3.0, -1.0)), Some(Event::Wheel { notches: -1.0 }));
        let pixels = MouseScrollDelta::PixelDelta(PhysicalPosition::new(0.0, 25.0));
        assert_eq!(wheel(pixels), Some(Event::Wheel { notches: 0.25 }));
        assert_eq!(wheel(MouseScrollDelta::LineDelta(1.0, 0.0)), None);
        assert_eq!(input.wheel(pixels, 1.0, true), None);
    }

    #[test]
    fn nothing_is_held_without_the_keyboard() {
        let mut input = Input::default();
        input.set_modifiers(ModifiersState::SHIFT | ModifiersState::CONTROL);
        let held = Modifiers { shift: true, ctrl: true, alt: false };
        let down = input.button(MouseButton::Right, true, false);
        assert_eq!(down, Some(Event::Button { button: Button::Right, down: true, modifiers: held }));
        assert_eq!(input.blur(), Event::Blur);
        assert_eq!(input.button(MouseButton::Right, false, false), None);
    }
}
