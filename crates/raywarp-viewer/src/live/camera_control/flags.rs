//! A camera as options of `raywarp render`.

use raywarp::scene::{axis_name, Camera, Projection};

/// Options that give exactly this camera, in a scene with this direction up: each number is read back to the same bits.
pub(super) fn flags(camera: &Camera, scene_up: [f32; 3]) -> String {
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(vector);
    let lens = match camera.projection {
        Projection::Perspective { fov_y } => format!("--fov {}", raywarp::scene::degrees(fov_y)),
        Projection::Orthographic { height } => format!("--ortho {}", number(height)),
    };
    // By its name an axis is up in the scene too, which +Y is anyway.
    let turned = camera.up == scene_up && scene_up != [0.0, 1.0, 0.0];
    let up = axis_name(scene_up).filter(|_| turned).map_or(up, str::to_owned);
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
