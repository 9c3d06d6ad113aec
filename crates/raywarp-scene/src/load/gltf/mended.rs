//! JSON that is valid glTF and that the `gltf` crate refuses, rewritten as the same glTF that it reads.
//!
//! The crate reads a file by serde's derived readers, which are stricter than JSON and glTF:
//! - an integer may be written as a float (`4.0`): whole numbers lose their point here;
//! - of a key that an object has twice the last counts, as in the Khronos validator;
//! - a scene need not have nodes;
//! - the target of an animation channel need not be a node, be it one of KHR_animation_pointer: such a channel is
//!   ignored, and it is taken out here.
//!
//! It is done only where the crate refuses the text as it stands, whose errors have a place.

use ::gltf::json::deserialize::{from_slice, from_value};
use ::gltf::json::{Error, Value};
use serde::de::DeserializeOwned;

/// Reads some JSON, as it stands or mended; the error is that of the text as it stands.
pub(super) fn parse<T: DeserializeOwned>(text: &[u8]) -> Result<T, Error> {
    from_slice(text).or_else(|error| mended(text).ok_or(error))
}

fn mended<T: DeserializeOwned>(text: &[u8]) -> Option<T> {
    // Of a key given twice, a map of values keeps the last.
    let mut root: Value = from_slice(text).ok()?;
    write_whole_numbers(&mut root);
    for scene in items(&mut root, "scenes") {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
        }
    }
    for animation in items(&mut root, "animations") {
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            channels.retain(has_node);
        }
    }
    from_value(root).ok()
}

fn items<'a>(root: &'a mut Value, list: &str) -> impl Iterator<Item = &'a mut Value> {
    root.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten()
}

fn has_node(channel: &Value) -> bool {
    channel.get("target").is_some_and(|target| target.get("node").is_some())
}

/// `4.0` to `4`, everywhere: where the crate expects a float it takes an integer as well.
fn write_whole_numbers(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() => {
            if let Some(whole) = number.as_f64().and_then(whole) {
                *value = Value::from(whole);
            }
        }
        Value::Array(values) => values.iter_mut().for_each(write_whole_numbers),
        Value::Object(values) => values.values_mut().for_each(write_whole_numbers),
        Value::Null | Value::Bool(_) | Value::String(_) | Value::Number(_) => {}
    }
}

/// The integer that a float stands for, if it is one beyond doubt: below 2^53 no two are the same float. Negative zero
/// stays what it is.
fn whole(value: f64) -> Option<i64> {
    let certain = value.fract() == 0.0 && value.abs() < 9_007_199_254_740_992.0;
    (certain && value.to_bits() != (-0.0f64).to_bits()).then_some(value as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::gltf::json::Root;

    #[test]
    fn floats_become_integers_only_where_they_are_whole() {
        let values: Vec<f64> = parse(b"[4.0, 0.5, -0.0, 1e300]").unwrap();
        assert_eq!(values, [4.0, 0.5, 0.0, 1e300]);
        assert_eq!(parse::<Vec<u32>>(b"[4.0, 2e3, 7]").unwrap(), [4, 2000, 7]);
        assert!(parse::<Vec<u32>>(b"[4.5]").is_err());
    }

    #[test]
    fn the_error_is_that_of_the_text() {
        let error = parse::<Root>(b"{\"asset\":\n{\"version\":\"2.0\"},\"scenes\":[{}],\"meshes\":[{}]}").unwrap_err();
        assert_eq!((error.line(), error.to_string().contains("missing field `nodes`")), (2, true));
    }
}
