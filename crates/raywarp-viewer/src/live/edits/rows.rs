//! The edits as rows of the panel.

use super::field::{BackgroundField, Field, InstanceField, LightField, MaterialField};
use super::Edits;
use crate::live::{Control, Row, Section, Value};

/// More lights than this are not laid out one by one.
const MOST_LIGHTS: usize = 24;

impl Edits {
    /// The lights: a section that adds one, then one for each.
    pub fn light_sections(&self) -> Vec<Section> {
        let there: Vec<usize> = (0..self.base.lights.len()).filter(|&light| self.is_there(light)).collect();
        let add = Row {
            id: "lights.add".to_owned(),
            label: "Add a light at the camera".to_owned(),
            value: Value::Flag(false),
            control: Control::Action,
            changed: false,
        };
        let mut rows = vec![add];
        if there.is_empty() {
            rows.push(text("lights.note", "Lights", "the scene has none: a built-in sun and sky light it"));
        } else if there.len() > MOST_LIGHTS {
            let more = format!("and {} more", there.len() - MOST_LIGHTS);
            rows.push(text("lights.note", "Lights", &more));
        }
        let mut sections = vec![Section { id: "lights".to_owned(), title: "Lights".to_owned(), rows }];
        sections.extend(there.into_iter().take(MOST_LIGHTS).map(|light| self.light_section(light)));
        sections
    }

    fn light_section(&self, index: usize) -> Section {
        let shown = LightField::ALL.iter().filter(|&&field| field != LightField::There);
        let mut rows: Vec<Row> = shown.filter_map(|&field| self.row(Field::Light(index, field))).collect();
        if index >= self.lights_read {
            rows.push(Row {
                id: format!("light.{index}.remove"),
                label: "Remove this light".to_owned(),
                value: Value::Flag(false),
                control: Control::Action,
                changed: false,
            });
        }
        let name = self.base.lights.get(index).map(|light| light.name.as_str()).unwrap_or_default();
        Section { id: format!("light.{index}"), title: titled("Light", index, name), rows }
    }

    /// The background and the ambient light.
    pub fn background_section(&self) -> Section {
        let rows = BackgroundField::ALL.iter().filter_map(|&field| self.row(Field::Background(field))).collect();
        Section { id: "background".to_owned(), title: "Background".to_owned(), rows }
    }

    /// A material; nothing where there is no such.
    pub fn material_section(&self, index: usize) -> Option<Section> {
        let material = self.base.materials.get(index)?;
        let rows = MaterialField::ALL.iter().filter_map(|&field| self.row(Field::Material(index, field))).collect();
        Some(Section { id: format!("material.{index}"), title: titled("Material", index, &material.name), rows })
    }

    /// The place of an instance; nothing where there is no such.
    pub fn instance_section(&self, index: usize) -> Option<Section> {
        let instance = self.base.instances.get(index)?;
        let rows = InstanceField::ALL.iter().filter_map(|&field| self.row(Field::Instance(index, field))).collect();
        Some(Section { id: format!("instance.{index}"), title: titled("Object", index, &instance.name), rows })
    }

    fn row(&self, field: Field) -> Option<Row> {
        Some(Row {
            id: field.to_string(),
            label: self.label(field).to_owned(),
            value: self.value(field)?,
            control: self.control(field),
            changed: self.history.changes().contains_key(&field),
        })
    }

    pub(super) fn label(&self, field: Field) -> &'static str {
        match field {
            Field::Light(_, LightField::There) => "Light",
            Field::Light(_, LightField::On) => "On",
            Field::Light(_, LightField::Color) => "Colour",
            Field::Light(_, LightField::Intensity) => "Intensity",
            Field::Light(_, LightField::Position) => "Position",
            Field::Light(_, LightField::Direction) => "Direction",
            Field::Material(_, MaterialField::Diffuse) => "Diffuse",
            Field::Material(_, MaterialField::Specular) => "Specular",
            Field::Material(_, MaterialField::Shininess) => "Shininess",
            Field::Material(_, MaterialField::Ambient) => "Ambient",
            Field::Material(_, MaterialField::Emission) => "Emission",
            Field::Material(_, MaterialField::Reflection) => "Reflection",
            Field::Material(_, MaterialField::Transmission) => "Transmission",
            Field::Material(_, MaterialField::Ior) => "Index of refraction",
            Field::Material(_, MaterialField::Fresnel) => "Fresnel",
            Field::Material(_, MaterialField::Opacity) => "Opacity",
            Field::Instance(_, InstanceField::Translate) => "Shift",
            Field::Instance(_, InstanceField::Rotate) => "Turn, degrees",
            Field::Instance(_, InstanceField::Scale) => "Scale",
            Field::Background(BackgroundField::Zenith) => "Zenith",
            Field::Background(BackgroundField::Horizon) => "Horizon",
            Field::Background(BackgroundField::Ground) => "Ground",
            Field::Background(BackgroundField::Ambient) => "Ambient light",
        }
    }

    /// How a field can be changed. Ranges are usual ones, and wide enough for what the file says.
    pub(super) fn control(&self, field: Field) -> Control {
        let [low, high] = range(self.default(field));
        let number = |min: f32, max: f32| Control::Number { min: low.min(min), max: high.max(max), step: 0.0 };
        let color = |max: f32| Control::Color { max: high.max(max) };
        match field {
            Field::Light(_, field) => match field {
                LightField::There | LightField::On => Control::Flag,
                LightField::Color => color(1.0),
                LightField::Intensity => number(0.0, (4.0 * high).clamp(10.0, f32::MAX)),
                LightField::Position => Control::Vector { step: self.step() },
                LightField::Direction => Control::Vector { step: 0.05 },
            },
            Field::Material(_, field) => match field {
                MaterialField::Fresnel => Control::Flag,
                MaterialField::Shininess => number(0.0, 1000.0),
                MaterialField::Ior => number(1.0, 3.0),
                MaterialField::Opacity => number(0.0, 1.0),
                MaterialField::Emission => color(10.0),
                _ => color(1.0),
            },
            Field::Instance(_, field) => match field {
                InstanceField::Translate => Control::Vector { step: self.step() },
                InstanceField::Rotate => Control::Vector { step: 1.0 },
                InstanceField::Scale => number(0.01, 100.0),
            },
            Field::Background(_) => color(2.0),
        }
    }

    /// A notch of a place in scene units: a decimal hundredth of the scene.
    fn step(&self) -> f32 {
        let hundredth = 0.01 * self.size.clamp(1e-20, 1e20);
        10f32.powf(hundredth.log10().floor())
    }
}

/// The least and the largest number in a value.
fn range(value: Option<Value>) -> [f32; 2] {
    let numbers = match value {
        Some(Value::Number(x)) => vec![x],
        Some(Value::Triple(v)) => v.to_vec(),
        _ => Vec::new(),
    };
    numbers.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
}

fn titled(kind: &str, index: usize, name: &str) -> String {
    match name {
        "" => format!("{kind} {index}"),
        _ => format!("{kind} {index}: {name}"),
    }
}

fn text(id: &str, label: &str, value: &str) -> Row {
    Row {
        id: id.to_owned(),
        label: label.to_owned(),
        value: Value::Text(value.to_owned()),
        control: Control::Text,
        changed: false,
    }
}
