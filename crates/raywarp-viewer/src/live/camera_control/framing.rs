//! Bounds as the camera's measure: how far, how near, how fast.

use glam::DVec3;
use raywarp::scene::Projection;

use super::pose::{vec, Pose};

/// A box's middle and half diagonal, both finite, the latter above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub centre: DVec3,
    pub radius: f64,
}

/// A pinhole's target is no closer than this many steps of single precision at its coordinates: else the eye would jump
/// from one representable place to the next.
const STEPS: f64 = 4096.0;
/// The same as a share of the scene.
const NEAREST: f64 = 1e-6;
/// Farther than this many radii there is nothing to see.
const FARTHEST: f64 = 1e4;

impl Extent {
    /// Of a box. One that is empty or not finite counts as the unit sphere.
    pub fn of([low, high]: [[f32; 3]; 2]) -> Self {
        let (low, high) = (vec(low), vec(high));
        let radius = 0.5 * (high - low).length();
        if low.is_finite() && high.is_finite() && radius > 0.0 && low.cmple(high).all() {
            Self { centre: 0.5 * (low + high), radius: radius.clamp(1e-30, 1e30) }
        } else {
            Self { centre: DVec3::ZERO, radius: 1.0 }
        }
    }

    /// Moves a pose so far, without turning it, that it sees all of the extent in a picture of this width over height.
    pub fn frame(&self, pose: &mut Pose, aspect: f64, reach: f64) {
        pose.target = self.centre;
        match &mut pose.projection {
            Projection::Perspective { fov_y } => {
                let half = (0.5 * f64::from(*fov_y)).tan();
                pose.distance = self.radius / (half * aspect.min(1.0)).atan().sin();
            }
            Projection::Orthographic { height } => {
                *height = (2.0 * self.radius / aspect.min(1.0)) as f32;
                pose.distance = reach;
            }
        }
    }

    /// Distance from a target from which the rays of a parallel camera start before all of the extent.
    pub fn reach(&self, target: DVec3) -> f64 {
        2.0 * self.radius + (target - self.centre).length()
    }

    /// Keeps a pose where single precision can tell eye and target apart and nothing overflows, or where it was before.
    pub fn limit(&self, pose: &mut Pose, before: &Pose) {
        let farthest = FARTHEST * self.radius;
        let (low, high) = (self.centre - farthest, self.centre + farthest);
        pose.target = pose.target.clamp(low.min(before.target), high.max(before.target));
        let step = pose.target.abs().max_element() * f64::from(f32::EPSILON);
        let nearest = (STEPS * step).max(NEAREST * self.radius).min(farthest);
        match &mut pose.projection {
            Projection::Perspective { .. } => {
                pose.distance = pose.distance.clamp(nearest.min(before.distance), farthest.max(before.distance))
            }
            Projection::Orthographic { height } => {
                *height = height.clamp(nearest as f32, farthest as f32);
                // Its rays may start from far away: a step of single precision there is invisible.
                pose.distance =
                    pose.distance.clamp(nearest.min(before.distance), (4.0 * farthest).max(before.distance));
            }
        }
    }
}
