//! Moving the picked object with the pointer, in the plane of the picture.

use super::camera_control::CameraControl;
use super::keys::{self, Action};
use super::{Button, Event};

/// What an event was for an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dragged {
    /// Whether the event is done with: the camera must not see it.
    pub consumed: bool,
    /// The move in world space: for the instance, and for the picked point that goes with it.
    pub by: Option<[f32; 3]>,
    /// Whether this is its first move since the object was taken hold of.
    pub begins: bool,
}

/// Whether the pointer moves the picked object: with G held, or with the left button that went down with Alt.
#[derive(Clone, Debug, Default)]
pub struct ObjectDrag {
    at: [f32; 2],
    grabs: bool,
    presses: bool,
    /// Whether the object has not moved since.
    fresh: bool,
}

impl ObjectDrag {
    /// Takes an event, before the camera does. `picked` is a point of the picked object; without one nothing is moved.
    pub fn handle(&mut self, event: &Event, aspect: f32, picked: Option<[f32; 3]>, control: &CameraControl) -> Dragged {
        let is_there = picked.is_some();
        let consumed = match event {
            Event::Pointer { x, y } => {
                let from = std::mem::replace(&mut self.at, [*x, *y]);
                let moves = (self.grabs || self.presses) && is_there;
                let by = picked.filter(|_| moves).and_then(|point| control.shift(point, from, self.at, aspect));
                let begins = by.is_some() && std::mem::take(&mut self.fresh);
                return Dragged { consumed: moves, by, begins };
            }
            Event::Button { button: Button::Left, down: true, modifiers } if modifiers.alt && is_there => {
                (self.presses, self.fresh) = (true, true);
                true
            }
            Event::Button { button: Button::Left, down: false, .. } => std::mem::take(&mut self.presses),
            Event::Key { down: true, .. } if keys::action(event) == Some(Action::Grab) => {
                (self.grabs, self.fresh) = (true, true);
                true
            }
            Event::Key { key, down: false, .. } if keys::is_key_of(key, Action::Grab) => {
                std::mem::take(&mut self.grabs)
            }
            Event::Blur => {
                (self.grabs, self.presses) = (false, false);
                false
            }
            _ => false,
        };
        Dragged { consumed, by: None, begins: false }
    }

    /// Whether the pointer moves an object.
    pub fn is_moving(&self) -> bool {
        self.grabs || self.presses
    }
}

#[cfg(test)]
mod tests {
    use raywarp::render::framing;
    use raywarp::scene::Camera;

    use super::*;
    use crate::live::Modifiers;

    fn control() -> CameraControl {
        let bounds = [[-1.0; 3], [1.0; 3]];
        let home = Camera { eye: [3.0, 0.0, 4.0], target: [0.0; 3], ..framing(bounds) };
        let mut control = CameraControl::new(home, Vec::new(), bounds, [0.0, 1.0, 0.0]);
        control.handle(&key("1", true), 2.0);
        control
    }

    fn key(key: &str, down: bool) -> Event {
        Event::Key { key: key.into(), down, modifiers: Modifiers::default() }
    }

    fn left(down: bool, alt: bool) -> Event {
        Event::Button { button: Button::Left, down, modifiers: Modifiers { alt, ..Modifiers::default() } }
    }

    /// The sum of all moves, and how many events the camera would not see.
    fn run(events: &[Event], picked: Option<[f32; 3]>) -> ([f32; 3], usize) {
        let (mut drag, control) = (ObjectDrag::default(), control());
        events.iter().map(|event| drag.handle(event, 2.0, picked, &control)).fold(([0.0; 3], 0), |(sum, n), dragged| {
            let by = dragged.by.unwrap_or_default();
            ([0, 1, 2].map(|i| sum[i] + by[i]), n + usize::from(dragged.consumed))
        })
    }

    #[test]
    fn the_object_goes_with_the_pointer_while_it_is_held() {
        let to = |x, y| Event::Pointer { x, y };
        let events = [to(0.5, 0.5), left(true, true), to(0.75, 0.25), left(false, false), to(0.0, 0.0)];
        let control = control();
        let height = 2.0 * 5.0 * 0.35f32.tan();
        let ([x, y, z], consumed) = run(&events, Some([0.0; 3]));
        assert!((x - 0.5 * height).abs() < 1e-4 && (y - 0.25 * height).abs() < 1e-4 && z.abs() < 1e-5);
        assert_eq!(consumed, 3);
        // Twice as close, half as far.
        let eye = control.camera().eye;
        let ([closer, ..], _) = run(&events, Some([eye[0] / 2.0, eye[1] / 2.0, eye[2] / 2.0]));
        assert!((closer - 0.5 * x).abs() < 1e-4);

        let by_key = [to(0.5, 0.5), key("g", true), to(0.75, 0.25), key("G", false), to(0.0, 0.0)];
        assert_eq!(run(&by_key, Some([0.0; 3])).0, [x, y, z]);
    }

    #[test]
    fn nothing_is_moved_that_is_not_picked_or_not_held() {
        let to = |x, y| Event::Pointer { x, y };
        assert_eq!(run(&[left(true, true), to(0.1, 0.1), left(false, true)], None), ([0.0; 3], 0));
        assert_eq!(run(&[left(true, false), to(0.1, 0.1), left(false, false)], Some([0.0; 3])), ([0.0; 3], 0));
        assert_eq!(run(&[key("g", true), Event::Blur, to(0.1, 0.1)], Some([0.0; 3])).0, [0.0; 3]);
        assert_eq!(run(&[key("g", true), to(f32::NAN, 0.1)], Some([0.0; 3])).0, [0.0; 3]);
        // Behind the eye nothing follows the pointer.
        assert_eq!(run(&[key("g", true), to(0.9, 0.9)], Some([0.0, 0.0, 1e3])).0, [0.0; 3]);
    }
}
