//! Views along the axes.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::pose::Pose;

/// A side to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Where +Z points at the eye, with +Y up.
    Front,
    /// Opposite of it.
    Back,
    /// Where +X points at the eye.
    Right,
    /// Opposite of it.
    Left,
    /// From above.
    Top,
    /// From below.
    Bottom,
    /// From the right, above and the front: the three axes appear alike.
    Isometric,
}

impl Preset {
    /// Turns a pose about its target.
    pub(super) fn turn(self, pose: &mut Pose) {
        // The elevation of (1, 1, 1).
        let diagonal = (1.0f64 / 3.0).sqrt().asin();
        (pose.yaw, pose.pitch) = match self {
            Self::Front => (0.0, 0.0),
            Self::Back => (PI, 0.0),
            Self::Right => (FRAC_PI_2, 0.0),
            Self::Left => (3.0 * FRAC_PI_2, 0.0),
            Self::Top => (0.0, FRAC_PI_2),
            Self::Bottom => (0.0, -FRAC_PI_2),
            Self::Isometric => (FRAC_PI_4, diagonal),
        };
        pose.roll = 0.0;
    }
}
