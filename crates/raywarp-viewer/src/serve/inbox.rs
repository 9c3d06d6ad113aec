//! Input on its way to the render thread.

use crate::live::Event;

/// Most events that wait; pointer moves, wheel and sizes that follow each other count as one.
const CAPACITY: usize = 256;

/// Events since the render thread last looked.
#[derive(Debug, Default)]
pub struct Inbox {
    events: Vec<Event>,
    mark: Option<u32>,
}

/// What the render thread takes.
#[derive(Debug, Default, PartialEq)]
pub struct Taken {
    /// In order.
    pub events: Vec<Event>,
    /// The latest mark.
    pub mark: Option<u32>,
}

impl Inbox {
    pub fn is_full(&self) -> bool {
        self.events.len() >= CAPACITY
    }

    /// Adds an event; one that says all that the last one said takes its place.
    pub fn push(&mut self, event: Event) {
        match (self.events.last_mut(), event) {
            (Some(last @ Event::Pointer { .. }), event @ Event::Pointer { .. })
            | (Some(last @ Event::Resize { .. }), event @ Event::Resize { .. }) => *last = event,
            (Some(Event::Wheel { notches }), Event::Wheel { notches: more }) => *notches += more,
            (_, event) => self.events.push(event),
        }
    }

    pub fn mark(&mut self, mark: u32) {
        self.mark = Some(mark);
    }

    pub fn take(&mut self) -> Taken {
        Taken { events: std::mem::take(&mut self.events), mark: self.mark.take() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::{Button, Modifiers};

    fn pointer(x: f32) -> Event {
        Event::Pointer { x, y: 0.5 }
    }

    #[test]
    fn moves_are_joined_and_clicks_stay_between_them() {
        let mut inbox = Inbox::default();
        let click = Event::Button { button: Button::Left, down: true, modifiers: Modifiers::default() };
        for event in [pointer(0.1), pointer(0.2), click.clone(), pointer(0.3), pointer(0.4)] {
            inbox.push(event);
        }
        for notches in [1.0, 2.0, -0.5] {
            inbox.push(Event::Wheel { notches });
        }
        inbox.mark(3);
        inbox.mark(4);
        let taken = inbox.take();
        assert_eq!(taken.events, [pointer(0.2), click, pointer(0.4), Event::Wheel { notches: 2.5 }]);
        assert_eq!((taken.mark, inbox.take()), (Some(4), Taken::default()));
    }

    #[test]
    fn it_fills_up() {
        let mut inbox = Inbox::default();
        for _ in 0..CAPACITY {
            assert!(!inbox.is_full());
            inbox.push(Event::Blur);
        }
        assert!(inbox.is_full());
        inbox.take();
        assert!(!inbox.is_full());
    }
}
