//! Values of fields, and what the scene becomes by them.

use raywarp::device_scene;
use raywarp::scene::{AlphaMode, Background, Light, Material, Scene, Transform};

use super::field::{on_panel, BackgroundField, Field, InstanceField, LightField, COLOR};
use super::place::Shift;
use super::Edits;
use crate::live::parameter_control::{shown, taken};
use crate::live::Value;

impl Edits {
    /// What a field says now; nothing where the scene has no such thing.
    pub(super) fn value(&self, field: Field) -> Option<Value> {
        match field {
            // The ambient colour follows the diffuse one.
            Field::Material(index, parameter) => parameter.get(self.edited.materials.get(index)?).map(shown),
            _ => self.history.changes().get(&field).cloned().or_else(|| self.default(field)),
        }
    }

    /// What it says without edits.
    pub(super) fn default(&self, field: Field) -> Option<Value> {
        match field {
            Field::Light(index, field) => self.light_default(index, field),
            Field::Material(index, parameter) => parameter.get(self.base.materials.get(index)?).map(shown),
            Field::Instance(index, field) => self.base.instances.get(index).map(|_| match field {
                InstanceField::Translate => Value::Triple(Shift::NONE.translate),
                InstanceField::Rotate => Value::Triple(Shift::NONE.rotate),
                InstanceField::Scale => Value::Number(Shift::NONE.scale),
            }),
            Field::Background(field) => Some(Value::Triple(self.background_default(field))),
        }
    }

    fn light_default(&self, index: usize, field: LightField) -> Option<Value> {
        let light = self.base.lights.get(index)?;
        let intensity = intensity(light);
        Some(match field {
            LightField::There => Value::Flag(index < self.lights_read),
            LightField::On => Value::Flag(true),
            LightField::Intensity => Value::Number(intensity),
            LightField::Of(parameter) if parameter.name == COLOR => {
                Value::Triple(light.color.map(|channel| channel / intensity))
            }
            LightField::Of(parameter) => shown(parameter.get(light)?),
        })
    }

    fn background_default(&self, field: BackgroundField) -> [f32; 3] {
        let sky = device_scene::sky(&self.base);
        match field {
            BackgroundField::Zenith => sky.zenith,
            BackgroundField::Horizon => sky.horizon,
            BackgroundField::Ground => sky.ground,
            // The built-in one is brighter without lights.
            BackgroundField::Ambient => {
                let lights = self.edited.lights.first().cloned().into_iter().collect();
                device_scene::ambient(&Scene { lights, ambient: self.base.ambient, ..Scene::default() })
            }
        }
    }

    /// A light with its edits; nothing if it was removed or does not exist. One that is off is black: a scene without
    /// any would be given built-in ones.
    pub(super) fn light(&self, index: usize) -> Option<Light> {
        let mut light = self.base.lights.get(index).filter(|_| self.is_there(index))?.clone();
        let value = |field| self.value(Field::Light(index, field));
        let changed = |field| self.history.changes().get(&Field::Light(index, field));
        for field in LightField::all() {
            match (field, changed(field)) {
                (LightField::Intensity, Some(_)) => light.color = self.light_color(index)?,
                (LightField::Of(parameter), Some(_)) if parameter.name == COLOR => {
                    light.color = self.light_color(index)?;
                }
                (LightField::Of(parameter), Some(value)) => parameter.set(&mut light, taken(parameter.kind, value)?),
                _ => {}
            }
        }
        if value(LightField::On) == Some(Value::Flag(false)) {
            light.color = [0.0; 3];
        }
        Some(light)
    }

    /// Colour times intensity.
    fn light_color(&self, index: usize) -> Option<[f32; 3]> {
        let value = |field| self.value(Field::Light(index, field));
        let color = triple(value(LightField::all().find(|field| field.is(COLOR))?)?)?;
        let intensity = number(value(LightField::Intensity)?)?;
        Some(color.map(|channel| channel * intensity))
    }

    /// A material with its edits.
    pub(super) fn material(&self, index: usize) -> Option<Material> {
        let base = self.base.materials.get(index)?;
        let mut material = base.clone();
        let mut has_ambient = false;
        for parameter in on_panel() {
            if let Some(value) = self.history.changes().get(&Field::Material(index, parameter)) {
                parameter.set(&mut material, taken(parameter.kind, value)?);
                has_ambient |= parameter.name == "ambient";
            }
        }
        if !has_ambient && base.ambient == base.diffuse {
            material.ambient = material.diffuse;
        }
        // Opaque ignores the coverage: whoever sets one wants to see it.
        if material.opacity != base.opacity && material.alpha == AlphaMode::Opaque {
            material.alpha = AlphaMode::Blend;
        }
        Some(material)
    }

    /// Where an instance is with its edits.
    pub(super) fn transform(&self, index: usize) -> Option<Transform> {
        let instance = self.base.instances.get(index)?;
        let middle = self.middles.get(instance.mesh).copied().unwrap_or_default();
        let value = |field| self.value(Field::Instance(index, field));
        let shift = Shift {
            translate: triple(value(InstanceField::Translate)?)?,
            rotate: triple(value(InstanceField::Rotate)?)?,
            scale: number(value(InstanceField::Scale)?)?,
        };
        Some(shift.of(&instance.transform, middle))
    }

    /// The background with its edits; the renderer's choice where there are none.
    pub(super) fn background(&self) -> Option<Background> {
        let colors = [BackgroundField::Zenith, BackgroundField::Horizon, BackgroundField::Ground];
        let changes = self.history.changes();
        if !colors.iter().any(|&field| changes.contains_key(&Field::Background(field))) {
            return self.base.background;
        }
        let [zenith, horizon, ground] = colors.map(|field| self.value(Field::Background(field)).and_then(triple));
        Some(Background { zenith: zenith?, horizon: horizon?, ground: ground? })
    }

    /// The ambient light, likewise.
    pub(super) fn ambient(&self) -> Option<[f32; 3]> {
        let edited = self.history.changes().get(&Field::Background(BackgroundField::Ambient)).cloned();
        edited.and_then(triple).or(self.base.ambient)
    }
}

/// The largest channel: what remains is a colour.
fn intensity(light: &Light) -> f32 {
    let largest = light.color.iter().fold(0.0f32, |a, &b| a.max(b));
    if largest > 0.0 && largest.is_finite() {
        largest
    } else {
        1.0
    }
}

fn triple(value: Value) -> Option<[f32; 3]> {
    match value {
        Value::Triple(triple) => Some(triple),
        _ => None,
    }
}

fn number(value: Value) -> Option<f32> {
    match value {
        Value::Number(number) => Some(number),
        _ => None,
    }
}
