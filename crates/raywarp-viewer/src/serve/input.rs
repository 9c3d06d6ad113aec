//! Which events of clients are taken.

use crate::live::{Event, Value};

/// Longest texts, in bytes: names of keys and controls, and values.
const NAME: usize = 256;
const TEXT: usize = 4096;
/// Farthest a pointer goes, in pictures, and most notches of a wheel at once.
const FAR: f32 = 16.0;
const NOTCHES: f32 = 100.0;

/// The event with its numbers within bounds.
///
/// # Errors
/// What is wrong about it, where a number is not finite or a text too long.
pub fn checked(mut event: Event) -> Result<Event, &'static str> {
    match &mut event {
        Event::Pointer { x, y } => {
            bound(x, FAR)?;
            bound(y, FAR)?;
        }
        Event::Wheel { notches } => bound(notches, NOTCHES)?,
        Event::Key { key: name, .. } | Event::Reset { id: name } => short(name, NAME)?,
        Event::Set { id, value } => {
            short(id, NAME)?;
            check_value(value)?;
        }
        Event::Button { .. } | Event::Blur | Event::Resize { .. } => {}
    }
    Ok(event)
}

fn check_value(value: &Value) -> Result<(), &'static str> {
    match value {
        Value::Flag(_) => Ok(()),
        Value::Number(number) => finite(*number),
        Value::Triple(numbers) => numbers.iter().try_for_each(|&number| finite(number)),
        Value::Text(text) => short(text, TEXT),
    }
}

fn bound(value: &mut f32, most: f32) -> Result<(), &'static str> {
    finite(*value)?;
    *value = value.clamp(-most, most);
    Ok(())
}

fn finite(value: f32) -> Result<(), &'static str> {
    value.is_finite().then_some(()).ok_or("a number of an event is not finite")
}

fn short(text: &str, most: usize) -> Result<(), &'static str> {
    (text.len() <= most).then_some(()).ok_or("a text of an event is too long")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Event, &'static str> {
        checked(serde_json::from_str(text).unwrap())
    }

    #[test]
    fn numbers_are_finite_and_within_bounds() {
        assert_eq!(read(r#"{"kind": "pointer", "x": -1e30, "y": 0.5}"#), Ok(Event::Pointer { x: -FAR, y: 0.5 }));
        assert_eq!(read(r#"{"kind": "wheel", "notches": 1e9}"#), Ok(Event::Wheel { notches: NOTCHES }));
        for text in [
            r#"{"kind": "pointer", "x": 1e300, "y": 0}"#,
            r#"{"kind": "wheel", "notches": -1e300}"#,
            r#"{"kind": "set", "id": "a", "value": 1e300}"#,
            r#"{"kind": "set", "id": "a", "value": [0, 0, 1e300]}"#,
        ] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn texts_are_short() {
        assert!(read(r#"{"kind": "key", "key": "ArrowUp", "down": true}"#).is_ok());
        for (event, most) in [
            (r#"{"kind": "key", "key": "X", "down": true}"#, NAME),
            (r#"{"kind": "reset", "id": "X"}"#, NAME),
            (r#"{"kind": "set", "id": "X", "value": true}"#, NAME),
            (r#"{"kind": "set", "id": "a", "value": "X"}"#, TEXT),
        ] {
            assert!(read(&event.replace('X', &"x".repeat(most))).is_ok(), "{event}");
            assert!(read(&event.replace('X', &"x".repeat(most + 1))).is_err(), "{event}");
        }
    }
}
