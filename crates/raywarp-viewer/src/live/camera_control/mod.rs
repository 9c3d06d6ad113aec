//! What moves the camera: drags, the wheel, flight by held keys, and views that are one key away.
//!
//! ```
//! use raywarp_viewer::live::camera_control::CameraControl;
//! use raywarp_viewer::live::Event;
//!
//! let bounds = [[-1.0; 3], [1.0; 3]];
//! let home = raywarp::render::framing(bounds);
//! let mut control = CameraControl::new(home.clone(), Vec::new(), bounds, [0.0, 1.0, 0.0]);
//! assert!(control.handle(&Event::Wheel { notches: 1.0 }, 16.0 / 9.0));
//! assert_ne!(control.camera(), &home);
//! ```

mod flags;
mod fly;
mod framing;
mod pose;
mod preset;
#[cfg(test)]
mod tests;

use std::time::Duration;

use raywarp::scene::{Camera, Projection};

use super::keys::{self, Action};
use super::pointer::{Drag, Pointer};
use super::{Button, Event, Modifiers};
use fly::Flight;
pub use fly::Fly;
use framing::Extent;
use pose::{is_usable, vec, Pose, World};
pub use preset::Preset;

/// The camera of one viewer, and how it moves.
///
/// Whatever events come, [`camera`](Self::camera) can be rendered from: finite, eye and target apart, an upward
/// direction across the view.
#[derive(Clone, Debug)]
pub struct CameraControl {
    camera: Camera,
    pose: Pose,
    home: Camera,
    cameras: Vec<Camera>,
    /// Of the cameras, the one looked through last.
    chosen: Option<usize>,
    world: World,
    extent: Extent,
    /// Whether the targets of the given cameras are points that somebody chose.
    aimed: bool,
    aspect: f64,
    pointer: Pointer,
    flight: Flight,
    turns: Turns,
}

/// What a drag with the left button turns the camera about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turns {
    /// The target.
    #[default]
    Orbit,
    /// The eye, as one who stands there looks around. Parallel rays have no eye: they orbit.
    Look,
}

impl Turns {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Orbit, Self::Look];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Orbit => "orbit",
            Self::Look => "look around",
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Orbit => Self::Look,
            Self::Look => Self::Orbit,
        }
    }
}

/// Zoom of one notch of the wheel, and of a drag over the height of the picture.
const NOTCH: f64 = 0.85;
const HEIGHT: f64 = 6.0;
/// Most notches at once: more is not a person.
const MOST_NOTCHES: f32 = 20.0;
/// Share of the scene's radius that is flown in a second.
const SPEED: f64 = 0.5;

impl CameraControl {
    /// Looks through `home`, or frames the bounds where that cannot be rendered from. `cameras` are those that keys step
    /// through.
    pub fn new(home: Camera, cameras: Vec<Camera>, bounds: [[f32; 3]; 2], up: [f32; 3]) -> Self {
        let (world, extent) = (World::new(up), Extent::of(bounds));
        let (home, pose) = match Pose::of(&home, &world) {
            Some(pose) => (home, pose),
            None => framed(&extent, &world),
        };
        Self {
            camera: home.clone(),
            pose,
            chosen: cameras.iter().position(|camera| *camera == home),
            cameras,
            home,
            world,
            extent,
            aimed: true,
            aspect: 1.0,
            pointer: Pointer::default(),
            flight: Flight::default(),
            turns: Turns::default(),
        }
    }

    /// Takes another scene, or the same read again: the view stays.
    pub fn rebase(&mut self, home: Camera, cameras: Vec<Camera>, bounds: [[f32; 3]; 2], up: [f32; 3]) {
        let camera = self.camera.clone();
        // Drags and flights go on.
        let (pointer, flight) = (std::mem::take(&mut self.pointer), std::mem::take(&mut self.flight));
        let (aimed, aspect, turns) = (self.aimed, self.aspect, self.turns);
        *self = Self { aimed, aspect, pointer, flight, turns, ..Self::new(home, cameras, bounds, up) };
        // It could be rendered from before, so it still can.
        let _ = self.set(camera);
    }

    /// Takes the given cameras as directions without targets, as those of glTF are: they turn about the point of their line
    /// of sight that is nearest to the middle of the scene.
    pub fn without_targets(mut self) -> Self {
        self.aimed = false;
        self.pose.aim_near(self.extent.centre, &self.world);
        self
    }

    /// The camera as it is now.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The first view.
    pub fn home(&self) -> &Camera {
        &self.home
    }

    /// Options of `raywarp render` that give exactly this camera: `--eye x,y,z --target x,y,z --up x,y,z` with
    /// `--fov degrees`, or `--ortho height` for parallel rays.
    pub fn flags(&self) -> String {
        flags::flags(&self.camera, self.world.up.as_vec3().to_array())
    }

    /// Whether it is being moved: a key that flies is held, or a drag goes on.
    pub fn is_moving(&self) -> bool {
        self.flight.is_held() || self.pointer.drag().is_some()
    }

    /// Takes an event; whether it was for the camera. `aspect` is the picture's width over its height.
    pub fn handle(&mut self, event: &Event, aspect: f32) -> bool {
        if aspect.is_finite() && aspect > 0.0 {
            self.aspect = f64::from(aspect).clamp(1e-3, 1e3);
        }
        match event {
            Event::Pointer { .. } => self.drag(event),
            Event::Button { modifiers, .. } => {
                self.hold(*modifiers);
                self.pointer.handle(event, self.aspect);
                true
            }
            Event::Wheel { notches } => {
                let notches = if notches.is_nan() { 0.0 } else { notches.clamp(-MOST_NOTCHES, MOST_NOTCHES) };
                self.change(|pose, _| pose.zoom(NOTCH.powf(f64::from(notches))));
                true
            }
            Event::Key { key, down, modifiers } => self.key(event, key, *down, *modifiers),
            Event::Blur => {
                self.pointer.handle(event, self.aspect);
                self.flight = Flight::default();
                false
            }
            Event::Resize { .. } | Event::Set { .. } | Event::Reset { .. } => false,
        }
    }

    fn drag(&mut self, event: &Event) -> bool {
        let Some(Drag { button, modifiers, by: [right, down] }) = self.pointer.handle(event, self.aspect) else {
            return false;
        };
        let turns = if modifiers.ctrl { self.turns.other() } else { self.turns };
        self.change(|pose, world| match (button, modifiers.shift, turns) {
            (Button::Left, false, Turns::Orbit) => pose.orbit(right, down),
            (Button::Left, false, Turns::Look) => pose.look_around(world, right, down),
            (Button::Middle, ..) | (Button::Left, true, _) => pose.pan(world, right, down),
            (Button::Right, ..) => pose.zoom(HEIGHT.powf(down)),
        });
        true
    }

    fn key(&mut self, event: &Event, key: &str, down: bool, modifiers: Modifiers) -> bool {
        self.hold(modifiers);
        match key {
            "Shift" => self.flight.fast = down,
            "Alt" | "Control" | "Meta" => self.flight.slow = down,
            _ => {}
        }
        if !down {
            return keys::fly(key).is_some_and(|way| self.flight.release(way));
        }
        keys::action(event).is_some_and(|action| self.act(action))
    }

    fn hold(&mut self, modifiers: Modifiers) {
        self.flight.fast = modifiers.shift;
        self.flight.slow = modifiers.alt || modifiers.ctrl;
    }

    /// Does what a key asks for; whether it is about the camera. [`Action::Frame`] sees everything here: with something
    /// picked, call [`frame`](Self::frame) instead. [`Action::Focus`] needs a point: [`set_focus`](Self::set_focus).
    pub fn act(&mut self, action: Action) -> bool {
        match action {
            Action::Fly(way) => self.flight.hold(way),
            Action::Preset(preset) => _ = self.change(|pose, _| preset.turn(pose)),
            Action::Projection => self.switch_projection(),
            Action::Look => self.turns = self.turns.other(),
            Action::ResetCamera => _ = self.set(self.home.clone()),
            Action::Frame => self.frame_extent(self.extent),
            Action::NextCamera => self.step_camera(1),
            Action::PreviousCamera => self.step_camera(self.cameras.len().saturating_sub(1)),
            _ => return false,
        }
        true
    }

    /// Flies for the time since the last call; whether the camera moved.
    pub fn step(&mut self, dt: Duration) -> bool {
        if !self.flight.is_held() {
            return false;
        }
        let (flight, speed) = (self.flight.clone(), SPEED * self.extent.radius);
        self.change(|pose, world| flight.step(pose, world, speed, dt))
    }

    /// Orbits about a point from now on, and looks at it: a pinhole turns to it, parallel rays move to it. A point that is
    /// not finite is ignored.
    pub fn set_focus(&mut self, point: [f32; 3]) {
        if point.iter().all(|x| x.is_finite()) {
            self.change(|pose, world| pose.look_at(vec(point), world));
        }
    }

    /// Moves without turning so that all of a box is seen.
    pub fn frame(&mut self, bounds: [[f32; 3]; 2]) {
        self.frame_extent(Extent::of(bounds));
    }

    fn frame_extent(&mut self, extent: Extent) {
        let (aspect, reach) = (self.aspect, self.extent.reach(extent.centre));
        self.change(|pose, _| extent.frame(pose, aspect, reach));
    }

    /// Between a pinhole and parallel rays; things at the target keep their size.
    pub fn switch_projection(&mut self) {
        let reach = self.extent.reach(self.pose.target);
        self.change(|pose, _| pose.switch_projection(reach));
    }

    /// What a drag with the left button turns about; with Ctrl held it is the other.
    pub fn turns(&self) -> Turns {
        self.turns
    }

    /// Chooses that.
    pub fn set_turns(&mut self, turns: Turns) {
        self.turns = turns;
    }

    /// Looks through a camera as it is.
    ///
    /// # Errors
    /// A sentence where it cannot be rendered from; then nothing changes.
    pub fn set(&mut self, camera: Camera) -> Result<(), String> {
        let mut pose = Pose::of(&camera, &self.world).ok_or(
            "the camera needs finite coordinates, an eye apart from its target, and a field of view of more than 0 and \
             less than 180 degrees",
        )?;
        if !self.aimed && (camera == self.home || self.cameras.contains(&camera)) {
            pose.aim_near(self.extent.centre, &self.world);
        }
        (self.camera, self.pose) = (camera, pose);
        Ok(())
    }

    /// Names of the scene's cameras, by which people tell them apart.
    pub fn names(&self) -> Vec<String> {
        let name = |(index, camera): (usize, &Camera)| format!("{index} {}", camera.name).trim_end().to_owned();
        self.cameras.iter().enumerate().map(name).collect()
    }

    /// Which of the scene's cameras was looked through last.
    pub fn chosen(&self) -> Option<usize> {
        self.chosen
    }

    /// Looks through one of the scene's cameras.
    ///
    /// # Errors
    /// As [`set`](Self::set), and where there is no such camera.
    pub fn choose(&mut self, index: usize) -> Result<(), String> {
        let camera = self.cameras.get(index).cloned().ok_or_else(|| format!("the scene has no camera {index}"))?;
        self.chosen = Some(index);
        self.set(camera)
    }

    /// A decimal hundredth of the scene: what one notch of a drag of a coordinate changes.
    pub fn step_length(&self) -> f32 {
        10f64.powf((0.02 * self.extent.radius).log10().floor()) as f32
    }

    /// The move in world space that takes a point, as seen, from one place of the picture to another, without changing
    /// how far away it is; places are shares of the picture. None for a point behind a pinhole.
    pub fn shift(&self, point: [f32; 3], from: [f32; 2], to: [f32; 2], aspect: f32) -> Option<[f32; 3]> {
        let [right, up, forward] = self.pose.axes(&self.world);
        let depth = (vec(point) - vec(self.camera.eye)).dot(forward);
        let height = match self.pose.projection {
            Projection::Perspective { fov_y } => 2.0 * depth * (0.5 * f64::from(fov_y)).tan(),
            Projection::Orthographic { height } => f64::from(height),
        };
        let by = [0, 1].map(|i| f64::from(to[i]) - f64::from(from[i]));
        let shift = (right * (by[0] * f64::from(aspect)) - up * by[1]) * height;
        (height > 0.0 && shift.is_finite()).then(|| shift.as_vec3().to_array())
    }

    fn step_camera(&mut self, by: usize) {
        let count = self.cameras.len();
        if count == 0 {
            return;
        }
        // From none, a step back leads to the last and a step on to the first.
        let next = self.chosen.map_or(if by == 1 { 0 } else { count - 1 }, |chosen| (chosen + by) % count);
        // One that cannot be rendered from is passed over.
        let _ = self.choose(next);
    }

    /// Changes the pose within its limits; whether the camera is another.
    fn change(&mut self, change: impl FnOnce(&mut Pose, &World)) -> bool {
        let mut pose = self.pose;
        change(&mut pose, &self.world);
        if pose == self.pose {
            return false;
        }
        self.extent.limit(&mut pose, &self.pose);
        let camera = pose.camera(&self.world, &self.camera.name);
        if !is_usable(&camera) || !pose.distance.is_finite() {
            return false;
        }
        self.pose = pose;
        std::mem::replace(&mut self.camera, camera) != self.camera
    }
}

/// A camera from the front, right and above that sees all of an extent.
fn framed(extent: &Extent, world: &World) -> (Camera, Pose) {
    let mut pose = Pose {
        target: extent.centre,
        distance: extent.radius,
        yaw: 0.42,
        pitch: 0.31,
        roll: 0.0,
        projection: Projection::Perspective { fov_y: 0.7 },
        fov: 0.7,
    };
    extent.frame(&mut pose, 1.0, 0.0);
    (pose.camera(world, "framed"), pose)
}
