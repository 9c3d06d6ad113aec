//! Every key and what it does, for the help over the picture.

/// Keys, and what they do, in groups. Made from the [bindings](super::keys::BINDINGS), so that it holds.
pub const HELP: &[(&str, &[(&str, &str)])] = super::keys::HELP;
