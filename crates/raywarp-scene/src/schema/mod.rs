//! What can be set, defined once: the options of rendering ([`SETTINGS`](crate::settings::SETTINGS)), a material's
//! parameters and a light's.
//!
//! A [`Parameter`] says how a value is called, what it may be, what it means, and where it is kept. The command line, the
//! scene file, saving, the viewer's panel and the tables of `docs/scene-file.md` are made from these definitions.
//!
//! ```
//! use raywarp_scene::schema::{Described, Value};
//! use raywarp_scene::Material;
//!
//! let mut material = Material::default();
//! let ior = Material::parameter("ior").unwrap();
//! ior.set(&mut material, Value::Number(1.5));
//! assert_eq!((material.ior, ior.get(&material)), (1.5, Some(Value::Number(1.5))));
//! ```

mod documentation;
mod kind;
mod value;

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

pub use documentation::row;
pub use kind::{Kind, LARGEST};
pub use value::{Field, Value};

/// One thing of a `T` that can be set. Two are the same if they have the same name.
pub struct Parameter<T: 'static> {
    /// The key in a scene file; an option of the command line has it with hyphens.
    pub name: &'static str,
    /// Another name that is read as well.
    pub alias: Option<&'static str>,
    /// What it may be.
    pub kind: Kind,
    /// What it means, in one sentence.
    pub meaning: &'static str,
    /// What it is where nobody says anything; in words where that depends on others.
    pub default: Usual,
    /// Its row in a viewer's panel; none: it is not there.
    pub panel: Option<PanelRow>,
    /// See [`get`](Self::get).
    pub read: fn(&T) -> Option<Value>,
    /// See [`set`](Self::set).
    pub write: fn(&mut T, Value),
}

/// What a parameter is where nobody says anything.
#[derive(Clone, Copy)]
pub enum Usual {
    /// This value.
    Value(fn() -> Value),
    /// What these words say.
    Words(&'static str),
}

/// How a viewer's panel shows a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelRow {
    /// For people.
    pub label: &'static str,
    /// Usual least and largest value of a number or of a channel; a scene may have others.
    pub range: [f32; 2],
    /// Between neighbours on a slider; 0 is any.
    pub step: f32,
}

impl PanelRow {
    /// A row of a value that has no range.
    pub const fn new(label: &'static str) -> Self {
        Self::ranged(label, [0.0, 1.0], 0.0)
    }

    /// A row of a number or a colour.
    pub const fn ranged(label: &'static str, range: [f32; 2], step: f32) -> Self {
        Self { label, range, step }
    }
}

impl<T> Parameter<T> {
    /// The value; nothing where this `T` has no such, or says nothing of it.
    pub fn get(&self, of: &T) -> Option<Value> {
        (self.read)(of)
    }

    /// Gives the value. Nothing changes where this `T` has no such, or where the value is of another type.
    pub fn set(&self, of: &mut T, value: Value) {
        (self.write)(of, value);
    }

    /// The default, where it is a value.
    pub fn default(&self) -> Option<Value> {
        match self.default {
            Usual::Value(value) => Some(value()),
            Usual::Words(_) => None,
        }
    }

    /// Whether this is what is called so.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name || self.alias == Some(name)
    }
}

/// What has parameters.
pub trait Described: Sized + 'static {
    /// All of them, in the order of a saved file.
    fn parameters() -> impl Iterator<Item = &'static Parameter<Self>>;

    /// The one of a name.
    fn parameter(name: &str) -> Option<&'static Parameter<Self>> {
        Self::parameters().find(|parameter| parameter.is_called(name))
    }
}

impl<T> PartialEq for Parameter<T> {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl<T> Eq for Parameter<T> {}

impl<T> PartialOrd for Parameter<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Parameter<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.name.cmp(other.name)
    }
}

impl<T> Hash for Parameter<T> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

impl<T> fmt::Debug for Parameter<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Light, LightKind, Material, RenderDefaults};

    /// A value is what was set, and every name is there once.
    fn leads_back<T: Described + Clone>(start: &T) {
        for (index, parameter) in T::parameters().enumerate() {
            assert!(T::parameters().take(index).all(|other| other != parameter), "{parameter:?} twice");
            let Some(value) = parameter.get(start).or(parameter.default()) else { continue };
            let mut changed = start.clone();
            parameter.set(&mut changed, value);
            if parameter.name != "cutoff" {
                assert_eq!(parameter.get(&changed), Some(value), "{parameter:?}");
            }
            assert!(parameter.kind.takes(value), "{parameter:?}: {value}");
        }
    }

    #[test]
    fn what_is_set_is_read_and_every_default_is_in_its_range() {
        leads_back(&RenderDefaults::default());
        leads_back(&Material::default());
        let spot = LightKind::Spot { position: [0.0; 3], direction: [1.0; 3], inner: 0.25, outer: 0.5 };
        leads_back(&Light { kind: spot, range: 3.0, ..Light::default() });
    }

    #[test]
    fn what_a_light_or_a_surface_has_not_cannot_be_set() {
        let sun = Light::default();
        let mut changed = sun.clone();
        for name in ["position", "outer", "attenuation"] {
            let parameter = Light::parameter(name).unwrap();
            parameter.set(&mut changed, Value::Triple([1.0, 2.0, 3.0]));
            assert_eq!((parameter.get(&changed), &changed), (None, &sun), "{name}");
        }
        let (mut material, cutoff) = (Material::default(), Material::parameter("cutoff").unwrap());
        cutoff.set(&mut material, Value::Number(0.25));
        assert_eq!((cutoff.get(&material), material), (None, Material::default()));
    }
}
