//! Flights of a camera: a curve through keys.
//!
//! Between two keys each of eye, target, up and lens is a cubic polynomial of time (Hermite's form). Its slope at a key
//! is that of the parabola through the key and its two neighbours, as in Catmull and Rom's curves where times are
//! uneven, but no longer than three times the shorter of the two chords: the curve does not swing past a key that comes
//! close after another, and stays where two keys are the same.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use super::{Camera, Projection};

/// A viewpoint at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraKey {
    /// In seconds.
    pub time: f32,
    /// What is seen then.
    pub camera: Camera,
}

/// A smooth way of a camera that passes exactly through its keys.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    name: String,
    keys: Vec<CameraKey>,
    returns: Option<f32>,
}

/// Why keys are no path. Keys are counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// One viewpoint is no way.
    #[error("a camera path of {0} keys; it has at least 2")]
    TooFewKeys(usize),
    /// Time stands still or runs backwards.
    #[error("key {0} is not later than the one before it")]
    Time(usize),
    /// Nothing is between a pinhole and parallel rays.
    #[error("key {0} has another kind of projection than the first")]
    Projection(usize),
    /// It shows nothing.
    #[error("key {0} has no direction or no lens to look through")]
    Camera(usize),
    /// A closed path ends before its last key.
    #[error("the path is back at its first key after {0} s, not later than its last key")]
    Return(f32),
}

/// What is interpolated, at one key: eye, target, unit up, and the logarithm of the lens.
type Tracks = [DVec3; 4];

impl CameraPath {
    /// A path through keys in the order of their times. With `returns`, a time in seconds, it is closed: from its last
    /// key it goes on to its first, where it is back at that time.
    ///
    /// # Errors
    /// [`PathError`] for fewer than two keys, times that do not increase, cameras without a direction or a lens, or
    /// perspective and parallel ones in one path.
    pub fn new(name: String, keys: Vec<CameraKey>, returns: Option<f32>) -> Result<Self, PathError> {
        if keys.len() < 2 {
            return Err(PathError::TooFewKeys(keys.len()));
        }
        let kind = keys.first().map(|key| std::mem::discriminant(&key.camera.projection));
        let mut before = f32::NEG_INFINITY;
        for (index, key) in keys.iter().enumerate() {
            if !key.time.is_finite() || key.time <= before {
                return Err(PathError::Time(index + 1));
            }
            before = key.time;
            if !is_usable(&key.camera) {
                return Err(PathError::Camera(index + 1));
            }
            if kind != Some(std::mem::discriminant(&key.camera.projection)) {
                return Err(PathError::Projection(index + 1));
            }
        }
        match returns {
            Some(time) if !time.is_finite() || time <= before => Err(PathError::Return(time)),
            _ => Ok(Self { name, keys, returns }),
        }
    }

    /// Name in the file, for `--path`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The keys, by their times.
    pub fn keys(&self) -> &[CameraKey] {
        &self.keys
    }

    /// Whether it ends where it begins.
    pub fn is_closed(&self) -> bool {
        self.returns.is_some()
    }

    /// Time of the first key, in seconds.
    pub fn start(&self) -> f64 {
        f64::from(self.keys[0].time)
    }

    /// Time of the last key, or of being back at the first, in seconds.
    pub fn end(&self) -> f64 {
        f64::from(self.returns.unwrap_or(self.keys[self.keys.len() - 1].time))
    }

    /// The camera at a time in seconds. Before and after an open path it stands at the ends; a closed one repeats.
    pub fn at(&self, time: f64) -> Camera {
        let time = self.within(time);
        let after = self.keys.partition_point(|key| f64::from(key.time) <= time);
        let key = after.saturating_sub(1);
        let camera = &self.keys[key].camera;
        let begin = f64::from(self.keys[key].time);
        if time <= begin || (after == self.keys.len() && !self.is_closed()) {
            return Camera { name: self.name.clone(), ..camera.clone() };
        }
        let length = self.gap(key);
        self.camera(self.between(key, (time - begin) / length))
    }

    /// The camera at a share of the whole way, in time: 0 is its first key, 1 its last or, of a closed path, the first
    /// again.
    pub fn at_share(&self, share: f64) -> Camera {
        if share >= 1.0 && !self.is_closed() {
            return self.at(self.end());
        }
        self.at(self.start() + share * (self.end() - self.start()))
    }

    /// The same path in other coordinates.
    pub fn moved(&self, change: impl Fn(&Camera) -> Camera) -> Self {
        let key = |key: &CameraKey| CameraKey { time: key.time, camera: change(&key.camera) };
        Self { keys: self.keys.iter().map(key).collect(), ..self.clone() }
    }

    /// A time on the path.
    fn within(&self, time: f64) -> f64 {
        let (start, end) = (self.start(), self.end());
        match time.is_finite() {
            false => start,
            true if self.is_closed() => start + (time - start).rem_euclid(end - start),
            true => time.clamp(start, end),
        }
    }

    /// Seconds from a key to the next.
    fn gap(&self, key: usize) -> f64 {
        self.keys.get(key + 1).map_or(self.end(), |next| f64::from(next.time)) - f64::from(self.keys[key].time)
    }

    fn tracks(&self, key: usize) -> Tracks {
        let camera = &self.keys[key].camera;
        let vector = |vector: [f32; 3]| Vec3::from(vector).as_dvec3();
        // Equal steps of a zoom are equal factors; and no sum of logarithms leaves the range of the lens.
        let lens = match camera.projection {
            Projection::Perspective { fov_y } => (0.5 * f64::from(fov_y)).tan().ln(),
            Projection::Orthographic { height } => f64::from(height).ln(),
        };
        let up = vector(camera.up).normalize_or(DVec3::Y);
        [vector(camera.eye), vector(camera.target), up, DVec3::new(lens, 0.0, 0.0)]
    }

    /// The tracks at a share of the way from a key to the next.
    fn between(&self, key: usize, share: f64) -> Tracks {
        let next = (key + 1) % self.keys.len();
        let (a, b, length) = (self.tracks(key), self.tracks(next), self.gap(key));
        let (from, to) = (self.slopes(key), self.slopes(next));
        let rest = 1.0 - share;
        [0, 1, 2, 3].map(|track| {
            let chord = b[track] - a[track];
            let swing = (from[track] * length - chord) * rest - (to[track] * length - chord) * share;
            a[track] + chord * share + swing * (share * rest)
        })
    }

    /// Change of the tracks a second at a key.
    fn slopes(&self, key: usize) -> Tracks {
        let last = self.keys.len() - 1;
        match (key, self.is_closed()) {
            (0, false) => self.end_slopes(0, 1),
            (_, false) if key == last => self.end_slopes(last - 1, last - 1),
            _ => self.inner_slopes(key),
        }
    }

    /// Slopes of the chords from a key to the next.
    fn chords(&self, key: usize) -> Tracks {
        let (a, b) = (self.tracks(key), self.tracks((key + 1) % self.keys.len()));
        [0, 1, 2, 3].map(|track| (b[track] - a[track]) / self.gap(key))
    }

    fn inner_slopes(&self, key: usize) -> Tracks {
        let before = (key + self.keys.len() - 1) % self.keys.len();
        let (past, coming) = (self.chords(before), self.chords(key));
        let (long, short) = (self.gap(before), self.gap(key));
        [0, 1, 2, 3].map(|track| {
            let slope = (past[track] * short + coming[track] * long) / (long + short);
            slope.clamp_length_max(3.0 * past[track].length().min(coming[track].length()))
        })
    }

    /// At an end the curve is straight: without a bend of its own, given its only `chord` and the key `inside`.
    fn end_slopes(&self, chord: usize, inside: usize) -> Tracks {
        let chords = self.chords(chord);
        if self.keys.len() == 2 {
            return chords;
        }
        let inner = self.inner_slopes(inside);
        [0, 1, 2, 3].map(|track| {
            let slope = chords[track] * 1.5 - inner[track] * 0.5;
            slope.clamp_length_max(3.0 * chords[track].length())
        })
    }

    fn camera(&self, [eye, target, up, lens]: Tracks) -> Camera {
        let narrow = |vector: DVec3| vector.as_vec3().to_array();
        let projection = match self.keys[0].camera.projection {
            Projection::Perspective { .. } => Projection::Perspective { fov_y: (2.0 * lens.x.exp().atan()) as f32 },
            Projection::Orthographic { .. } => Projection::Orthographic { height: lens.x.exp() as f32 },
        };
        Camera { name: self.name.clone(), eye: narrow(eye), target: narrow(target), up: narrow(up), projection }
    }
}

fn is_usable(camera: &Camera) -> bool {
    let finite = [camera.eye, camera.target, camera.up].iter().flatten().all(|x| x.is_finite());
    let lens = match camera.projection {
        Projection::Perspective { fov_y } => fov_y > 0.0 && fov_y < PI,
        Projection::Orthographic { height } => height > 0.0 && height.is_finite(),
    };
    finite && lens && camera.eye != camera.target && camera.up != [0.0; 3]
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    fn key(time: f32, eye: [f32; 3], target: [f32; 3], fov_y: f32) -> CameraKey {
        let projection = Projection::Perspective { fov_y };
        CameraKey { time, camera: Camera { name: String::new(), eye, target, up: [0.0, 1.0, 0.0], projection } }
    }

    fn path(eyes: &[[f32; 3]], gaps: &[f32], closed: bool) -> CameraPath {
        let mut time = 0.0;
        let mut keys = Vec::new();
        for (index, (&eye, gap)) in eyes.iter().zip(gaps).enumerate() {
            keys.push(key(time, eye, [0.0, 0.0, 500.0 + index as f32], 0.2 + 0.2 * index as f32));
            time += gap;
        }
        CameraPath::new("p".to_owned(), keys, closed.then_some(time)).unwrap()
    }

    fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
        Vec3::from(a).distance(b.into())
    }

    fn keys() -> impl Strategy<Value = (Vec<[f32; 3]>, Vec<f32>, bool)> {
        let eye = [-100.0f32..100.0, -100.0f32..100.0, -100.0f32..100.0];
        (vec(eye, 2..8), vec(0.01f32..10.0, 8), any::<bool>())
    }

    proptest! {
        #[test]
        fn a_path_goes_through_its_keys((eyes, gaps, closed) in keys()) {
            let path = path(&eyes, &gaps, closed);
            for key in path.keys() {
                let there = path.at(f64::from(key.time));
                prop_assert_eq!((there.eye, there.target, there.up), (key.camera.eye, key.camera.target, key.camera.up));
                prop_assert_eq!(there.projection, key.camera.projection);
            }
            prop_assert_eq!(path.at_share(0.0).eye, eyes[0]);
            prop_assert_eq!(path.at_share(1.0).eye, if closed { eyes[0] } else { eyes[eyes.len() - 1] });
        }

        #[test]
        fn a_path_is_smooth((eyes, gaps, closed) in keys()) {
            let path = path(&eyes, &gaps, closed);
            let shortest = (0..eyes.len()).map(|key| path.gap(key)).filter(|&gap| gap > 0.0).fold(f64::MAX, f64::min);
            let step = 1e-3 * shortest;
            let eye = |time: f64| path.between_eye(time);
            // Across every key the velocity before is the velocity after.
            let first = usize::from(!closed);
            for key in &path.keys()[first..eyes.len() - first] {
                let time = f64::from(key.time);
                let (before, after) = ((eye(time) - eye(time - step)) / step, (eye(time + step) - eye(time)) / step);
                // A cubic's slope changes by at most its second derivative, which three chords' slopes bound.
                let fastest = (0..eyes.len()).map(|key| path.chords(key)[0].length()).filter(|x| x.is_finite()).fold(0.0, f64::max);
                prop_assert!((after - before).length() <= 0.05 * fastest + 1e-6, "{before} {after}");
            }
        }

        #[test]
        fn a_path_stays_near_its_keys((eyes, gaps, closed) in keys(), share in 0.0f64..1.0) {
            let path = path(&eyes, &gaps, closed);
            let camera = path.at_share(share);
            let size = eyes.iter().flatten().fold(0.0f32, |size, x| size.max(x.abs()));
            prop_assert!(camera.eye.iter().all(|x| x.abs() <= 4.0 * size + 1e-3), "{:?}", camera.eye);
            let Projection::Perspective { fov_y } = camera.projection else { unreachable!() };
            prop_assert!(fov_y > 0.0 && fov_y < PI);
        }
    }

    impl CameraPath {
        /// The eye before it is rounded.
        fn between_eye(&self, time: f64) -> DVec3 {
            let time = self.within(time);
            let key = self.keys.partition_point(|key| f64::from(key.time) <= time).saturating_sub(1);
            if key + 1 == self.keys.len() && !self.is_closed() {
                return self.tracks(key)[0];
            }
            self.between(key, (time - f64::from(self.keys[key].time)) / self.gap(key))[0]
        }
    }

    #[test]
    fn equal_keys_are_a_rest() {
        let (a, b) = ([0.0, 0.0, 0.0], [4.0, 2.0, 0.0]);
        let path = path(&[a, b, b, a], &[1.0; 4], false);
        for time in [1.0, 1.25, 1.5, 1.99, 2.0] {
            assert_eq!(path.at(time).eye, b, "{time}");
        }
        assert!(path.at(0.5).eye != a && path.at(2.5).eye != b);
    }

    #[test]
    fn two_keys_are_a_straight_line_at_constant_speed() {
        let path = path(&[[0.0; 3], [8.0, 0.0, 4.0]], &[2.0, 1.0], false);
        assert!(distance(path.at(0.5).eye, [2.0, 0.0, 1.0]) < 1e-6);
        assert_eq!(path.at(-1.0), path.at(0.0));
        assert_eq!(path.at(9.0).eye, [8.0, 0.0, 4.0]);
        assert_eq!(path.at(f64::NAN).eye, [0.0; 3]);
    }

    #[test]
    fn a_closed_path_repeats() {
        let path = path(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]], &[1.0; 4], true);
        assert_eq!(path.at(4.0), path.at(0.0));
        assert!(
            distance(path.at(5.5).eye, path.at(1.5).eye) < 1e-6 && distance(path.at(-0.5).eye, path.at(3.5).eye) < 1e-6
        );
        // Four keys on a circle: between them the curve is near it.
        assert!((distance(path.at(3.5).eye, [0.0; 3]) - 1.0).abs() < 0.12);
    }

    #[test]
    fn what_is_no_path_is_refused() {
        let key = |time, eye, fov_y| key(time, eye, [0.0; 3], fov_y);
        let new = |keys: Vec<CameraKey>, returns| CameraPath::new(String::new(), keys, returns).unwrap_err();
        let (a, b) = ([1.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
        assert_eq!(new(vec![key(0.0, a, 1.0)], None), PathError::TooFewKeys(1));
        assert_eq!(new(vec![key(0.0, a, 1.0), key(0.0, b, 1.0)], None), PathError::Time(2));
        assert_eq!(new(vec![key(f32::NAN, a, 1.0), key(0.0, b, 1.0)], None), PathError::Time(1));
        assert_eq!(new(vec![key(0.0, a, 1.0), key(1.0, [0.0; 3], 1.0)], None), PathError::Camera(2));
        assert_eq!(new(vec![key(0.0, a, 4.0), key(1.0, b, 1.0)], None), PathError::Camera(1));
        assert_eq!(new(vec![key(0.0, a, 1.0), key(1.0, b, 1.0)], Some(1.0)), PathError::Return(1.0));
        let mut flat = key(1.0, b, 1.0);
        flat.camera.projection = Projection::Orthographic { height: 1.0 };
        assert_eq!(new(vec![key(0.0, a, 1.0), flat], None), PathError::Projection(2));
    }
}
