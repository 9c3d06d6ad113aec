//! The options of rendering, made from their definitions in the schema.

use std::ffi::OsStr;
use std::marker::PhantomData;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use raywarp::scene::schema::{Described, Kind, Usual, Value};
use raywarp::scene::settings::{Part, Setting, SETTINGS};
use raywarp::scene::RenderDefaults;

use crate::values;

/// Size and samples of a picture.
pub type PictureSettings = Settings<Picture>;
/// How light goes and how it is shown: options of every command that makes pictures.
pub type LightSettings = Settings<Light>;
/// The structure that rays go through: options of every command that traces a scene.
pub type StructureSettings = Settings<Structure>;

/// Options about some parts of rendering.
#[derive(Clone, Debug)]
pub struct Settings<P> {
    /// What was asked for.
    pub values: RenderDefaults,
    parts: PhantomData<P>,
}

/// Which options a command has.
pub trait Parts {
    /// Those about these parts.
    const PARTS: &'static [Part];
    /// Their heading in the help.
    const HEADING: &'static str;
}

/// See [`PictureSettings`].
#[derive(Clone, Debug)]
pub struct Picture;

/// See [`LightSettings`].
#[derive(Clone, Debug)]
pub struct Light;

/// See [`StructureSettings`].
#[derive(Clone, Debug)]
pub struct Structure;

impl Parts for Picture {
    const PARTS: &'static [Part] = &[Part::Picture];
    const HEADING: &'static str = "Picture";
}

impl Parts for Light {
    const PARTS: &'static [Part] = &[Part::Shading, Part::Display];
    const HEADING: &'static str = "Picture";
}

impl Parts for Structure {
    const PARTS: &'static [Part] = &[Part::Structure];
    const HEADING: &'static str = "Machine";
}

fn settings<P: Parts>() -> impl Iterator<Item = &'static Setting> {
    SETTINGS.iter().filter(|setting| P::PARTS.contains(&setting.part))
}

impl<P: Parts> Args for Settings<P> {
    fn augment_args(command: Command) -> Command {
        let arguments = settings::<P>().flat_map(arguments).map(|argument| argument.help_heading(P::HEADING));
        command.args(arguments)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<P: Parts> FromArgMatches for Settings<P> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut settings = Self { values: RenderDefaults::default(), parts: PhantomData };
        settings.update_from_arg_matches(matches)?;
        Ok(settings)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        for setting in settings::<P>() {
            if let Some(value) = asked(setting, matches) {
                setting.parameter.set(&mut self.values, value);
            }
        }
        Ok(())
    }
}

fn asked(setting: &Setting, matches: &ArgMatches) -> Option<Value> {
    let name = setting.parameter.name;
    match setting.parameter.kind {
        Kind::Flag { .. } if matches.get_flag(&negative(name)) => Some(Value::Flag(false)),
        Kind::Flag { .. } => matches.get_flag(name).then_some(Value::Flag(true)),
        _ => matches.get_one(name).copied(),
    }
}

fn negative(name: &str) -> String {
    format!("no_{name}")
}

/// The option, or for yes and no two that take each other back.
fn arguments(setting: &'static Setting) -> Vec<Arg> {
    let parameter = &setting.parameter;
    let argument = |id: String| Arg::new(id.clone()).long(id.replace('_', "-"));
    if let Kind::Flag { on, off } = parameter.kind {
        let flag = |id: String, other: String, help: &'static str| {
            argument(id).action(ArgAction::SetTrue).overrides_with(other).help(help)
        };
        let (yes, no) = (parameter.name.to_owned(), negative(parameter.name));
        return vec![flag(no.clone(), yes.clone(), off), flag(yes, no, on)];
    }
    let help = format!("{} [default: the scene file's, else {}]", parameter.meaning, usual(setting));
    let argument = argument(parameter.name.to_owned()).help(help).value_name(setting.placeholder);
    let signed = matches!(parameter.kind, Kind::Number { low, .. } if low < 0.0);
    let argument = argument.value_parser(ValueParser(parameter.kind)).allow_hyphen_values(signed);
    vec![argument.visible_aliases(parameter.alias).hide_possible_values(true)]
}

fn usual(setting: &Setting) -> String {
    match setting.parameter.default {
        Usual::Words(words) => words.to_owned(),
        Usual::Value(value) => value().to_string(),
    }
}

/// The options that ask for some values, to the bit.
pub fn flags(values: &RenderDefaults) -> String {
    let given = RenderDefaults::parameters().filter_map(|parameter| Some((parameter, parameter.get(values)?)));
    let flags = given.map(|(parameter, value)| {
        let name = parameter.name.replace('_', "-");
        match value {
            Value::Flag(true) => format!("--{name}"),
            Value::Flag(false) => format!("--no-{name}"),
            // A number may begin with a minus.
            Value::Number(_) => format!("--{name}={value}"),
            value => format!("--{name} {value}"),
        }
    });
    flags.collect::<Vec<_>>().join(" ")
}

/// Reads a value of a kind.
#[derive(Clone)]
struct ValueParser(Kind);

impl TypedValueParser for ValueParser {
    type Value = Value;

    fn parse_ref(&self, command: &Command, argument: Option<&Arg>, value: &OsStr) -> Result<Value, clap::Error> {
        let kind = self.0;
        let parse = move |text: &str| values::value(kind, text);
        parse.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        match self.0 {
            Kind::Words(words) => Some(Box::new(words.iter().map(PossibleValue::new))),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};
    use raywarp::image::Development;
    use raywarp::render;

    use super::flags;
    use crate::options::RenderOptions;

    #[test]
    fn defaults_in_the_help_are_those_of_the_library() {
        let command = RenderOptions::command();
        let help = |name: &str| {
            let argument = command.get_arguments().find(|argument| argument.get_id() == name).unwrap();
            argument.get_help().unwrap().to_string()
        };
        let (usual, development) = (render::RenderOptions::default(), Development::default());
        for (option, default) in [
            ("samples", usual.spp.to_string()),
            ("max_depth", usual.max_depth.to_string()),
            ("seed", usual.seed.to_string()),
            ("exposure", development.exposure.to_string()),
            ("tone_map", development.tone_map.to_string()),
            ("tree", raywarp::accel::Quality::default().to_string()),
        ] {
            assert!(help(option).ends_with(&format!("[default: the scene file's, else {default}]")), "{option}");
        }
    }

    #[test]
    fn every_option_is_read_and_the_last_of_two_flags_counts() {
        let words =
            "render --size 64x48 --spp 3 --max-depth 0 --no-shadows --seed 7 --exposure -1.5 --tone-map filmic \
                     --accel kd --tree high";
        let asked = RenderOptions::try_parse_from(words.split_whitespace()).unwrap().overrides();
        assert_eq!(
            asked.to_string(),
            "size 64x48, samples 3, max depth 0, shadows off, seed 7, exposure -1.5, tone map filmic, accel kd, tree high"
        );
        let again = RenderOptions::try_parse_from(format!("render {}", flags(&asked)).split_whitespace()).unwrap();
        assert_eq!(again.overrides(), asked);
        let both = RenderOptions::try_parse_from(["render", "--no-shadows", "--shadows"]).unwrap();
        assert_eq!(both.overrides().shadows, Some(true));
    }
}
