//! Flight by held keys.

use std::time::Duration;

use glam::DVec3;
use raywarp::scene::Projection;

use super::pose::{Pose, World};

/// A way to fly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fly {
    /// The way that the camera looks.
    Forward,
    /// Away from it.
    Back,
    /// To the picture's left.
    Left,
    /// To the picture's right.
    Right,
    /// Down in the world.
    Down,
    /// Up in the world.
    Up,
}

/// Times the speed with Shift, and without it.
const FAST: f64 = 4.0;
const SLOW: f64 = 0.2;
/// A longer time between two frames was a pause, not flight.
const LONGEST_STEP: f64 = 0.25;

/// The keys that are held.
#[derive(Clone, Debug, Default)]
pub(super) struct Flight {
    held: Vec<Fly>,
    pub fast: bool,
    pub slow: bool,
}

impl Flight {
    pub fn hold(&mut self, way: Fly) {
        if !self.held.contains(&way) {
            self.held.push(way);
        }
    }

    /// Whether it was held.
    pub fn release(&mut self, way: Fly) -> bool {
        let before = self.held.len();
        self.held.retain(|&held| held != way);
        before != self.held.len()
    }

    pub fn is_held(&self) -> bool {
        !self.held.is_empty()
    }

    /// Moves a pose for a time; `speed` is in scene units a second.
    pub fn step(&self, pose: &mut Pose, world: &World, speed: f64, dt: Duration) {
        let [right, up, forward] = pose.axes(world);
        let parallel = matches!(pose.projection, Projection::Orthographic { .. });
        let direction = self
            .held
            .iter()
            .map(|way| match way {
                Fly::Forward => forward,
                Fly::Back => -forward,
                Fly::Left => -right,
                Fly::Right => right,
                // In a view along the world's upward direction nothing would be seen of a move along it in parallel rays.
                Fly::Down => {
                    if parallel {
                        -up
                    } else {
                        -world.up
                    }
                }
                Fly::Up => {
                    if parallel {
                        up
                    } else {
                        world.up
                    }
                }
            })
            .sum::<DVec3>();
        let pace = match (self.fast, self.slow) {
            (true, false) => FAST,
            (false, true) => SLOW,
            _ => 1.0,
        };
        let time = dt.as_secs_f64().min(LONGEST_STEP) * pace;
        let direction = direction.clamp_length_max(1.0);
        if parallel {
            // Parallel rays show no approach: they get closer by a smaller picture, half as high in a second.
            let ahead = direction.dot(forward);
            pose.zoom((-ahead * time).exp2());
            pose.target += (direction - forward * ahead) * (time * 0.5 * pose.height());
        } else {
            pose.target += direction * (speed * time);
        }
    }
}
