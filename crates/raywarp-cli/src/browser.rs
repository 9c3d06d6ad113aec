//! The browser of whoever sits before this machine.

use std::env;
use std::process::{Command, Stdio};

/// Has the desktop's browser open an address, if anybody sits before a desktop of this machine. Whether it does is not
/// waited for: people are told the address too.
pub fn open(url: &str) {
    if !has_display() || is_remote() {
        return;
    }
    let [program, words @ ..] = OPENER else { return };
    let mut command = Command::new(program);
    command.args(words).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // Where there is no such program, people open the address themselves.
    let Ok(mut opener) = command.spawn() else { return };
    std::thread::spawn(move || opener.wait());
}

/// What opens an address in the browser that people have chosen.
const OPENER: &[&str] = if cfg!(target_os = "macos") {
    &["open"]
} else if cfg!(windows) {
    // `start` takes its first word in quotation marks for a title.
    &["cmd", "/C", "start", ""]
} else {
    &["xdg-open"]
};

/// Whether there is a desktop to show something on.
pub fn has_display() -> bool {
    let is_x11_or_wayland = cfg!(all(unix, not(target_os = "macos")));
    !is_x11_or_wayland || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].into_iter().any(is_set)
}

/// Whether whoever started this sits elsewhere: a browser would open before nobody, or as slow pixels through the network.
fn is_remote() -> bool {
    ["SSH_CONNECTION", "SSH_CLIENT", "SSH_TTY"].into_iter().any(is_set)
}

fn is_set(variable: &str) -> bool {
    env::var_os(variable).is_some_and(|value| !value.is_empty())
}
