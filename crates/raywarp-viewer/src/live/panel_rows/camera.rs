//! The camera in numbers.

use raywarp::scene::{Camera, Projection};

use super::{checked, is_meant, row, Effect};
use crate::live::camera_control::{CameraControl, Turns};
use crate::live::{Control, Row, Section, Value};

const SECTION: &str = "camera";
const PERSPECTIVE: &str = "perspective";
const PARALLEL: &str = "parallel";
/// Degrees on the slider.
const ANGLES: [f32; 2] = [1.0, 150.0];

pub(super) fn section(control: &CameraControl) -> Section {
    Section { id: SECTION.to_owned(), title: "Camera".to_owned(), rows: rows(control) }
}

fn rows(control: &CameraControl) -> Vec<Row> {
    let cameras = [control.camera(), control.home()];
    let step = control.step_length();
    let named = Control::Choice { options: vec![PERSPECTIVE.to_owned(), PARALLEL.to_owned()] };
    let mut rows = Vec::new();
    let names = control.names();
    if !names.is_empty() {
        let chosen = control.chosen().and_then(|index| names.get(index).cloned()).unwrap_or_default();
        rows.push(row("camera.choice", "Of the scene", [Value::Text(chosen)], Control::Choice { options: names }));
    }
    let turns = [control.turns(), Turns::default()].map(|turns| Value::Text(turns.name().to_owned()));
    let options = Turns::ALL.map(|turns| turns.name().to_owned()).to_vec();
    rows.push(row("camera.turns", "A drag", turns, Control::Choice { options }));
    rows.push(row("camera.projection", "Projection", cameras.map(|c| Value::Text(kind(c).to_owned())), named));
    rows.push(lens(cameras));
    rows.push(row("camera.eye", "Eye", cameras.map(|c| Value::Triple(c.eye)), Control::Vector { step }));
    rows.push(row("camera.target", "Target", cameras.map(|c| Value::Triple(c.target)), Control::Vector { step }));
    rows
}

/// The angle of a pinhole, or the height of a picture by parallel rays.
fn lens([now, home]: [&Camera; 2]) -> Row {
    let same = kind(now) == kind(home);
    let home = if same { home } else { now };
    match now.projection {
        Projection::Perspective { .. } => {
            let [angle, usual] = [now, home].map(angle_or_height);
            let control = Control::Number { min: ANGLES[0].min(angle), max: ANGLES[1].max(angle), step: 0.0 };
            row("camera.fov", "Field of view", [angle, usual].map(Value::Number), control)
        }
        Projection::Orthographic { .. } => {
            let [height, usual] = [now, home].map(angle_or_height);
            let control = Control::Number { min: 0.01 * height, max: (100.0 * height).min(f32::MAX), step: 0.0 };
            row("camera.height", "Height of the picture", [height, usual].map(Value::Number), control)
        }
    }
}

pub(super) fn set(control: &mut CameraControl, id: &str, value: &Value) -> Result<Effect, String> {
    checked(&rows(control), id, value)?;
    let mut camera = control.camera().clone();
    match (id, value) {
        ("camera.choice", Value::Text(name)) => {
            let index = control.names().iter().position(|other| other == name);
            control.choose(index.ok_or_else(|| format!("there is no camera '{name}'"))?)?;
            return Ok(Effect::Picture);
        }
        ("camera.turns", Value::Text(name)) => {
            let turns = Turns::ALL.into_iter().find(|turns| turns.name() == name);
            control.set_turns(turns.ok_or_else(|| format!("a drag cannot '{name}'"))?);
            return Ok(Effect::Overlay);
        }
        ("camera.projection", Value::Text(name)) => {
            if name != kind(&camera) {
                control.switch_projection();
            }
            return Ok(Effect::Picture);
        }
        ("camera.fov", Value::Number(degrees)) => {
            camera.projection = Projection::Perspective { fov_y: f64::from(*degrees).to_radians() as f32 }
        }
        ("camera.height", Value::Number(height)) => camera.projection = Projection::Orthographic { height: *height },
        ("camera.eye", Value::Triple(eye)) => camera.eye = *eye,
        ("camera.target", Value::Triple(target)) => camera.target = *target,
        _ => return Err(format!("'{id}' cannot take this value")),
    }
    control.set(camera).map(|()| Effect::Picture)
}

pub(super) fn reset(control: &mut CameraControl, id: &str) -> Option<Effect> {
    let turned = is_meant(id, SECTION, "camera.turns") && control.turns() != Turns::default();
    if turned {
        control.set_turns(Turns::default());
    }
    let mut camera = control.camera().clone();
    let home = control.home();
    if is_meant(id, SECTION, SECTION) {
        camera = home.clone();
    }
    match id {
        "camera.projection" | "camera.fov" | "camera.height" => camera.projection = home.projection,
        "camera.eye" => camera.eye = home.eye,
        "camera.target" => camera.target = home.target,
        _ => {}
    }
    // One that stands on its own target is not taken: then nothing changes.
    let changed = camera != *control.camera();
    let moved = (changed && control.set(camera).is_ok()).then_some(Effect::Picture);
    moved.or(turned.then_some(Effect::Overlay))
}

fn kind(camera: &Camera) -> &'static str {
    match camera.projection {
        Projection::Perspective { .. } => PERSPECTIVE,
        Projection::Orthographic { .. } => PARALLEL,
    }
}

fn angle_or_height(camera: &Camera) -> f32 {
    match camera.projection {
        Projection::Perspective { fov_y } => raywarp::scene::degrees(fov_y) as f32,
        Projection::Orthographic { height } => height,
    }
}
