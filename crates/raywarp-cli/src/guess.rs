//! Flags of other programs, and which of raywarp's do what they do there.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};
use raywarp::scene::settings::SETTINGS;

use crate::options::Options;

/// The options of the command line; where they make no sense the error has a tip if a flag is known from elsewhere.
pub fn parse(mut words: Vec<OsString>) -> Result<Options, clap::Error> {
    if words.get(1).is_some_and(|word| is_scene(word)) {
        words.insert(1, "view".into());
    }
    Options::try_parse_from(&words).map_err(|error| with_tip(error, &words))
}

/// Whether a word in the place of a command is a scene to be viewed: a file that is there, or one with such a name.
fn is_scene(word: &OsStr) -> bool {
    if Options::command().find_subcommand(word).is_some() || word.to_string_lossy().starts_with('-') {
        return false;
    }
    let path = Path::new(word);
    path.is_file()
        || path.extension().is_some_and(|extension| SCENES.iter().any(|scene| extension.eq_ignore_ascii_case(scene)))
}

/// Extensions of scenes.
const SCENES: [&str; 6] = ["obj", "ply", "stl", "gltf", "glb", "toml"];

/// Flags as people guess them, and what to write instead, which begins with a flag of raywarp. Those for the options of
/// rendering are in the schema.
const GUESSES: [(&[&str], &str); 23] = [
    (&["look-at", "lookat", "at", "center", "centre", "look", "focus"], "--target 0,1,0"),
    (&["from", "position", "pos", "origin", "camera-position", "look-from", "cam-pos"], "--eye 3,2,5"),
    (&["cam", "camera-index"], "--camera NAME"),
    (&["up-axis", "up-direction", "camera-view-up", "z-up"], "--up +Z"),
    (&["fovy", "vfov", "angle", "field-of-view"], "--fov 40"),
    (&["orthographic", "parallel"], "--ortho 2.5"),
    (&["bg", "bg-color", "background-color", "background-colour", "sky"], "--background COLOUR"),
    (&["env", "environment", "env-map", "envmap", "hdr", "ibl", "skybox", "sky-map"], "--hdri FILE"),
    (&["transparent", "transparency", "no-background", "film-transparent"], "--background none"),
    (&["side", "direction", "camera-direction", "front", "top", "isometric"], "--view front"),
    (&["yaw", "heading", "camera-azimuth-angle", "theta"], "--azimuth 30"),
    (&["pitch", "altitude", "camera-elevation-angle", "phi"], "--elevation 20"),
    (&["zoom-factor", "camera-zoom-factor", "fit", "scale"], "--zoom 1.2"),
    (&["out", "outfile", "output-file", "save", "write"], "--output FILE"),
    (&["jobs", "num-threads", "cores", "nproc", "cpus"], "--threads 4"),
    (&["gpu", "cpu", "cuda", "backend"], "--device cuda"),
    (&["layers", "passes", "aovs", "channels"], "--aov depth,normal"),
    (&["region", "window", "roi"], "--crop 0,0,640,360"),
    (&["turntable", "spin", "rotate"], "--orbit"),
    (&["frame", "frame-range"], "--frames 1..240"),
    (&["force", "replace"], "--overwrite"),
    (&["listen", "bind", "address", "ip"], "--host 0.0.0.0"),
    (&["verbose", "timing", "timings", "statistics", "profile"], "--stats"),
];

/// All guesses.
fn guesses() -> impl Iterator<Item = (&'static [&'static str], String)> {
    let settings = SETTINGS.iter().map(|setting| {
        let (names, value) = setting.elsewhere;
        (names, format!("--{} {value}", setting.parameter.name.replace('_', "-")))
    });
    GUESSES.into_iter().map(|(names, instead)| (names, instead.to_owned())).chain(settings)
}

fn with_tip(mut error: clap::Error, words: &[OsString]) -> clap::Error {
    let tip = match (error.kind(), error.get(ContextKind::InvalidArg)) {
        (ErrorKind::UnknownArgument, Some(ContextValue::String(flag))) => tip(flag, words),
        _ => None,
    };
    if let Some(instead) = tip {
        // What looks alike means something else.
        error.remove(ContextKind::SuggestedArg);
        let tip = StyledStr::from(format!("that is '{instead}' here"));
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip]));
    }
    error
}

/// What to write instead of a flag, if the command has such.
fn tip(flag: &str, words: &[OsString]) -> Option<String> {
    let name = flag.trim_start_matches('-').split('=').next()?;
    let (_, instead) = guesses().find(|(names, _)| names.contains(&name))?;
    let known = instead.trim_start_matches('-').split(' ').next()?.to_owned();
    let commands = Options::command();
    let command = words.iter().skip(1).find_map(|word| commands.find_subcommand(word))?;
    let has_it = command.get_arguments().any(|argument| argument.get_long() == Some(&known));
    has_it.then_some(instead)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Command;

    fn said(words: &[&str]) -> String {
        parse(words.iter().map(OsString::from).collect()).unwrap_err().to_string()
    }

    #[test]
    fn guessed_flags_get_the_right_one_as_their_tip() {
        for (words, flag) in [
            (["raywarp", "render", "--width", "640"], "'--size 1920x1080'"),
            (["raywarp", "render", "--height=480", "a.obj"], "'--size 1920x1080'"),
            (["raywarp", "view", "--bounces", "3"], "'--max-depth 8'"),
            (["raywarp", "serve", "--look-at", "0,0,0"], "'--target 0,1,0'"),
            (["raywarp", "bench", "--jobs", "2"], "'--threads 4'"),
            (["raywarp", "render", "--gpu", "a.obj"], "'--device cuda'"),
            (["raywarp", "render", "--bg=white", "a.obj"], "'--background COLOUR'"),
            (["raywarp", "a.obj", "--up-axis", "z"], "'--up +Z'"),
            (["raywarp", "view", "--pitch", "20"], "'--elevation 20'"),
        ] {
            let said = said(&words);
            assert!(said.contains("unexpected argument") && said.contains(flag), "{said}");
            assert!(!said.contains("a similar argument"), "{said}");
        }
        assert!(said(&["raywarp", "info", "--width", "3"]).contains("unexpected argument '--width'"));
        assert!(!said(&["raywarp", "info", "--width", "3"]).contains("--size"));
    }

    #[test]
    fn a_scene_without_a_command_is_viewed() {
        let scene = |words: &[&str]| match parse(words.iter().map(OsString::from).collect()).unwrap().command {
            Some(Command::View(options)) => options.scene,
            _ => None,
        };
        assert_eq!(scene(&["raywarp", "missing.GLB"]), Some("missing.GLB".into()));
        assert_eq!(scene(&["raywarp", "model.obj", "--watch", "--view", "front"]), Some("model.obj".into()));
        let file = tempfile::NamedTempFile::new().unwrap();
        let path = file.path().to_str().unwrap();
        assert_eq!(scene(&["raywarp", path]), Some(path.into()));
        assert!(said(&["raywarp", "rendr"]).contains("unrecognized subcommand"));
        assert_eq!(scene(&["raywarp", "render", "model.obj"]), None);
    }

    #[test]
    fn no_guess_is_a_flag_itself_and_every_tip_is_one() {
        let commands = Options::command();
        let flags: Vec<_> = commands.get_subcommands().flat_map(|command| command.get_arguments()).collect();
        let is_flag = |name: &str| flags.iter().any(|flag| flag.get_long() == Some(name));
        for (names, instead) in guesses() {
            let flag = instead.trim_start_matches('-').split(' ').next().unwrap();
            assert!(is_flag(flag), "{instead}");
            let render = commands.find_subcommand("render").unwrap();
            let taken = names.iter().find(|guess| render.get_arguments().any(|flag| flag.get_long() == Some(guess)));
            assert_eq!(taken, None);
        }
    }
}
