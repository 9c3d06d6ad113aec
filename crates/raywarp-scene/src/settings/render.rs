//! How a scene wants to be rendered, where whoever renders it has no other wish.

use std::fmt;

use super::{AccelKind, Integrator, Quality, ToneMap, MAX_DEPTH, MAX_SIDE, MAX_SPP};
use crate::schema::{Described, Field, Kind, PanelRow, Parameter, Usual, Value};

/// What an option of rendering is about, and so which commands have it and what a change of it costs a viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The picture as a whole: its size and its samples.
    Picture,
    /// How light goes: a change starts the picture again.
    Shading,
    /// How radiance is shown: a change shows the same samples otherwise.
    Display,
    /// The structure that rays go through.
    Structure,
}

/// An option of rendering.
pub struct Setting {
    /// Its definition.
    pub parameter: Parameter<RenderDefaults>,
    /// What it is about.
    pub part: Part,
    /// What stands for the value in the help of the command line.
    pub placeholder: &'static str,
    /// Names that it has in other programs, with hyphens, and a value to show to who uses them.
    pub elsewhere: (&'static [&'static str], &'static str),
}

macro_rules! settings {
    ($(
        $part:ident $field:ident: $type:ty $(= $usual:expr)? $(, else $words:literal)?, $name:literal $(or $alias:literal)?,
        $placeholder:literal, $kind:expr, $panel:expr, $meaning:literal, $elsewhere:expr;
    )*) => {
        /// Defaults for the options of rendering: the `[render]` table of a scene file, or what a command line overrides.
        /// `None` leaves an option to the next one asked, in the end to raywarp.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct RenderDefaults {
            $(#[doc = concat!($meaning, ".")] pub $field: Option<$type>,)*
        }

        impl RenderDefaults {
            $($(
                #[doc = concat!($meaning, ": what is given, else raywarp's own default.")]
                pub fn $field(&self) -> $type {
                    self.$field.unwrap_or($usual)
                }
            )?)*
        }

        /// Every option of rendering, in the order of the help and of a saved file.
        pub const SETTINGS: &[Setting] = &[$(Setting {
            parameter: Parameter {
                name: $name,
                alias: settings!(@alias $($alias)?),
                kind: $kind,
                meaning: $meaning,
                default: settings!(@default $($usual)? $(, $words)?),
                panel: $panel,
                read: |settings| settings.$field.map(Field::value),
                write: |settings, value| settings.$field = Field::of(value).or(settings.$field),
            },
            part: Part::$part,
            placeholder: $placeholder,
            elsewhere: $elsewhere,
        }),*];
    };
    (@default $usual:expr) => { Usual::Value(|| Field::value($usual)) };
    (@default , $words:literal) => { Usual::Words($words) };
    (@alias) => { None };
    (@alias $alias:literal) => { Some($alias) };
}

settings! {
    Picture size: [u32; 2] = [1920, 1080], "size", "WxH", Kind::Size { high: MAX_SIDE }, None,
        "Size of the picture in pixels",
        (&["width", "height", "resolution", "res", "image-size", "dimensions"], "1920x1080");
    Picture spp: u32 = 4, "samples" or "spp", "N", Kind::Count { low: 1, high: MAX_SPP },
        Some(PanelRow::ranged("Samples a pixel", [1.0, 65536.0], 1.0)),
        "Samples a pixel",
        (&["sample", "samples-per-pixel", "aa", "antialias", "antialiasing", "num-samples"], "16");
    Shading integrator: Integrator = Integrator::Whitted, "integrator", "NAME", Kind::Words(&Integrator::NAMES),
        Some(PanelRow::new("Integrator")),
        "How light is followed: whitted (Phong's illumination, mirrors and glass), path (all light by all ways, \
         metallic-roughness materials)",
        (&["renderer", "render-mode", "engine", "pathtrace", "path-tracing"], "path");
    Shading max_depth: u32 = 5, "max_depth", "N", Kind::Count { low: 0, high: MAX_DEPTH },
        Some(PanelRow::ranged("Bounces", [0.0, MAX_DEPTH as f32], 1.0)),
        "Bounces, 0 to 16: mirrored and refracted rays in a row, with path rays scattered in any way; light is looked for at the \
         last one too",
        (&["bounces", "max-bounces", "depth", "recursion", "max-recursion", "ray-depth"], "8");
    Shading shadows: bool = true, "shadows", "",
        Kind::Flag {
            on: "Let lights cast shadows, as they do unless the scene file says otherwise",
            off: "Let every light reach everything",
        },
        Some(PanelRow::new("Shadows")),
        "Whether lights cast shadows",
        (&[], "");
    Shading seed: u32 = 0, "seed", "N", Kind::Count { low: 0, high: u32::MAX }, None,
        "Start of the random numbers that place the samples",
        (&["random-seed", "rng-seed"], "1");
    Display exposure: f32 = 0.0, "exposure", "EV", Kind::Number { low: -60.0, high: 60.0, unit: "stops" },
        Some(PanelRow::ranged("Exposure, stops", [-20.0, 20.0], 0.1)),
        "Brighten by EV stops, in PNG only: EXR holds the radiance itself",
        (&["ev", "brightness"], "1");
    Display tone_map: ToneMap = ToneMap::Clamp, "tone_map", "CURVE", Kind::Words(&ToneMap::NAMES),
        Some(PanelRow::new("Tone map")),
        "What PNG does with radiance above 1: clamp, filmic",
        (&["tonemap", "tone-mapping", "tonemapping", "gamma"], "filmic");
    Structure accel: AccelKind, else "the fastest on the device", "accel", "KIND", Kind::Words(&AccelKind::NAMES), None,
        "How to find hits: brute (every triangle), kd (the paper's k-d tree), or a hierarchy of boxes: bvh2, bvh, bvh8f (for CPUs)",
        (&["bvh", "structure", "accelerator", "acceleration"], "bvh2");
    Structure tree: Quality = Quality::Medium, "tree", "QUALITY", Kind::Words(&Quality::NAMES), None,
        "How good a hierarchy of boxes should be: fast (to build), medium, high (to trace)",
        (&["quality", "tree-quality", "build-quality"], "high");
}

impl Described for RenderDefaults {
    fn parameters() -> impl Iterator<Item = &'static Parameter<Self>> {
        SETTINGS.iter().map(|setting| &setting.parameter)
    }
}

impl RenderDefaults {
    /// Every option with raywarp's own default, where that is a value.
    pub fn usual() -> Self {
        let mut all = Self::default();
        for parameter in Self::parameters() {
            if let Some(value) = parameter.default() {
                parameter.set(&mut all, value);
            }
        }
        all
    }

    /// These, and where they are silent the `other` ones.
    pub fn or(&self, other: &Self) -> Self {
        let mut all = *other;
        for (parameter, value) in self.given() {
            parameter.set(&mut all, value);
        }
        all
    }

    /// What is said here and not the same in `before`.
    pub fn changed_from(&self, before: &Self) -> Self {
        let mut changed = Self::default();
        for (parameter, value) in self.given() {
            if !parameter.get(before).is_some_and(|same| value.is(same)) {
                parameter.set(&mut changed, value);
            }
        }
        changed
    }

    /// Only what is about some parts.
    pub fn only(&self, parts: &[Part]) -> Self {
        let mut some = Self::default();
        for setting in SETTINGS.iter().filter(|setting| parts.contains(&setting.part)) {
            if let Some(value) = setting.parameter.get(self) {
                setting.parameter.set(&mut some, value);
            }
        }
        some
    }

    /// What is said, in the order of the table.
    fn given(&self) -> impl Iterator<Item = (&'static Parameter<Self>, Value)> + '_ {
        Self::parameters().filter_map(|parameter| Some((parameter, parameter.get(self)?)))
    }
}

/// What is given, with commas, as the options of the command line name it: "size 640x480, samples 16".
impl fmt::Display for RenderDefaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let given = self.given().map(|(parameter, value)| format!("{} {value}", parameter.name.replace('_', " ")));
        f.write_str(&given.collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_override_counts_and_raywarp_fills_the_rest() {
        let first = RenderDefaults { spp: Some(4), shadows: Some(true), ..RenderDefaults::default() };
        let second = RenderDefaults { spp: Some(9), shadows: Some(false), seed: Some(3), ..RenderDefaults::default() };
        let both = first.or(&second);
        assert_eq!(both.to_string(), "samples 4, shadows on, seed 3");
        assert_eq!(both.changed_from(&second).to_string(), "samples 4, shadows on");
        assert_eq!(both.only(&[Part::Shading]).to_string(), "shadows on, seed 3");
        assert_eq!((both.spp(), both.max_depth(), RenderDefaults::default().spp()), (4, 5, 4));
        assert_eq!(RenderDefaults::default().to_string(), "");
    }

    #[test]
    fn words_are_those_of_their_types() {
        assert_eq!(Integrator::ALL.map(Integrator::name), Integrator::NAMES);
        assert_eq!(ToneMap::ALL.map(ToneMap::name), ToneMap::NAMES);
        assert_eq!(AccelKind::ALL.map(AccelKind::name), AccelKind::NAMES);
        assert_eq!(Quality::ALL.map(Quality::name), Quality::NAMES);
    }
}
