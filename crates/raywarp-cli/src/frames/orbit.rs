//! Turntables: a camera turned about a point.

use raywarp::scene::Camera;

/// A camera on its way around a point.
#[derive(Clone, Debug)]
pub struct Orbit {
    /// Where it starts.
    pub camera: Camera,
    /// What it turns about.
    pub centre: [f32; 3],
    /// Which way is up: the turn is counter-clockwise seen from there. Not zero.
    pub axis: [f32; 3],
}

impl Orbit {
    /// The camera after a turn.
    pub fn turned(&self, degrees: f64) -> Camera {
        // A whole turn is none, to the bit.
        let degrees = degrees % 360.0;
        if degrees == 0.0 {
            return self.camera.clone();
        }
        let turn = |vector: [f64; 3]| rotated(vector, self.axis.map(f64::from), degrees.to_radians());
        let place = |point: [f32; 3]| {
            let arm = turn([0, 1, 2].map(|axis| f64::from(point[axis]) - f64::from(self.centre[axis])));
            [0, 1, 2].map(|axis| (f64::from(self.centre[axis]) + arm[axis]) as f32)
        };
        Camera {
            eye: place(self.camera.eye),
            target: place(self.camera.target),
            up: turn(self.camera.up.map(f64::from)).map(|x| x as f32),
            ..self.camera.clone()
        }
    }
}

/// The point of a camera's line of sight that is nearest to another, if it is before the camera; else its target.
pub fn nearest_in_sight(camera: &Camera, point: [f32; 3]) -> [f32; 3] {
    let view = [0, 1, 2].map(|axis| f64::from(camera.target[axis]) - f64::from(camera.eye[axis]));
    let arm = [0, 1, 2].map(|axis| f64::from(point[axis]) - f64::from(camera.eye[axis]));
    let share = dot(view, arm) / dot(view, view);
    if share > 0.0 && share.is_finite() {
        [0, 1, 2].map(|axis| (f64::from(camera.eye[axis]) + share * view[axis]) as f32)
    } else {
        camera.target
    }
}

/// By Rodrigues' formula.
fn rotated(vector: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
    let length = dot(axis, axis).sqrt();
    let unit = axis.map(|coordinate| coordinate / length);
    let [x, y, z] = unit;
    let cross = [y * vector[2] - z * vector[1], z * vector[0] - x * vector[2], x * vector[1] - y * vector[0]];
    let (sin, cos) = angle.sin_cos();
    let along = dot(unit, vector) * (1.0 - cos);
    [0, 1, 2].map(|i| vector[i] * cos + cross[i] * sin + unit[i] * along)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use raywarp::scene::Projection;

    use super::*;

    fn orbit(axis: [f32; 3]) -> Orbit {
        let projection = Projection::Perspective { fov_y: 0.7 };
        let camera = Camera {
            name: "c".into(),
            eye: [3.0, 2.0, 4.0],
            target: [1.0, 0.5, -1.0],
            up: [0.1, 1.0, 0.0],
            projection,
        };
        Orbit { centre: camera.target, camera, axis }
    }

    fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
        let d = [0, 1, 2].map(|axis| f64::from(a[axis]) - f64::from(b[axis]));
        dot(d, d).sqrt()
    }

    #[test]
    fn a_quarter_turn_goes_to_the_right_and_keeps_height_and_distance() {
        let orbit = orbit([0.0, 2.0, 0.0]);
        let turned = orbit.turned(90.0);
        // From the front, +Z, to the right, +X.
        assert!(distance(turned.eye, [6.0, 2.0, -3.0]) < 1e-6, "{:?}", turned.eye);
        assert_eq!(turned.target, orbit.camera.target);
        assert!(distance(turned.up, [0.0, 1.0, -0.1]) < 1e-6, "{:?}", turned.up);
    }

    #[test]
    fn an_orbit_closes() {
        let orbit = orbit([1.0, 2.0, 3.0]);
        for degrees in [0.0, 360.0, -720.0] {
            assert_eq!(orbit.turned(degrees), orbit.camera);
        }
        let mut longest: f64 = 0.0;
        let radius = distance(orbit.camera.eye, orbit.centre);
        for step in 0..100 {
            let (a, b) = (orbit.turned(3.6 * f64::from(step)), orbit.turned(3.6 * f64::from(step + 1)));
            assert!((distance(a.eye, orbit.centre) - radius).abs() < 1e-5);
            longest = longest.max(distance(a.eye, b.eye));
        }
        assert!(longest < radius * 3.7f64.to_radians(), "{longest}");
    }

    #[test]
    fn the_line_of_sight_is_followed_to_what_is_near() {
        let mut camera = orbit([0.0, 1.0, 0.0]).camera;
        (camera.eye, camera.target) = ([0.0, 0.0, 5.0], [0.0, 0.0, 4.0]);
        assert!(distance(nearest_in_sight(&camera, [3.0, 7.0, -2.0]), [0.0, 0.0, -2.0]) < 1e-6);
        assert_eq!(nearest_in_sight(&camera, [0.0, 0.0, 9.0]), camera.target);
        camera.target = camera.eye;
        assert_eq!(nearest_in_sight(&camera, [0.0; 3]), camera.target);
    }
}
