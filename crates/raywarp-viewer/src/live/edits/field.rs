//! What can be edited, by the names that rows have: "light.0.color", "material.3.diffuse", "instance.2.translate",
//! "background.zenith".

use std::fmt;

use raywarp::scene::schema::{Described, Parameter};
use raywarp::scene::{Light, Material};

/// One value of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Field {
    Light(usize, LightField),
    Material(usize, &'static Parameter<Material>),
    Instance(usize, InstanceField),
    Background(BackgroundField),
}

macro_rules! fields {
    ($name:ident { $($field:ident => $word:literal,)* }) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub(super) enum $name { $($field),* }

        impl $name {
            pub const ALL: &[Self] = &[$(Self::$field),*];

            pub const fn word(self) -> &'static str {
                match self { $(Self::$field => $word),* }
            }

            fn named(word: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|field| field.word() == word)
            }
        }
    };
}

/// A value of a light: one of its parameters, or what the panel makes of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum LightField {
    There,
    On,
    /// The largest channel of its colour.
    Intensity,
    Of(&'static Parameter<Light>),
}

impl LightField {
    /// All that a light may have, in the order of the panel; the intensity comes after the colour that it multiplies.
    pub fn all() -> impl Iterator<Item = Self> {
        let intensity = |parameter: &Parameter<Light>| (parameter.name == COLOR).then_some(Self::Intensity);
        let parameters = on_panel::<Light>()
            .flat_map(move |parameter| std::iter::once(Self::Of(parameter)).chain(intensity(parameter)));
        [Self::There, Self::On].into_iter().chain(parameters)
    }

    /// Whether it is the parameter of this name.
    pub fn is(self, name: &str) -> bool {
        matches!(self, Self::Of(parameter) if parameter.name == name)
    }

    pub const fn word(self) -> &'static str {
        match self {
            Self::There => "there",
            Self::On => "on",
            Self::Intensity => "intensity",
            Self::Of(parameter) => parameter.name,
        }
    }

    fn named(word: &str) -> Option<Self> {
        Self::all().find(|field| field.word() == word)
    }
}

/// The parameter of a light that the panel shows in two rows.
pub(super) const COLOR: &str = "color";

/// The parameters that the panel shows.
pub(super) fn on_panel<T: Described>() -> impl Iterator<Item = &'static Parameter<T>> {
    T::parameters().filter(|parameter| parameter.panel.is_some())
}

fields!(InstanceField {
    Translate => "translate",
    Rotate => "rotate",
    Scale => "scale",
});

fields!(BackgroundField {
    Zenith => "zenith",
    Horizon => "horizon",
    Ground => "ground",
    Ambient => "ambient",
});

impl Field {
    /// Of a row; nothing for the rows of others.
    pub fn of(id: &str) -> Option<Self> {
        let mut words = id.split('.');
        let kind = words.next()?;
        let (index, word) = match kind {
            "background" => (0, words.next()?),
            _ => (words.next()?.parse().ok()?, words.next()?),
        };
        let field = match kind {
            "light" => Self::Light(index, LightField::named(word)?),
            "material" => Self::Material(index, on_panel().find(|parameter| parameter.name == word)?),
            "instance" => Self::Instance(index, InstanceField::named(word)?),
            "background" => Self::Background(BackgroundField::named(word)?),
            _ => return None,
        };
        // Only the one way to write it: no "light.+1.color".
        (words.next().is_none() && field.to_string() == id).then_some(field)
    }

    /// Whether it belongs to a section: "light.0", "material.3", "lights", "background".
    pub fn is_within(self, section: &str) -> bool {
        section == "lights" && matches!(self, Self::Light(..))
            || self.to_string().strip_prefix(section).is_some_and(|rest| rest.starts_with('.'))
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Light(index, field) => write!(f, "light.{index}.{}", field.word()),
            Self::Material(index, parameter) => write!(f, "material.{index}.{}", parameter.name),
            Self::Instance(index, field) => write!(f, "instance.{index}.{}", field.word()),
            Self::Background(field) => write!(f, "background.{}", field.word()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_and_others_lead_nowhere() {
        for field in LightField::all() {
            assert_eq!(Field::of(&Field::Light(7, field).to_string()), Some(Field::Light(7, field)));
        }
        let field = Field::Background(BackgroundField::Ambient);
        assert_eq!(Field::of("background.ambient"), Some(field));
        for id in ["", "light", "light.0", "light.x.color", "light.+1.color", "light.0.color.0", "sun.0.color"] {
            assert_eq!(Field::of(id), None, "{id}");
        }
        assert!(field.is_within("background") && !field.is_within("back") && !field.is_within("lights"));
        let light = Field::Light(1, LightField::On);
        assert!(light.is_within("lights") && light.is_within("light.1") && !light.is_within("light.10"));
    }
}
