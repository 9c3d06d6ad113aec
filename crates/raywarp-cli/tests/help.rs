//! The help, word by word; completions and manual pages from the same definitions.

use crate::common::Place;

fn help(arguments: &[&str]) -> String {
    Place::new().run(arguments).succeeds().out()
}

#[test]
fn the_help_reads_as_it_should() {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    let _bound = settings.bind_to_scope();
    insta::assert_snapshot!("help__raywarp", help(&["--help"]));
    insta::assert_snapshot!("help__render", help(&["render", "--help"]));
    insta::assert_snapshot!("help__view", help(&["view", "--help"]));
    insta::assert_snapshot!("help__query", help(&["query", "--help"]));
    insta::assert_snapshot!("help__serve", help(&["serve", "--help"]));
    insta::assert_snapshot!("help__info", help(&["info", "--help"]));
    insta::assert_snapshot!("help__bench", help(&["bench", "--help"]));
    insta::assert_snapshot!("help__doctor", help(&["doctor", "--help"]));
    insta::assert_snapshot!("help__completions", help(&["completions", "--help"]));
    insta::assert_snapshot!("help__man", help(&["man", "--help"]));
}

#[test]
fn short_and_long_help_are_the_same() {
    assert_eq!(help(&["render", "-h"]), help(&["render", "--help"]));
}

#[test]
fn every_shell_gets_completions_for_every_option() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = help(&["completions", shell]);
        assert!(script.contains("max-depth") && script.contains("heatmap"), "{shell}");
    }
}

#[test]
fn manual_pages_are_written_for_every_command() {
    let place = Place::new();
    assert!(place.run(&["man"]).succeeds().out().contains(".TH raywarp 1"));
    place.run(&["man", "pages"]).succeeds();
    for name in ["", "-render", "-view", "-query", "-info", "-bench", "-doctor"] {
        assert!(place.path("pages").join(format!("raywarp{name}.1")).is_file(), "{name}");
    }
    place.write("file", "");
    place.run(&["man", "file/pages"]).fails(2, "cannot write manual pages into file/pages");
}

#[test]
fn the_version_is_that_of_the_package() {
    assert_eq!(help(&["--version"]), format!("raywarp {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn completions_know_what_options_take() {
    let place = Place::new();
    let bash = place.run(&["completions", "bash"]).succeeds().out();
    for values in [
        "auto cpu cuda",
        "brute kd bvh2 bvh",
        "fast medium high",
        "clamp filmic",
        "depth normal albedo",
        "closest any count all",
        "npz npy csv",
        "table json",
    ] {
        assert!(bash.contains(values), "{values}");
    }
}
