//! `raywarp view` as a program: which front end it starts. The window has tests of its own, the page is tested in `browser.rs`.
#![cfg(unix)]

use std::io::{BufRead, BufReader, Read};
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::common::{Place, SCENE};

/// Variables by which a desktop and a remote shell are told.
const DESKTOP: [&str; 6] = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "SSH_CONNECTION", "SSH_CLIENT", "SSH_TTY"];

/// One test at a time: a program that is being written cannot be started, and others' children hold such files open.
fn alone() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A program of this name that keeps the words it is given in the file `words`.
fn put_program(place: &Place, name: &str, ending: &str) {
    place.write(name, format!("#!/bin/sh\necho \"$@\" > words.part\nmv words.part words\n{ending}\n"));
    std::fs::set_permissions(place.path(name), std::fs::Permissions::from_mode(0o755)).unwrap();
}

fn view(place: &Place, words: &[&str], desktop: &[(&str, &str)]) -> Command {
    // Where cargo puts the program there may be a window beside it.
    let program = place.path("raywarp");
    if !program.exists() {
        std::fs::copy(place.command(&[]).get_program(), &program).unwrap();
    }
    let mut command = Command::new(program);
    command.arg("view").args(words).current_dir(place.path("")).env("RAYWARP_CACHE", "");
    for variable in DESKTOP {
        command.env_remove(variable);
    }
    // What the shell of such a program needs, and the folder of the test before it.
    let path = format!("{}:/usr/bin:/bin", place.path("").display());
    command.env("PATH", path).envs(desktop.iter().copied());
    command
}

#[test]
fn the_window_gets_the_options_and_its_exit_code_is_told() {
    let _turn = alone();
    let place = Place::new();
    put_program(&place, "raywarp-window", "exit 7");
    let status = view(&place, &["a scene.obj", "--fullscreen"], &[("DISPLAY", ":99")]).status().unwrap();
    assert_eq!(status.code(), Some(7));
    assert_eq!(std::fs::read_to_string(place.path("words")).unwrap(), "a scene.obj --fullscreen\n");
    // What is none of its options is told before.
    let output = view(&place, &["--fullscren"], &[("DISPLAY", ":99")]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}

/// Runs it until the address is there, and whatever `until` waits for; the address.
fn shown(place: &Place, desktop: &[(&str, &str)], until: impl Fn()) -> String {
    place.write("scene.toml", SCENE);
    let mut command = view(place, &["scene.toml", "--device", "cpu"], desktop);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut url = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
    assert!(url.starts_with("http://127.0.0.1:"), "{url}");
    let start = Instant::now();
    while ureq::get(url.trim()).call().is_err() {
        assert!(start.elapsed() < Duration::from_secs(60), "{url} does not answer");
        std::thread::sleep(Duration::from_millis(20));
    }
    until();
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let status = child.wait().unwrap();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(said.contains("scene.toml until Ctrl-C, in a browser at"), "{said}");
    url.trim().to_owned()
}

#[test]
fn without_a_window_the_browser_opens_the_page() {
    let _turn = alone();
    let place = Place::new();
    put_program(&place, "xdg-open", "");
    let start = Instant::now();
    let url = shown(&place, &[("DISPLAY", ":99")], || {
        while cfg!(target_os = "linux") && !place.path("words").exists() {
            assert!(start.elapsed() < Duration::from_secs(60), "no browser is opened");
            std::thread::sleep(Duration::from_millis(20));
        }
    });
    if cfg!(target_os = "linux") {
        assert_eq!(std::fs::read_to_string(place.path("words")).unwrap(), format!("{url}\n"));
    }
}

#[test]
fn without_a_desktop_or_far_from_it_the_address_is_printed_alone() {
    let _turn = alone();
    for desktop in [&[][..], &[("DISPLAY", ":10"), ("SSH_CONNECTION", "192.0.2.1 50000 192.0.2.2 22")]] {
        let place = Place::new();
        put_program(&place, "xdg-open", "");
        shown(&place, desktop, || std::thread::sleep(Duration::from_millis(300)));
        assert!(!place.path("words").exists(), "{desktop:?}");
    }
}
