//! A camera as options of `raywarp render`.

use raywarp::scene::{Camera, Projection};

/// Options that give exactly this camera: each number is read back to the same bits.
pub(super) fn flags(camera: &Camera) -> String {
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(vector);
    let lens = match camera.projection {
        Projection::Perspective { fov_y } => format!("--fov {}", raywarp::scene::degrees(fov_y)),
        Projection::Orthographic { height } => format!("--ortho {}", number(height)),
    };
    format!("--eye {eye} --target {target} --up {up} {lens}")
}

fn vector(v: [f32; 3]) -> String {
    v.map(number).join(",")
}

/// The shortest decimal that is read back as this number.
fn number(x: f32) -> String {
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}
