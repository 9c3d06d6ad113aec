//! Every key and what it does, for the help over the picture.

/// Keys, and what they do, in groups.
pub const HELP: &[(&str, &[(&str, &str)])] = &[
    ("Camera", &[("drag", "orbit"), ("wheel", "closer, farther")]),
    ("Window", &[("H", "this help"), ("F12", "keep the picture as a file")]),
];
