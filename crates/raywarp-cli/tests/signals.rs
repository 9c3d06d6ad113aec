//! Ctrl-C, SIGTERM and pipes whose reader has gone.
#![cfg(unix)]

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::Place;

/// A grid of so many squares each way.
fn grid(side: usize) -> String {
    let mut text: String = (0..=side).flat_map(|y| (0..=side).map(move |x| format!("v {x} {y} 0\n"))).collect();
    for y in 0..side {
        for x in 1..=side {
            let (a, b) = (y * (side + 1) + x, (y + 1) * (side + 1) + x);
            text += &format!("f {a} {} {} {b}\n", a + 1, b + 1);
        }
    }
    text
}

/// Sends a signal once the program has been at work for a while, and answers how it ended and how soon.
fn signalled(child: Child, signal: &str) -> (Option<i32>, Duration) {
    signalled_after(Duration::from_millis(400), child, signal)
}

fn signalled_after(time: Duration, mut child: Child, signal: &str) -> (Option<i32>, Duration) {
    std::thread::sleep(time);
    assert!(child.try_wait().unwrap().is_none(), "it ended too soon for this test");
    Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    let start = Instant::now();
    (child.wait().unwrap().code(), start.elapsed())
}

#[test]
fn commands_that_only_measure_end_at_once_and_leave_nothing() {
    let place = Place::new();
    place.write("grid.obj", grid(700));
    let before = place.names();
    for words in [
        &["info", "grid.obj"] as &[&str],
        &["bench", "--device", "cpu", "--repeats", "1000"],
        &["bench", "--device", "cpu", "--frames"],
    ] {
        for signal in ["-INT", "-TERM"] {
            let mut command = place.command(words);
            command.stdout(Stdio::null()).stderr(Stdio::null()).env("TMPDIR", place.path("."));
            let (code, seconds) = signalled(command.spawn().unwrap(), signal);
            assert_eq!(code, Some(130), "{words:?} {signal}");
            // A fifth of a second where the machine has nothing else to do.
            assert!(seconds < Duration::from_secs(2), "{words:?} {signal}: {seconds:?}");
        }
    }
    let left: Vec<_> = place.names().into_iter().filter(|name| !before.contains(name)).collect();
    assert_eq!(left, [""; 0]);
}

#[test]
fn viewers_end_at_once_while_a_scene_is_read_and_its_tree_is_built() {
    let place = Place::new();
    place.write("grid.obj", grid(700));
    for words in [&["serve", "grid.obj", "--port", "0"] as &[&str], &["view", "grid.obj"]] {
        // Reading takes about as long as the shortest of these, and building longer.
        for milliseconds in [150, 700, 1500, 2500] {
            let mut command = place.command(&[words, &["--device", "cpu"]].concat());
            command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
            let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            let (code, time) = signalled_after(Duration::from_millis(milliseconds), child, "-INT");
            eprintln!("{words:?} after {milliseconds} ms: {time:?}");
            assert_eq!(code, Some(130), "{words:?} after {milliseconds} ms");
            // A fifth of a second, and what a busy machine adds.
            assert!(time < Duration::from_millis(700), "{words:?} after {milliseconds} ms: {time:?}");
        }
    }
}

#[test]
fn a_reader_that_has_gone_is_no_failure() {
    let place = Place::new();
    place.write("a.obj", grid(2));
    for words in [
        &["info", "a.obj"] as &[&str],
        &["info", "--json", "a.obj"],
        &["render", "a.obj", "--device", "cpu", "--size", "64x64", "-o", "-", "-q"],
        &["completions", "bash"],
        &["man"],
        &["--help"],
        &[
            "bench",
            "a.obj",
            "--device",
            "cpu",
            "--size",
            "8x8",
            "--repeats",
            "1",
            "--min-rays",
            "1",
            "--rays",
            "primary",
        ],
    ] {
        let mut child = place.command(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let ended = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert!(ended.status.success() && !said.contains("error") && !said.contains("panicked"), "{words:?}: {said}");
    }
}
