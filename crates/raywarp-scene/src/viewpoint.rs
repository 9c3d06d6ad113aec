//! The view that somebody asks for, on a scene that has its own.

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
    /// The camera to look through: one of `cameras` if it is named, else `usual`, with what is to be different.
    ///
    /// # Errors
    /// [`UnknownCamera`] with the names of those that there are.
    pub fn of(&self, cameras: &[Camera], usual: &Camera) -> Result<Camera, UnknownCamera> {
        Ok(self.adjust(self.named(cameras)?.unwrap_or(usual).clone()))
    }

    /// The camera that is named, if one is.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn named<'a>(&self, cameras: &'a [Camera]) -> Result<Option<&'a Camera>, UnknownCamera> {
        self.camera.as_deref().map(|wanted| named(cameras, wanted)).transpose()
    }

    /// A camera with what is to be different about it.
    pub fn adjust(&self, mut camera: Camera) -> Camera {
        camera.eye = self.eye.unwrap_or(camera.eye);
        camera.target = self.target.unwrap_or(camera.target);
        camera.up = self.up.unwrap_or(camera.up);
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
            view.of(&cameras, &camera("usual")).map(|camera| camera.name).map_err(|error| error.to_string())
        };
        assert_eq!(chosen("door"), Ok("door".to_owned()));
        assert_eq!(chosen("0"), Ok("0".to_owned()));
        assert_eq!(chosen("2"), Ok(String::new()));
        assert_eq!(chosen("3"), Err("there is no camera '3'; the scene has 0 'door', 1 '0', 2 ''".to_owned()));
        assert_eq!(Viewpoint::default().of(&cameras, &camera("usual")), Ok(camera("usual")));
        let none = Viewpoint { camera: Some("x".to_owned()), ..Viewpoint::default() }.of(&[], &camera("usual"));
        assert!(none.unwrap_err().to_string().ends_with("; the scene has none"));
    }

    #[test]
    fn only_what_is_asked_for_differs() {
        let view = Viewpoint { eye: Some([1.0, 2.0, 3.0]), fov: Some(90.0), ..Viewpoint::default() };
        let expected = Camera {
            eye: [1.0, 2.0, 3.0],
            projection: Projection::Perspective { fov_y: std::f32::consts::FRAC_PI_2 },
            ..camera("a")
        };
        assert_eq!(view.adjust(camera("a")), expected);
        let parallel = Viewpoint { height: Some(2.0), ..view }.adjust(camera("a"));
        assert_eq!(parallel.projection, Projection::Orthographic { height: 2.0 });
    }
}
