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
///
/// # Errors
/// Where it would look nowhere, or have no up.
pub fn adjusted(mut camera: Camera, options: &RenderOptions) -> anyhow::Result<Camera> {
    camera.eye = options.eye.unwrap_or(camera.eye);
    camera.target = options.target.unwrap_or(camera.target);
    camera.up = options.up.unwrap_or(camera.up);
    if let Some(degrees) = options.fov {
        camera.projection = Projection::Perspective { fov_y: degrees.to_radians() };
    }
    let view = [0, 1, 2].map(|axis| f64::from(camera.target[axis]) - f64::from(camera.eye[axis]));
    let up = camera.up.map(f64::from);
    let point = |p: [f32; 3]| format!("{},{},{}", p[0], p[1], p[2]);
    anyhow::ensure!(
        length(view) > 0.0,
        "the camera is at {} and looks at the same point: give another --eye or --target",
        point(camera.eye)
    );
    anyhow::ensure!(
        length(cross(view, up)) > 1e-6 * length(view) * length(up),
        "the camera looks along its up direction {}: give another --up, or move --eye aside",
        point(camera.up)
    );
    Ok(camera)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
