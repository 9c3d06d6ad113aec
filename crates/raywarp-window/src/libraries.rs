//! Whether the display's libraries are there, before winit needs them: it panics, or does not say which is missing.
//!
//! The program has to start where there is no desktop, so none of these libraries is linked: all are opened when a
//! window is.

use crate::error::WindowError;

/// Whether a window can be tried at all.
///
/// # Errors
/// [`WindowError::NoDisplay`], or [`WindowError::Library`] for a library that is missing.
#[cfg(all(unix, not(target_os = "macos")))]
pub fn check() -> Result<(), WindowError> {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let missing = match (is_set("WAYLAND_DISPLAY") || is_set("WAYLAND_SOCKET"), is_set("DISPLAY")) {
        (true, _) => missing(&wayland()),
        (false, true) => missing(&x11()),
        (false, false) => return Err(WindowError::NoDisplay),
    };
    missing.map_or(Ok(()), |(library, package)| Err(WindowError::Library { library, package }))
}

/// Other systems have a display and all libraries, or winit says what is missing.
#[cfg(not(all(unix, not(target_os = "macos"))))]
pub fn check() -> Result<(), WindowError> {
    Ok(())
}

/// File name, Debian's package, and whether it can be loaded.
#[cfg(all(unix, not(target_os = "macos")))]
type Library = (&'static str, &'static str, bool);

#[cfg(all(unix, not(target_os = "macos")))]
fn wayland() -> [Library; 2] {
    [
        ("libwayland-client.so.0", "libwayland-client0", wayland_sys::client::is_lib_available()),
        ("libxkbcommon.so.0", "libxkbcommon0", xkbcommon_dl::xkbcommon_option().is_some()),
    ]
}

#[cfg(all(unix, not(target_os = "macos")))]
fn x11() -> [Library; 6] {
    use x11_dl::{xcursor::Xcursor, xinput2::XInput2, xlib::Xlib, xlib_xcb::Xlib_xcb};
    [
        ("libX11.so.6", "libx11-6", Xlib::open().is_ok()),
        ("libX11-xcb.so.1", "libx11-xcb1", Xlib_xcb::open().is_ok()),
        ("libXcursor.so.1", "libxcursor1", Xcursor::open().is_ok()),
        ("libXi.so.6", "libxi6", XInput2::open().is_ok()),
        ("libxkbcommon.so.0", "libxkbcommon0", xkbcommon_dl::xkbcommon_option().is_some()),
        ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0", xkbcommon_dl::x11::xkbcommon_x11_option().is_some()),
    ]
}

#[cfg(all(unix, not(target_os = "macos")))]
fn missing(libraries: &[Library]) -> Option<(&'static str, &'static str)> {
    libraries.iter().find(|(_, _, there)| !there).map(|&(library, package, _)| (library, package))
}
