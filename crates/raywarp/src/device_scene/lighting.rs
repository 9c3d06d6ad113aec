//! The lights of a scene, or those that it gets when it has none.

use raywarp_core::background::Background;
use raywarp_core::light::{kind, Light};
use raywarp_core::math::{vec3, Vec3};

use crate::device::{Buffer, Device, DeviceError};
use crate::render::turn_to;
use crate::scene::settings::Integrator;
use crate::scene::{self, Camera, LightKind, Scene};

/// What lights the scene.
#[derive(Clone, Debug)]
pub(crate) struct Lighting {
    lights: Vec<Light>,
    /// A light at the eye, for scenes without any: no surface that is seen is black.
    headlight: Option<Vec3>,
    pub background: Background,
    /// Seen and lighting instead, for path tracing.
    pub environment: Option<scene::Environment>,
    /// Unit vector upwards, for that.
    pub up: Vec3,
    pub ambient: Vec3,
    pub whose_ambient: Ambient,
    /// Whether some material does.
    glows: bool,
}

/// The built-in sky, for scenes that say nothing of what lies beyond them.
const SKY: scene::Background =
    scene::Background { zenith: [0.25, 0.45, 0.80], horizon: [0.80, 0.87, 0.95], ground: [0.22, 0.21, 0.20] };

/// Ambient light of a scene that brings its own lights, and of one that does not.
const AMBIENT: [f32; 3] = [0.05; 3];
const AMBIENT_BUILT_IN: [f32; 3] = [0.25, 0.27, 0.30];

/// Whose ambient light shines on a scene, and so by what materials reflect it: the scene's own by their ambient colours,
/// which were chosen for it; the built-in one by their diffuse colours. Programs write ambient colours for no light that
/// they know, such as white for every material: lit by them, a scene lies in grey fog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ambient {
    Own,
    BuiltIn,
}

impl Ambient {
    pub fn of(scene: &Scene) -> Self {
        match scene.ambient {
            Some(_) => Self::Own,
            None => Self::BuiltIn,
        }
    }
}

impl Lighting {
    pub fn of(scene: &Scene) -> Self {
        let built_in = scene.lights.is_empty();
        let (sky, ambient) = (sky(scene), ambient(scene));
        Self {
            lights: if built_in { vec![upright_sun(scene)] } else { scene.lights.iter().map(light).collect() },
            headlight: built_in.then_some(Vec3::splat(0.35)),
            background: Background {
                zenith: sky.zenith.into(),
                horizon: sky.horizon.into(),
                ground: sky.ground.into(),
                // The file's own sky is in the file's own axes.
                up: if scene.background.is_none() { up(scene) } else { vec3(0.0, 1.0, 0.0) },
            },
            environment: scene.environment.clone(),
            up: up(scene),
            ambient: ambient.into(),
            whose_ambient: Ambient::of(scene),
            glows: scene.materials.iter().any(|material| material.emission != [0.0; 3]),
        }
    }

    /// The lights for path tracing: the scene's own, or the built-in sun where nothing glows and no environment is given. There
    /// is no headlight, as the sky lights from all around.
    pub fn path_lights(&self) -> Vec<Light> {
        match self.headlight.is_some() && (self.glows || self.environment.is_some()) {
            true => Vec::new(),
            false => self.lights.clone(),
        }
    }

    /// What an integrator adds by its own choice or leaves out, each a sentence without the full stop.
    pub fn notes(&self, integrator: Integrator) -> Vec<String> {
        let mut notes = Vec::new();
        let built_in = self.headlight.is_some();
        match integrator {
            Integrator::Whitted if built_in => notes.push(format!(
                "no lights in the scene{}: a built-in sun, headlight and sky light it",
                if self.glows { " but glowing surfaces, which this shading shows and does not light with" } else { "" }
            )),
            Integrator::Path if built_in && !self.path_lights().is_empty() => {
                notes.push("no lights in the scene: a built-in sun lights it, and what lies beyond it".to_owned());
            }
            _ => {}
        }
        if integrator == Integrator::Whitted && self.environment.is_some() {
            notes.push("the environment of the scene is for path tracing, and not used".to_owned());
        }
        notes
    }

    /// The lights on the device, as seen from a camera.
    pub fn upload(&self, device: &Device, camera: &Camera) -> Result<Buffer<Light>, DeviceError> {
        let mut lights = self.lights.clone();
        lights.extend(self.headlight.map(|color| Light {
            kind: kind::POINT,
            position: camera.eye.into(),
            color,
            ..sun()
        }));
        device.upload(&lights)
    }
}

/// What lies beyond a scene: its own background, or the built-in sky.
pub fn sky(scene: &Scene) -> scene::Background {
    scene.background.unwrap_or(SKY)
}

/// The light that arrives everywhere in a scene: its own, or the built-in one, which is brighter where there are no lights.
pub fn ambient(scene: &Scene) -> [f32; 3] {
    scene.ambient.unwrap_or(if scene.lights.is_empty() { AMBIENT_BUILT_IN } else { AMBIENT })
}

/// Unit vector to the built-in zenith.
fn up(scene: &Scene) -> Vec3 {
    scene.up.map_or(vec3(0.0, 1.0, 0.0), |up| turned(vec3(0.0, 1.0, 0.0), up))
}

/// The built-in sun, turned with what is up.
fn upright_sun(scene: &Scene) -> Light {
    let direction = sun().direction;
    Light { direction: scene.up.map_or(direction, |up| turned(direction, up)), ..sun() }
}

/// A direction with +Y up in a scene with another one.
fn turned(direction: Vec3, up: [f32; 3]) -> Vec3 {
    let direction = glam::Vec3::from(direction.to_array()).as_dvec3();
    (turn_to(up) * direction).as_vec3().normalize().to_array().into()
}

fn sun() -> Light {
    Light {
        position: Vec3::ZERO,
        kind: kind::DIRECTIONAL,
        direction: vec3(-0.45, -0.8, -0.4).normalize(),
        range: f32::INFINITY,
        color: vec3(0.85, 0.80, 0.72),
        cos_outer: -1.0,
        attenuation: vec3(1.0, 0.0, 0.0),
        cone_scale: 0.0,
    }
}

fn light(light: &scene::Light) -> Light {
    let mut ready =
        Light { range: light.range, color: light.color.into(), attenuation: light.attenuation.into(), ..sun() };
    match light.kind {
        LightKind::Point { position } => (ready.kind, ready.position) = (kind::POINT, position.into()),
        LightKind::Directional { direction } => ready.direction = Vec3::from(direction).normalize(),
        LightKind::Spot { position, direction, inner, outer } => {
            (ready.kind, ready.position) = (kind::SPOT, position.into());
            ready.direction = Vec3::from(direction).normalize();
            ready.cos_outer = outer.cos();
            // In double precision: the cosines of narrow cones differ by little. A hard edge still needs a finite slope.
            let difference = (inner as f64).cos() - (outer as f64).cos();
            ready.cone_scale = (1.0 / difference.max(1e-9)) as f32;
        }
    }
    ready
}
