//! The view that somebody asks for, on a scene that has its own.

use std::str::FromStr;

use super::{radians, Camera, Projection};

/// A camera by its name or number, and what is to be different about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Viewpoint {
    /// A camera of the scene: its name, else its number from 0. None: the one that the scene is shown from.
    pub camera: Option<String>,
    /// Where it is.
    pub eye: Option<[f32; 3]>,
    /// What it looks at.
    pub target: Option<[f32; 3]>,
    /// What is up in the picture.
    pub up: Option<[f32; 3]>,
    /// Vertical field of view, in degrees.
    pub fov: Option<f64>,
    /// Height of a picture by parallel rays, in scene units; counts more than `fov`.
    pub height: Option<f32>,
    /// The scene is framed, whatever cameras it has, from this side.
    pub side: Option<Side>,
    /// It is framed from so many degrees about its upward axis, from its front to its right.
    pub azimuth: Option<f64>,
    /// It is framed from so many degrees above its horizon, -90 to 90.
    pub elevation: Option<f64>,
    /// It is framed, and so many times as large as a whole view of it.
    pub zoom: Option<f64>,
    /// Where it is framed it stays in sight as the camera turns about its upward axis.
    pub turning: bool,
    /// Which way is up in the scene itself: see [`Scene::up`](crate::Scene::up).
    pub scene_up: Option<[f32; 3]>,
}

/// A side that a scene is framed from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Where +Z points at the eye, with +Y up.
    Front,
    /// Opposite of it.
    Back,
    /// Where -X points at the eye.
    Left,
    /// Where +X points at the eye.
    Right,
    /// From above.
    Top,
    /// From below.
    Bottom,
}

impl Side {
    /// Every side.
    pub const ALL: [Self; 6] = [Self::Front, Self::Back, Self::Left, Self::Right, Self::Top, Self::Bottom];

    /// The name that [`FromStr`] reads.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Left => "left",
            Self::Right => "right",
            Self::Top => "top",
            Self::Bottom => "bottom",
        }
    }

    /// Azimuth and elevation in degrees.
    pub const fn angles(self) -> [f64; 2] {
        match self {
            Self::Front => [0.0, 0.0],
            Self::Back => [180.0, 0.0],
            Self::Left => [-90.0, 0.0],
            Self::Right => [90.0, 0.0],
            Self::Top => [0.0, 90.0],
            Self::Bottom => [0.0, -90.0],
        }
    }
}

/// A name that belongs to no side.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no side; expected front, back, left, right, top or bottom")]
pub struct UnknownSide(pub String);

impl FromStr for Side {
    type Err = UnknownSide;

    fn from_str(name: &str) -> Result<Self, UnknownSide> {
        Self::ALL.into_iter().find(|side| side.name() == name).ok_or_else(|| UnknownSide(name.to_owned()))
    }
}

/// A camera that the scene does not have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no camera '{wanted}'; {}",
    if names.is_empty() { "the scene has none".to_owned() }
    else { format!("the scene has {}", names.join(", ")) }
)]
pub struct UnknownCamera {
    /// What was asked for.
    pub wanted: String,
    /// Numbers and names of those that there are.
    pub names: Vec<String>,
}

impl Viewpoint {
    /// The camera that is named, if one is.
    ///
    /// # Errors
    /// [`UnknownCamera`] with the names of those that there are.
    pub fn named<'a>(&self, cameras: &'a [Camera]) -> Result<Option<&'a Camera>, UnknownCamera> {
        self.camera.as_deref().map(|wanted| named(cameras, wanted)).transpose()
    }

    /// Whether a view of the whole scene is asked for, instead of one of its cameras.
    pub fn frames(&self) -> bool {
        self.side.is_some() || self.azimuth.is_some() || self.elevation.is_some() || self.zoom.is_some()
    }

    /// What is up in a picture whose camera is not one of the scene's.
    pub fn upward(&self) -> [f32; 3] {
        self.up.or(self.scene_up).unwrap_or([0.0, 1.0, 0.0])
    }

    /// A camera with what is to be different about it. One that is put elsewhere stands upright, unless it is named or told
    /// what is up: a file's own camera may be tilted for what it sees from its own place.
    pub fn adjust(&self, mut camera: Camera) -> Camera {
        if self.up.is_some() || self.eye.is_some() && self.camera.is_none() {
            camera.up = self.upward();
        }
        camera.eye = self.eye.unwrap_or(camera.eye);
        camera.target = self.target.unwrap_or(camera.target);
        if let Some(degrees) = self.fov {
            camera.projection = Projection::Perspective { fov_y: radians(degrees) };
        }
        if let Some(height) = self.height {
            camera.projection = Projection::Orthographic { height };
        }
        camera
    }
}

fn named<'a>(cameras: &'a [Camera], wanted: &str) -> Result<&'a Camera, UnknownCamera> {
    let by_name = cameras.iter().find(|camera| camera.name == wanted);
    let by_index = || wanted.parse::<usize>().ok().and_then(|index| cameras.get(index));
    by_name.or_else(by_index).ok_or_else(|| {
        let name = |(index, camera): (usize, &Camera)| format!("{index} '{}'", camera.name);
        UnknownCamera { wanted: wanted.to_owned(), names: cameras.iter().enumerate().map(name).collect() }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(name: &str) -> Camera {
        let projection = Projection::Perspective { fov_y: 0.5 };
        Camera { name: name.to_owned(), eye: [0.0; 3], target: [0.0; 3], up: [0.0; 3], projection }
    }

    #[test]
    fn cameras_go_by_name_then_by_number() {
        let cameras = [camera("door"), camera("0"), camera("")];
        let chosen = |wanted: &str| {
            let view = Viewpoint { camera: Some(wanted.to_owned()), ..Viewpoint::default() };
            view.named(&cameras).map(|camera| camera.unwrap().name.clone()).map_err(|error| error.to_string())
        };
        assert_eq!(chosen("door"), Ok("door".to_owned()));
        assert_eq!(chosen("0"), Ok("0".to_owned()));
        assert_eq!(chosen("2"), Ok(String::new()));
        assert_eq!(chosen("3"), Err("there is no camera '3'; the scene has 0 'door', 1 '0', 2 ''".to_owned()));
        assert_eq!(Viewpoint::default().named(&cameras), Ok(None));
        let none = Viewpoint { camera: Some("x".to_owned()), ..Viewpoint::default() };
        assert!(none.named(&[]).unwrap_err().to_string().ends_with("; the scene has none"));
    }

    #[test]
    fn sides_have_names() {
        for side in Side::ALL {
            assert_eq!(side.name().parse(), Ok(side));
        }
        assert_eq!("inside".parse::<Side>(), Err(UnknownSide("inside".to_owned())));
        let view = Viewpoint { elevation: Some(10.0), ..Viewpoint::default() };
        assert!(view.frames() && !Viewpoint::default().frames());
    }

    #[test]
    fn a_camera_put_elsewhere_stands_upright_unless_it_is_asked_for() {
        let tilted = Camera { up: [1.0, 0.5, 0.0], ..camera("tilted") };
        let up = |view: &Viewpoint| view.adjust(tilted.clone()).up;
        let elsewhere = Viewpoint { eye: Some([3.0; 3]), ..Viewpoint::default() };
        assert_eq!(up(&elsewhere), [0.0, 1.0, 0.0]);
        assert_eq!(up(&Viewpoint { camera: Some("tilted".to_owned()), ..elsewhere.clone() }), tilted.up);
        assert_eq!(up(&Viewpoint { up: Some([0.0, 0.0, 2.0]), ..elsewhere.clone() }), [0.0, 0.0, 2.0]);
        assert_eq!(up(&Viewpoint { scene_up: Some([0.0, 0.0, 1.0]), ..elsewhere }), [0.0, 0.0, 1.0]);
        assert_eq!(up(&Viewpoint { target: Some([3.0; 3]), ..Viewpoint::default() }), tilted.up);
    }

    #[test]
    fn only_what_is_asked_for_differs() {
        let view = Viewpoint { eye: Some([1.0, 2.0, 3.0]), fov: Some(90.0), ..Viewpoint::default() };
        let expected = Camera {
            eye: [1.0, 2.0, 3.0],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Perspective { fov_y: std::f32::consts::FRAC_PI_2 },
            ..camera("a")
        };
        assert_eq!(view.adjust(camera("a")), expected);
        let parallel = Viewpoint { height: Some(2.0), ..view }.adjust(camera("a"));
        assert_eq!(parallel.projection, Projection::Orthographic { height: 2.0 });
    }
}
