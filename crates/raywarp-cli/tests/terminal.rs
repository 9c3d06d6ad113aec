//! What files are called, and what is called something in them, never gives orders to the terminal.
#![cfg(target_os = "linux")]

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;

use crate::common::{Place, Run, SCENE};

/// Clears the screen, sets a title, the same by one character, and turns text around.
const ORDERS: &str = "\u{1b}[2J\u{1b}]0;x\u{7}\u{9b}31m\u{202e}";

#[track_caller]
fn gives_no_orders(run: &Run) {
    let said = run.out() + &run.err();
    let is_order = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
    assert!(!said.chars().any(is_order) && !said.contains("panicked"), "{said:?}");
}

#[test]
fn names_are_shown_without_orders() {
    let place = Place::new();
    let escaped: String = ORDERS.chars().map(|c| format!("\\u{:04x}", u32::from(c))).collect();
    let scene =
        SCENE.replace("\"red\"", &format!("\"red{escaped}\"")).replace("\"near\"", &format!("\"near{escaped}\""));
    let scene = scene.replace("[[meshes]]", &format!("[[meshes]]\nname = \"mesh{escaped}\""));
    let name = format!("scene{ORDERS}.toml");
    place.write(&name, scene);
    place.write("bad.toml", format!("version = 1\n[[meshes]]\nfile = \"none{escaped}.obj\"\n"));
    let picture = format!("a{ORDERS}.png");
    let picture = picture.as_str();
    for words in [
        &["info", &name] as &[&str],
        &["info", "--json", &name],
        &["info", "bad.toml"],
        &["render", &name, "--device", "cpu", "--size", "8x8", "-o", picture, "--aov", "depth"],
        &["render", &name, "--device", "cpu", "--camera", "none"],
        &["render", &name, "--device", "cpu", "-o", &format!("none{ORDERS}/a.png")],
        &["query", &name, "--rays", &format!("none{ORDERS}.csv")],
        &["bench", &name, "--device", "cpu", "--size", "8x8", "--repeats", "1", "--min-rays", "1", "--rays", "primary"],
    ] {
        gives_no_orders(&place.run(words));
    }
    assert!(place.path(picture).exists());
    let info = place.run(&["info", &name]).succeeds().out();
    assert!(info.contains("0 'mesh\u{fffd}[2J"), "{info}");
}

#[test]
fn paths_need_not_be_utf8() {
    let place = Place::new();
    let name = OsStr::from_bytes(b"sc\xffne.toml");
    std::fs::write(place.path(".").join(name), SCENE).unwrap();
    let ends = |words: &[&str], more: &[&OsStr]| {
        Run(place.command(words).arg(name).args(more).output().unwrap(), words.join(" "))
    };
    ends(&["info"], &[]).succeeds();
    let output = OsStr::from_bytes(b"a\xfe.png");
    ends(&["render", "--device", "cpu", "--size", "8x8"], &[OsStr::new("-o"), output]).says("8x8 pixels");
    assert!(place.path(".").join(output).exists());
    let frames = ["render", "--device", "cpu", "--frames", "1..2", "--orbit"];
    ends(&frames, &[OsStr::new("-o"), output]).fails(2, "its name is not UTF-8 text");
}
