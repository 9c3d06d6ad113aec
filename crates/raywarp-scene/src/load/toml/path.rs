//! Camera paths of a scene file.

use serde::Deserialize;
use toml::Spanned;

use super::complaint::Complaint;
use super::file::{self, Name, Up, Vector};
use super::light;
use super::values::{FieldOfView, NonNegative, Positive};
use crate::{CameraKey, CameraPath, PathError};

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
fn camera(key: &Spanned<Key>, before: Option<&CameraKey>, up: Up) -> Result<crate::Camera, Complaint> {
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

#[cfg(test)]
mod tests {
    use super::super::tests::{error, load_in, scene, TRIANGLE};
    use crate::{CameraPath, Projection};

    const KEY: &str = "[[paths.keys]]\ntarget = [0, 0, 0]\n";

    /// A path of three keys: what is said of the path, and of each key.
    fn text(path: &str, keys: [&str; 3]) -> String {
        let [a, b, c] = keys;
        format!(
            "version = 1\n[[paths]]\nname = \"p\"\n{path}\n{KEY}eye = [1, 0, 0]\n{a}\n{KEY}eye = [2, 0, 0]\n{b}\n\
             {KEY}eye = [3, 0, 0]\n{c}\n"
        )
    }

    fn path(path: &str, keys: [&str; 3]) -> CameraPath {
        scene(&text(path, keys)).paths.remove(0)
    }

    fn times(path: &CameraPath) -> Vec<f32> {
        path.keys().iter().map(|key| key.time).collect()
    }

    #[test]
    fn keys_are_a_second_apart_unless_the_file_says_when() {
        let even = path("", [""; 3]);
        assert_eq!((even.name(), times(&even), even.is_closed()), ("p", vec![0.0, 1.0, 2.0], false));
        assert_eq!(times(&path("duration = 4", [""; 3])), [0.0, 2.0, 4.0]);
        let timed = ["time = 1", "time = 2.5", "time = 9"];
        assert_eq!(times(&path("", timed)), [1.0, 2.5, 9.0]);
        let closed = path("closed = true\nduration = 6", [""; 3]);
        assert_eq!((times(&closed), closed.end()), (vec![0.0, 2.0, 4.0], 6.0));
        assert_eq!(path("closed = true", [""; 3]).end(), 3.0);
        assert_eq!(path("closed = true\nduration = 10", timed).end(), 11.0);
    }

    #[test]
    fn what_a_key_does_not_say_is_as_before() {
        let cameras = path("", ["", "fov = 90\nup = [0, 0, 2]", ""]);
        let fov = |degrees: f32| Projection::Perspective { fov_y: degrees.to_radians() };
        let seen: Vec<_> = cameras.keys().iter().map(|key| (key.camera.projection, key.camera.up)).collect();
        assert_eq!(seen, [(fov(45.0), [0.0, 1.0, 0.0]), (fov(90.0), [0.0, 0.0, 2.0]), (fov(90.0), [0.0, 0.0, 2.0])]);
        let flat = path("", ["height = 3", "", "height = 5"]);
        assert_eq!(flat.keys()[1].camera.projection, Projection::Orthographic { height: 3.0 });
    }

    #[test]
    fn paths_are_turned_upright_and_come_with_the_files_that_have_them() {
        let upright = scene(&text("", [""; 3]).replace("version = 1", "version = 1\nup = \"+Z\"")).paths.remove(0);
        assert_eq!(upright.keys()[0].camera.up, [0.0, 1.0, 0.0]);
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("inner.toml"), format!("{}{TRIANGLE}", text("", [""; 3]))).unwrap();
        let place = "mesh = \"m\"\ntranslate = [0, 5, 0]";
        let outer = format!(
            "{}[[meshes]]\nname = \"m\"\nfile = \"inner.toml\"\n[[instances]]\n{place}\n[[instances]]\n{place}\n",
            text("", [""; 3]).replace("\"p\"", "\"own\"")
        );
        let paths = load_in(directory.path(), &outer).unwrap().scene.paths;
        assert_eq!(paths.iter().map(CameraPath::name).collect::<Vec<_>>(), ["own", "p"]);
        assert_eq!(paths[1].at(0.0).eye, [1.0, 5.0, 0.0]);
        let without = outer.replace("file = ", "cameras = false\nfile = ");
        assert_eq!(load_in(directory.path(), &without).unwrap().scene.paths.len(), 1);
    }

    #[test]
    fn errors_say_where_what_and_what_instead() {
        let cases = [
            (text("", ["time = 1", "", ""]), "scene.toml:9:1: a key without time beside keys with one; expected time"),
            (text("", ["time = 1", "time = 1", "time = 2"]), "scene.toml:9:1: a key that is not later"),
            (text("duration = 3", ["time = 0", "time = 1", "time = 2"]), "scene.toml:4:12: duration beside the times"),
            (text("closed = true", ["time = 0", "time = 1", "time = 2"]), "scene.toml:2:1: a closed path with times"),
            (text("closed = true\nduration = 2", ["time = 0", "time = 1", "time = 2"]), "ends before the last key"),
            (text("duration = 0", [""; 3]), "expected a number above 0"),
            (text("", ["", "height = 1", ""]), "another kind of projection"),
            (text("", ["", "height = 1\nfov = 9", ""]), "a camera with fov and height"),
            (text("", ["", "up = [0, 0, 0]", ""]), "whose up is zero"),
            (text("", ["", "tme = 1", ""]), "Did you mean 'time'?"),
            (text("", [""; 3]).replace("eye = [2, 0, 0]", "eye = [0, 0, 0]"), "looks at its own place"),
            (text("", [""; 3]).replace("eye = [2, 0, 0]", ""), "the key 'eye' is missing"),
            ("version = 1\n[[paths]]\n".to_owned(), "scene.toml:2:1: a camera path of 0 keys; expected at least 2"),
            (format!("version = 1\n[[paths]]\n{KEY}eye = [1,0,0]\n"), "a camera path of 1 keys"),
            (format!("{}[[paths]]\nname = \"p\"\n", text("", [""; 3])), "a second path 'p'"),
        ];
        for (text, expected) in cases {
            let error = error(&text);
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
