//! What can go wrong with a window.

use raywarp_cli::advice::Advise;
use raywarp_cli::failure::Exit;
use raywarp_viewer::ViewerError;

/// Why there is no window, or none any more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WindowError {
    /// Nothing to show a window on.
    #[error(
        "cannot open a window: there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set). `raywarp serve SCENE` \
         shows the scene in a browser, also one on another machine; `raywarp render SCENE` writes a picture"
    )]
    NoDisplay,
    /// A library that every desktop has is missing.
    #[error(
        "cannot open a window: the library {library} cannot be loaded. Install it (in Debian: {package}), or use \
         `raywarp serve SCENE` with a browser"
    )]
    Library {
        /// File name of the library.
        library: &'static str,
        /// What Debian calls its package.
        package: &'static str,
    },
    /// The display refuses.
    #[error("cannot {action}: {reason}. `raywarp serve SCENE` shows the scene in a browser instead")]
    Display {
        /// What was tried.
        action: &'static str,
        /// What the system says.
        reason: String,
    },
    /// The viewer fails.
    #[error(transparent)]
    Viewer(#[from] ViewerError),
}

impl Advise for WindowError {
    fn advice(&self) -> Option<String> {
        if let Self::Viewer(error) = self {
            error.advice()
        } else {
            None
        }
    }

    fn exit(&self) -> Exit {
        if let Self::Viewer(error) = self {
            error.exit()
        } else {
            Exit::Usage
        }
    }
}

/// What winit says, without the lines of its source that it puts first.
pub fn of_winit(action: &'static str, error: impl std::fmt::Display) -> WindowError {
    let text = error.to_string();
    let reason = match text.strip_prefix("os error at ").and_then(|rest| rest.split_once(".rs:")) {
        Some((_, rest)) => rest.split_once(": ").map_or(rest, |(_line, reason)| reason).to_owned(),
        None => text,
    };
    WindowError::Display { action, reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_others_sources_are_left_out() {
        let said = |text: &str| of_winit("open a window", text).to_string();
        let error = said("os error at a/b/mod.rs:765: failed to open: no");
        assert!(error.starts_with("cannot open a window: failed to open: no. `raywarp serve"), "{error}");
        assert!(said("no luck").starts_with("cannot open a window: no luck. "));
    }
}
