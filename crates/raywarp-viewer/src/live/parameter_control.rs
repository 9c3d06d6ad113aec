//! The schema's parameters as controls of the panel.

use raywarp::scene::schema::{self, Kind, PanelRow, Parameter};

use super::{Control, Value};

/// How a parameter can be changed. Its range is the usual one, and wide enough for `values` that the scene has.
pub(super) fn control<T>(parameter: &Parameter<T>, row: &PanelRow, values: &[&Value]) -> Control {
    let [low, high] = values.iter().fold(row.range, |[low, high], value| {
        let [least, largest] = range(value);
        [low.min(least), high.max(largest)]
    });
    match parameter.kind {
        Kind::Flag { .. } => Control::Flag,
        Kind::Count { .. } | Kind::Number { .. } | Kind::Positive | Kind::Angle => {
            Control::Number { min: low, max: high, step: row.step }
        }
        Kind::Color | Kind::Share => Control::Color { max: high },
        Kind::Vector | Kind::Terms => Control::Vector { step: row.step },
        Kind::Words(words) => Control::Choice { options: words.iter().map(|&word| word.to_owned()).collect() },
        Kind::Size { .. } => Control::Text,
    }
}

/// The least and the largest number in a value.
pub(super) fn range(value: &Value) -> [f32; 2] {
    let numbers = match value {
        Value::Number(x) => std::slice::from_ref(x),
        Value::Triple(v) => v.as_slice(),
        _ => &[],
    };
    numbers.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
}

/// A value for the panel.
pub(super) fn shown(value: schema::Value) -> Value {
    match value {
        schema::Value::Flag(on) => Value::Flag(on),
        schema::Value::Count(count) => Value::Number(count as f32),
        schema::Value::Number(number) => Value::Number(number),
        schema::Value::Triple(triple) => Value::Triple(triple),
        schema::Value::Word(_) | schema::Value::Size(_) => Value::Text(value.to_string()),
    }
}

/// A value of the panel for a parameter, if it can be one.
pub(super) fn taken(kind: Kind, value: &Value) -> Option<schema::Value> {
    match (kind, value) {
        (Kind::Flag { .. }, Value::Flag(on)) => Some(schema::Value::Flag(*on)),
        (Kind::Count { .. }, Value::Number(number)) => Some(schema::Value::Count(number.round() as u32)),
        (Kind::Number { .. } | Kind::Positive | Kind::Angle, Value::Number(x)) => Some(schema::Value::Number(*x)),
        (Kind::Color | Kind::Share | Kind::Vector | Kind::Terms, Value::Triple(v)) => Some(schema::Value::Triple(*v)),
        (Kind::Words(words), Value::Text(text)) => {
            words.iter().find(|word| *word == text).map(|word| schema::Value::Word(word))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use raywarp::scene::schema::Described;
    use raywarp::scene::{Light, Material, RenderDefaults};

    use super::*;
    use crate::live::control_value::check;

    /// What the panel shows of a parameter can be sent back, and is the same then.
    fn comes_back<T: Described>(of: &T) {
        for parameter in T::parameters() {
            let (Some(row), Some(value)) = (&parameter.panel, parameter.get(of).or(parameter.default())) else {
                continue;
            };
            let value_shown = shown(value);
            assert_eq!(check(&control(parameter, row, &[&value_shown]), &value_shown), Ok(()), "{parameter:?}");
            assert_eq!(taken(parameter.kind, &value_shown), Some(value), "{parameter:?}");
        }
    }

    #[test]
    fn what_the_panel_shows_can_be_sent_back() {
        comes_back(&RenderDefaults::default());
        comes_back(&Material { emission: [1e6; 3], ior: 0.5, ..Material::default() });
        comes_back(&Light { color: [20.0, 0.0, 1.0], ..Light::default() });
    }
}
