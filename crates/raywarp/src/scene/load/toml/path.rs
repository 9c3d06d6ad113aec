//! Camera paths of a scene file.

use serde::Deserialize;
use toml::Spanned;

use super::complaint::Complaint;
use super::file::{self, Name, Up, Vector};
use super::light;
use super::values::{FieldOfView, NonNegative, Positive};
use crate::scene::{CameraKey, CameraPath, PathError};

/// An entry of `[[paths]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Path {
    pub name: Option<Name>,
    #[serde(default)]
    pub closed: bool,
    pub duration: Option<Spanned<Positive>>,
    #[serde(default)]
    pub keys: Vec<Spanned<Key>>,
}

/// An entry of `[[paths.keys]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    pub time: Option<NonNegative>,
    pub eye: Vector,
    pub target: Vector,
    pub up: Option<Vector>,
    pub fov: Option<FieldOfView>,
    pub height: Option<Positive>,
}

/// A path as the file places it.
pub fn path(entry: &Spanned<Path>, up: Up) -> Result<CameraPath, Complaint> {
    let at = entry.span().start;
    let entry = entry.get_ref();
    let (times, returns) = times(entry, at)?;
    let mut keys: Vec<CameraKey> = Vec::with_capacity(entry.keys.len());
    for (written, time) in entry.keys.iter().zip(times) {
        let camera = camera(written, keys.last(), up)?;
        keys.push(CameraKey { time, camera });
    }
    let name = entry.name.as_ref().map(|name| name.get_ref().clone()).unwrap_or_default();
    CameraPath::new(name, keys, returns).map_err(|error| complaint(error, entry, at))
}

/// A key's camera. What it does not say is as in the key before.
fn camera(key: &Spanned<Key>, before: Option<&CameraKey>, up: Up) -> Result<crate::scene::Camera, Complaint> {
    let written = key.get_ref();
    let entry = file::Camera {
        name: None,
        eye: written.eye,
        target: written.target,
        up: written.up,
        fov: written.fov,
        height: written.height,
    };
    let mut camera = light::camera(&Spanned::new(key.span(), entry), up)?;
    if let Some(before) = before {
        if written.up.is_none() {
            camera.up = before.camera.up;
        }
        if written.fov.is_none() && written.height.is_none() {
            camera.projection = before.camera.projection;
        }
    }
    Ok(camera)
}

/// Seconds at each key, and when a closed path is back at the first.
fn times(path: &Path, at: usize) -> Result<(Vec<f32>, Option<f32>), Complaint> {
    let given: Vec<f32> = path.keys.iter().filter_map(|key| key.get_ref().time.map(|time| time.0)).collect();
    let duration = path.duration.as_ref().map(|duration| duration.get_ref().0);
    if given.is_empty() {
        return Ok(even_times(path, duration));
    }
    if let Some(key) = path.keys.iter().find(|key| key.get_ref().time.is_none()) {
        let read = "a key without time beside keys with one";
        return Err(Complaint::new(key.span().start, read, "time = seconds on every key, or on none"));
    }
    let first = given.first().copied().unwrap_or_default();
    match (&path.duration, path.closed) {
        (Some(duration), false) => {
            let read = "duration beside the times of keys";
            Err(Complaint::new(duration.span().start, read, "the times alone, or closed = true"))
        }
        (None, true) => {
            let read = "a closed path with times and no duration";
            Err(Complaint::new(at, read, "duration = seconds from the first key until it is back there"))
        }
        _ => Ok((given, duration.map(|duration| first + duration))),
    }
}

/// A second from key to key, unless the whole is to take some other time.
fn even_times(path: &Path, duration: Option<f32>) -> (Vec<f32>, Option<f32>) {
    let gaps = if path.closed { path.keys.len() } else { path.keys.len().saturating_sub(1) }.max(1) as f32;
    let whole = duration.unwrap_or(gaps);
    let times = (0..path.keys.len()).map(|key| whole * (key as f32 / gaps)).collect();
    (times, path.closed.then_some(whole))
}

fn complaint(error: PathError, path: &Path, at: usize) -> Complaint {
    let key_at = |key: usize| path.keys.get(key - 1).map_or(at, |key| key.span().start);
    match error {
        PathError::TooFewKeys(count) => {
            Complaint::new(at, format!("a camera path of {count} keys"), "at least 2 [[paths.keys]]")
        }
        PathError::Time(key) => {
            Complaint::new(key_at(key), "a key that is not later than the one before it", "times that increase")
        }
        PathError::Projection(key) => {
            let read = "a key with another kind of projection than the first";
            Complaint::new(key_at(key), read, "fov on all keys, or height on all keys")
        }
        PathError::Camera(key) => Complaint::new(key_at(key), "a key that shows nothing", "two points and a lens"),
        PathError::Return(_) => {
            let at = path.duration.as_ref().map_or(at, |duration| duration.span().start);
            Complaint::new(at, "a duration that ends before the last key", "one that is longer")
        }
    }
}
