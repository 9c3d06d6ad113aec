//! What a picture file says of how it was made: for people, and for a run that finds it.

/// How a picture was made, as it stands in its file: PNG has text chunks for it, EXR attributes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// The program and its version. PNG `Software`, EXR `software`.
    pub software: String,
    /// Words that make the picture again. PNG `Comment`, EXR `comments`.
    pub comment: String,
    /// The same for two files only where the same was rendered of the same. PNG `raywarp:fingerprint`, EXR
    /// `raywarpFingerprint`.
    pub fingerprint: String,
}

/// A picture file that is whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Of its [`Provenance`], where it has any.
    pub fingerprint: Option<String>,
}

/// The keyword of a PNG's fingerprint.
pub(super) const PNG_FINGERPRINT: &str = "raywarp:fingerprint";
/// The name of an EXR's.
pub(super) const EXR_FINGERPRINT: &str = "raywarpFingerprint";
