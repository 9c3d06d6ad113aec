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
    pub fov: Option<f64>,
    /// Height of a picture by parallel rays, in scene units.
    pub ortho: Option<f32>,
}

impl From<&RenderOptions> for View {
    fn from(options: &RenderOptions) -> Self {
        Self { eye: options.eye, target: options.target, up: options.up, fov: options.fov, ortho: options.ortho }
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
        camera.projection = Projection::Perspective { fov_y: radians(degrees) };
    }
    if let Some(height) = view.ortho {
        camera.projection = Projection::Orthographic { height };
    }
    camera
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use raywarp::scene::degrees;

    use super::*;

    fn asked(words: &[&str]) -> Result<Camera, clap::Error> {
        let options = RenderOptions::try_parse_from([&["render"], words].concat())?;
        let camera = Camera {
            name: String::new(),
            eye: [0.0; 3],
            target: [0.0; 3],
            up: [0.0; 3],
            projection: Projection::Perspective { fov_y: 0.5 },
        };
        Ok(adjusted(camera, &(&options).into()))
    }

    #[test]
    fn every_angle_can_be_asked_for() {
        for i in 1..2000 {
            let fov_y = 0.0015 * i as f32;
            let camera = asked(&["--fov", &degrees(fov_y).to_string()]).unwrap();
            assert_eq!(camera.projection, Projection::Perspective { fov_y });
        }
    }

    #[test]
    fn parallel_rays_have_a_height_and_no_angle() {
        let camera = asked(&["--eye", "-1e-9,2,3.5e20", "--ortho", "2.5"]).unwrap();
        assert_eq!((camera.eye, camera.projection), ([-1e-9, 2.0, 3.5e20], Projection::Orthographic { height: 2.5 }));
        assert!(asked(&["--ortho", "2.5", "--fov", "40"]).is_err());
        assert!(asked(&["--ortho", "0"]).is_err());
    }
}
