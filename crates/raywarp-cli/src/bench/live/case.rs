//! What the viewer is asked for while the camera moves.

use std::fmt;
use std::time::Duration;

use raywarp::scene::RenderDefaults;
use raywarp_viewer::live::view_settings::{ViewSettings, FRAME_RATES};
use serde::Serialize;

/// A way to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Case {
    /// Every picture at full size, one after the other.
    Full,
    /// At the viewer's own frame rate, with as many pixels as it finds time for.
    Held,
}

impl Case {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Full, Self::Held];

    /// The viewer's options: its defaults, but for one sample a pixel also at rest.
    pub fn view_settings(self) -> ViewSettings {
        let one = RenderDefaults { spp: Some(1), ..RenderDefaults::default() };
        let view_settings = ViewSettings::of(&one);
        match self {
            // The least rate gives a picture the most time before it is shown in parts.
            Self::Full => ViewSettings { reference: true, frame_rate: FRAME_RATES[0], ..view_settings },
            Self::Held => view_settings,
        }
    }

    /// From one picture to the next; none: as they come.
    pub fn period(self) -> Option<Duration> {
        (self == Self::Held).then(aim)
    }
}

/// The time that the viewer's own frame rate leaves for a picture.
pub fn aim() -> Duration {
    Duration::from_secs_f32(1.0 / ViewSettings::default().frame_rate)
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full => "full",
            Self::Held => "held",
        })
    }
}
