//! Drags and clicks: the same press of a button is one or the other, by whether the pointer moves meanwhile.

use super::{Button, Event, Modifiers};

/// How far the pointer moves in a press that is still a click, in heights of the picture.
const CLICK: f64 = 0.005;
/// Farther out than this many pictures no pointer goes.
const FARTHEST: f32 = 100.0;

/// A step of a drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drag {
    /// The button that is held.
    pub button: Button,
    /// Keys that were held when it went down.
    pub modifiers: Modifiers,
    /// To the right and down since the last step, in heights of the picture.
    pub by: [f64; 2],
}

/// Where the pointer is, and which button drags.
#[derive(Clone, Debug, Default)]
pub(super) struct Pointer {
    /// In heights of the picture, from the upper left.
    at: [f64; 2],
    press: Option<Press>,
}

#[derive(Clone, Copy, Debug)]
struct Press {
    button: Button,
    modifiers: Modifiers,
    start: [f64; 2],
    dragged: bool,
}

impl Pointer {
    /// Takes an event; the step of a drag, if it is one. The last button that went down drags.
    pub fn handle(&mut self, event: &Event, aspect: f64) -> Option<Drag> {
        match event {
            Event::Pointer { x, y } => self.go(*x, *y, aspect),
            Event::Button { button, down: true, modifiers } => {
                let (button, modifiers) = (*button, *modifiers);
                self.press = Some(Press { button, modifiers, start: self.at, dragged: false });
                None
            }
            Event::Button { button, down: false, .. } => {
                self.press = self.press.filter(|press| press.button != *button);
                None
            }
            Event::Blur => {
                self.press = None;
                None
            }
            _ => None,
        }
    }

    /// The button that drags.
    pub fn drag(&self) -> Option<Button> {
        self.press.filter(|press| press.dragged).map(|press| press.button)
    }

    /// The button that is held and was not dragged so far.
    fn still(&self) -> Option<Button> {
        self.press.filter(|press| !press.dragged).map(|press| press.button)
    }

    fn go(&mut self, x: f32, y: f32, aspect: f64) -> Option<Drag> {
        if !x.is_finite() || !y.is_finite() {
            return None;
        }
        let [x, y] = [x, y].map(|share| f64::from(share.clamp(-FARTHEST, FARTHEST)));
        let before = std::mem::replace(&mut self.at, [x * aspect, y]);
        let press = self.press.as_mut()?;
        press.dragged |= (0..2).any(|i| (self.at[i] - press.start[i]).abs() > CLICK);
        let by = [self.at[0] - before[0], self.at[1] - before[1]];
        press.dragged.then_some(Drag { button: press.button, modifiers: press.modifiers, by })
    }
}

/// Tells clicks from drags.
#[derive(Clone, Debug, Default)]
pub struct Clicks {
    pointer: Pointer,
    share: [f32; 2],
}

impl Clicks {
    /// Takes an event; the button of a click, when it goes up without having been dragged. `aspect` is the picture's
    /// width over its height.
    pub fn handle(&mut self, event: &Event, aspect: f32) -> Option<Button> {
        if let Event::Pointer { x, y } = event {
            self.share = [*x, *y];
        }
        let still = self.pointer.still();
        self.pointer.handle(event, f64::from(aspect));
        match event {
            Event::Button { button, down: false, .. } => still.filter(|still| still == button),
            _ => None,
        }
    }

    /// Where the pointer is, in shares of the picture; nothing outside of it.
    pub fn at(&self) -> Option<[f32; 2]> {
        self.share.iter().all(|share| (0.0..1.0).contains(share)).then_some(self.share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn press(down: bool) -> Event {
        Event::Button { button: Button::Left, down, modifiers: Modifiers::default() }
    }

    fn to(x: f32, y: f32) -> Event {
        Event::Pointer { x, y }
    }

    fn run(events: &[Event]) -> Vec<Button> {
        let mut clicks = Clicks::default();
        events.iter().filter_map(|event| clicks.handle(event, 2.0)).collect()
    }

    #[test]
    fn a_press_that_stays_is_a_click_and_a_drag_is_not() {
        assert_eq!(run(&[to(0.5, 0.5), press(true), to(0.501, 0.501), press(false)]), [Button::Left]);
        assert_eq!(run(&[to(0.5, 0.5), press(true), to(0.6, 0.5), press(false)]), []);
        // There and back is a drag too.
        assert_eq!(run(&[to(0.5, 0.5), press(true), to(0.6, 0.5), to(0.5, 0.5), press(false)]), []);
        assert_eq!(run(&[to(0.5, 0.5), press(true), Event::Blur, press(false)]), []);
        assert_eq!(run(&[press(false)]), []);
    }

    #[test]
    fn outside_of_the_picture_nothing_is_under_the_pointer() {
        let mut clicks = Clicks::default();
        for (x, y, inside) in [(0.0, 0.0, true), (0.999, 0.5, true), (1.0, 0.5, false), (-0.1, 0.5, false)] {
            clicks.handle(&to(x, y), 1.0);
            assert_eq!(clicks.at().is_some(), inside);
        }
        clicks.handle(&to(f32::NAN, 0.5), 1.0);
        assert_eq!(clicks.at(), None);
    }
}
