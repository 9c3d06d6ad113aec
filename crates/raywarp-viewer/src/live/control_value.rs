//! What a control takes: a browser may send anything.

use super::{Control, Value};

/// Largest coordinate that people may give, as in a scene file.
const FARTHEST: f32 = 1e12;

/// Whether a control takes a value, with the reason if not, as the end of a sentence.
///
/// # Errors
/// A phrase such as "needs a number from 0 to 1".
pub(super) fn check(control: &Control, value: &Value) -> Result<(), String> {
    let fits = match (control, value) {
        (Control::Action, _) | (Control::Flag, Value::Flag(_)) => true,
        (Control::Number { min, max, .. }, Value::Number(x)) => (*min..=*max).contains(x),
        (Control::Choice { options }, Value::Text(text)) => options.contains(text),
        (Control::Color { max }, Value::Triple(channels)) => channels.iter().all(|x| (0.0..=*max).contains(x)),
        (Control::Vector { .. }, Value::Triple(v)) => v.iter().all(|x| (-FARTHEST..=FARTHEST).contains(x)),
        _ => false,
    };
    if fits {
        return Ok(());
    }
    Err(match control {
        Control::Text => "cannot be changed".to_owned(),
        Control::Action | Control::Flag => "needs true or false".to_owned(),
        Control::Number { min, max, .. } => format!("needs a number from {min} to {max}"),
        Control::Choice { options } => format!("is one of {}", options.join(", ")),
        Control::Color { max } => format!("needs red, green and blue from 0 to {max}"),
        Control::Vector { .. } => "needs three numbers of at most 1e12 in size".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_values_of_the_kind_and_within_the_range_are_taken() {
        let number = Control::Number { min: 0.0, max: 1.0, step: 0.0 };
        let (color, vector) = (Control::Color { max: 2.0 }, Control::Vector { step: 1.0 });
        let choice = Control::Choice { options: vec!["a".into()] };
        for (control, value) in [
            (&number, Value::Number(0.5)),
            (&color, Value::Triple([0.0, 1.0, 2.0])),
            (&vector, Value::Triple([-5.0, 1e11, 0.0])),
            (&choice, Value::Text("a".into())),
            (&Control::Flag, Value::Flag(true)),
            (&Control::Action, Value::Number(f32::NAN)),
        ] {
            assert_eq!(check(control, &value), Ok(()));
        }
        for (control, value) in [
            (&number, Value::Number(f32::NAN)),
            (&number, Value::Number(1.5)),
            (&number, Value::Flag(true)),
            (&color, Value::Triple([0.0, -0.1, 0.0])),
            (&color, Value::Triple([f32::INFINITY; 3])),
            (&vector, Value::Triple([f32::NAN; 3])),
            (&vector, Value::Triple([1e13; 3])),
            (&choice, Value::Text("b".into())),
            (&Control::Flag, Value::Text("true".into())),
            (&Control::Text, Value::Text("x".into())),
        ] {
            assert!(check(control, &value).is_err(), "{control:?} {value:?}");
        }
    }
}
