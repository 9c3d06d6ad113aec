//! The camera that options ask for.

use raywarp::scene::{Camera, Projection};

use crate::options::RenderOptions;

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

/// The camera with what options change about it.
pub fn adjusted(mut camera: Camera, options: &RenderOptions) -> Camera {
    camera.eye = options.eye.unwrap_or(camera.eye);
    camera.target = options.target.unwrap_or(camera.target);
    camera.up = options.up.unwrap_or(camera.up);
    if let Some(degrees) = options.fov {
        camera.projection = Projection::Perspective { fov_y: degrees.to_radians() };
    }
    camera
}
