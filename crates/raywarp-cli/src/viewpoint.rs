//! The camera that options ask for.

use raywarp::scene::{radians, Camera, Projection};

use crate::options::RenderOptions;

/// What is to be different about a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct View {
    /// Where it is.
    pub eye: Option<[f32; 3]>,
    /// What it looks at.
    pub target: Option<[f32; 3]>,
    /// What is up in the picture.
    pub up: Option<[f32; 3]>,
    /// Vertical field of view, in degrees.
    pub fov: Option<f32>,
}

impl From<&RenderOptions> for View {
    fn from(options: &RenderOptions) -> Self {
        Self { eye: options.eye, target: options.target, up: options.up, fov: options.fov }
    }
}

/// A camera by its name, else by its number.
///
/// # Errors
/// Where there is none such, with the names of those that there are.
pub fn named<'a>(cameras: &'a [Camera], wanted: &str) -> anyhow::Result<&'a Camera> {
    let by_name = cameras.iter().find(|camera| camera.name == wanted);
    let by_index = || wanted.parse::<usize>().ok().and_then(|index| cameras.get(index));
    by_name.or_else(by_index).ok_or_else(|| match cameras {
        [] => anyhow::anyhow!("there is no camera '{wanted}': the scene has none; leave --camera out, or give --eye"),
        _ => anyhow::anyhow!("there is no camera '{wanted}'; the scene has {}", list(cameras)),
    })
}

fn list(cameras: &[Camera]) -> String {
    let name = |(index, camera): (usize, &Camera)| format!("{index} '{}'", camera.name);
    cameras.iter().enumerate().map(name).collect::<Vec<_>>().join(", ")
}

/// The camera with what is to be different about it.
pub fn adjusted(mut camera: Camera, view: &View) -> Camera {
    camera.eye = view.eye.unwrap_or(camera.eye);
    camera.target = view.target.unwrap_or(camera.target);
    camera.up = view.up.unwrap_or(camera.up);
    if let Some(degrees) = view.fov {
        camera.projection = Projection::Perspective { fov_y: radians(f64::from(degrees)) };
    }
    camera
}
