//! Whether the display's libraries are there, before winit needs them and panics.
//!
//! A binary of raywarp has to start where there is no desktop, so none of these libraries is linked: all are opened when
//! a window is.

use super::WindowError;

/// Whether a window can be tried at all.
///
/// # Errors
/// [`WindowError::NoDisplay`], or [`WindowError::Library`] for a library that is missing.
#[cfg(all(unix, not(target_os = "macos")))]
pub fn check() -> Result<(), WindowError> {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let wayland = is_set("WAYLAND_DISPLAY") || is_set("WAYLAND_SOCKET");
    if !wayland && !is_set("DISPLAY") {
        return Err(WindowError::NoDisplay);
    }
    if xkbcommon_dl::xkbcommon_option().is_none() {
        return Err(WindowError::Library { library: "libxkbcommon.so.0", package: "libxkbcommon0" });
    }
    if !wayland && xkbcommon_dl::x11::xkbcommon_x11_option().is_none() {
        return Err(WindowError::Library { library: "libxkbcommon-x11.so.0", package: "libxkbcommon-x11-0" });
    }
    Ok(())
}

/// Other systems have a display and all libraries, or winit says what is missing.
#[cfg(not(all(unix, not(target_os = "macos"))))]
pub fn check() -> Result<(), WindowError> {
    Ok(())
}
