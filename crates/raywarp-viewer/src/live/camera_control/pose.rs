//! Where a camera is, in the terms that people move it by, in double precision: many small moves do not add up to a
//! drift.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use raywarp::scene::{Camera, Projection};

/// Axes of the world as seen from its front: orthonormal, `right` x `up` = `front`, which points at the one who looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct World {
    pub right: DVec3,
    pub up: DVec3,
    pub front: DVec3,
}

impl World {
    /// With +Z as the front for +Y up, and -Y for +Z up. +Y for an `up` that is no direction.
    pub fn new(up: [f32; 3]) -> Self {
        let up = unit(vec(up)).unwrap_or(DVec3::Y);
        let right = if up.x.abs() < 0.99 { DVec3::X } else { DVec3::Y };
        let right = (right - up * right.dot(up)).normalize();
        Self { right, up, front: right.cross(up) }
    }
}

/// A camera about its target. Yaw 0 looks at the front, a quarter turn of it at the right; pitch is up to a quarter turn
/// either way and never wraps, so nothing flips at the poles: yaw is kept there, not derived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub target: DVec3,
    /// From the eye to the target.
    pub distance: f64,
    pub yaw: f64,
    /// Elevation of the eye over the target.
    pub pitch: f64,
    /// Turn of the picture about its middle.
    pub roll: f64,
    pub projection: Projection,
    /// Field of view of the pinhole that parallel rays give way to.
    pub fov: f32,
}

/// Field of view of a pinhole where nothing says which.
const USUAL_FOV: f32 = 0.7;
/// Closer to a pole than this, in radians, a camera is at it.
const POLE: f64 = 1e-4;

impl Pose {
    /// Of a camera, if it can be rendered from.
    pub fn of(camera: &Camera, world: &World) -> Option<Self> {
        if !is_usable(camera) {
            return None;
        }
        let view = vec(camera.target) - vec(camera.eye);
        let (forward, distance) = (unit(view)?, view.length());
        // As the renderer finds the upward direction.
        let across = [vec(camera.up), DVec3::Y, DVec3::Z].into_iter().find_map(|up| {
            let across = forward.cross(unit(up)?);
            (across.length() > 1e-4).then(|| across.normalize())
        })?;
        let up = across.cross(forward);

        let sine = -forward.dot(world.up);
        let level = forward + world.up * sine;
        let at_pole = level.length() < POLE;
        let pitch = if at_pole { FRAC_PI_2.copysign(sine) } else { sine.atan2(level.length()) };
        // At a pole the picture's upward direction tells what a small tilt would look at.
        let away = if at_pole { -up * sine.signum() } else { -level };
        let yaw = away.dot(world.right).atan2(away.dot(world.front));
        let fov = match camera.projection {
            Projection::Perspective { fov_y } => fov_y,
            Projection::Orthographic { .. } => USUAL_FOV,
        };
        let mut pose =
            Self { target: vec(camera.target), distance, yaw, pitch, roll: 0.0, projection: camera.projection, fov };
        let [level_right, level_up, _] = pose.axes(world);
        let roll = up.dot(level_right).atan2(up.dot(level_up));
        pose.roll = if roll.abs() < POLE { 0.0 } else { roll };
        Some(pose)
    }

    /// Takes the point of the line of sight that is nearest to another as target, if it is before the eye.
    pub fn aim_near(&mut self, point: DVec3, world: &World) {
        let (eye, forward) = (self.eye(world), self.axes(world)[2]);
        let distance = (point - eye).dot(forward);
        if distance > 0.0 && distance.is_finite() {
            (self.target, self.distance) = (eye + forward * distance, distance);
        }
    }

    /// Right, up and forward, orthonormal.
    pub fn axes(&self, world: &World) -> [DVec3; 3] {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        // The cosine of a quarter turn is not quite 0 in floating point; here it is.
        let (sin_pitch, cos_pitch) = match self.pitch.abs() >= FRAC_PI_2 {
            true => (self.pitch.signum(), 0.0),
            false => self.pitch.sin_cos(),
        };
        let level = world.front * cos_yaw + world.right * sin_yaw;
        let forward = -(level * cos_pitch + world.up * sin_pitch);
        let up = world.up * cos_pitch - level * sin_pitch;
        let right = forward.cross(up);
        let (sin_roll, cos_roll) = self.roll.sin_cos();
        [right * cos_roll - up * sin_roll, up * cos_roll + right * sin_roll, forward]
    }

    pub fn eye(&self, world: &World) -> DVec3 {
        self.target - self.axes(world)[2] * self.distance
    }

    /// For the renderer.
    pub fn camera(&self, world: &World, name: &str) -> Camera {
        let [_, up, _] = self.axes(world);
        let upright = self.roll == 0.0 && self.pitch.abs() < 1.4;
        Camera {
            name: name.to_owned(),
            eye: self.eye(world).as_vec3().to_array(),
            target: self.target.as_vec3().to_array(),
            up: if upright { world.up } else { up }.as_vec3().to_array(),
            projection: self.projection,
        }
    }

    /// Height of the picture at the target, in scene units.
    pub fn height(&self) -> f64 {
        match self.projection {
            Projection::Perspective { fov_y } => 2.0 * self.distance * (0.5 * f64::from(fov_y)).tan(),
            Projection::Orthographic { height } => f64::from(height),
        }
    }

    /// Turns about the target so that the scene follows a pointer that goes this far right and down, in heights of the
    /// picture: one is half a turn.
    pub fn orbit(&mut self, right: f64, down: f64) {
        self.turn(right * PI, down * PI);
    }

    /// Turns about the eye so that what is in the middle of a level picture follows a pointer that goes this far right and
    /// down, in heights of the picture. Parallel rays have no eye: they orbit.
    pub fn look_around(&mut self, world: &World, right: f64, down: f64) {
        let Projection::Perspective { fov_y } = self.projection else { return self.orbit(right, down) };
        let (eye, height) = (self.eye(world), 2.0 * (0.5 * f64::from(fov_y)).tan());
        self.turn(-(right * height).atan(), -(down * height).atan());
        self.target = eye + self.axes(world)[2] * self.distance;
    }

    /// Turns by angles to the right and down of the picture.
    fn turn(&mut self, right: f64, down: f64) {
        let (sin, cos) = self.roll.sin_cos();
        let (right, down) = (right * cos - down * sin, down * cos + right * sin);
        self.yaw = (self.yaw - right).rem_euclid(2.0 * PI);
        self.pitch = (self.pitch + down).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Shifts so that what is as far as the target follows a pointer that goes this far right and down, in heights of
    /// the picture.
    pub fn pan(&mut self, world: &World, right: f64, down: f64) {
        let [across, up, _] = self.axes(world);
        self.target += (up * down - across * right) * self.height();
    }

    /// Makes what is at the target appear so many times smaller, without ever reaching it.
    pub fn zoom(&mut self, factor: f64) {
        match &mut self.projection {
            Projection::Perspective { .. } => self.distance *= factor,
            Projection::Orthographic { height } => *height = (f64::from(*height) * factor) as f32,
        }
    }

    /// Looks at a point: a pinhole turns to it, parallel rays move to it.
    pub fn look_at(&mut self, point: DVec3, world: &World) {
        let away = self.eye(world) - point;
        if let (Projection::Perspective { .. }, Some(direction)) = (self.projection, unit(away)) {
            let sine = direction.dot(world.up);
            let level = direction - world.up * sine;
            if level.length() > POLE {
                self.yaw = level.dot(world.right).atan2(level.dot(world.front));
            }
            self.pitch = sine.atan2(level.length());
            self.distance = away.length();
        }
        self.target = point;
    }

    /// Between a pinhole and parallel rays; things at the target keep their size. Parallel rays start `reach` from the
    /// target at least.
    pub fn switch_projection(&mut self, reach: f64) {
        let height = self.height();
        match self.projection {
            Projection::Perspective { fov_y } => {
                self.fov = fov_y;
                self.projection = Projection::Orthographic { height: height as f32 };
                self.distance = self.distance.max(reach);
            }
            Projection::Orthographic { .. } => {
                self.projection = Projection::Perspective { fov_y: self.fov };
                self.distance = height / (2.0 * (0.5 * f64::from(self.fov)).tan());
            }
        }
    }
}

/// Whether the renderer can take a camera, and a little more: single precision tells eye and target apart.
pub(super) fn is_usable(camera: &Camera) -> bool {
    let finite = [camera.eye, camera.target, camera.up].iter().flatten().all(|x| x.is_finite());
    let apart = (0..3).any(|i| camera.eye[i] != camera.target[i]);
    let close = (0..3).all(|i| (camera.target[i] - camera.eye[i]).is_finite());
    let lens = match camera.projection {
        Projection::Perspective { fov_y } => fov_y > 0.0 && fov_y < std::f32::consts::PI,
        Projection::Orthographic { height } => height > 0.0 && height.is_finite(),
    };
    finite && apart && close && lens
}

pub(super) fn vec(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

fn unit(v: DVec3) -> Option<DVec3> {
    (v.is_finite() && v != DVec3::ZERO).then(|| (v / v.abs().max_element()).normalize())
}
