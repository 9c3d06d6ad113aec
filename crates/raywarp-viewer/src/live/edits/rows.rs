//! The edits as rows of the panel.

use raywarp::scene::schema::{PanelRow, Parameter};

use super::field::{on_panel, BackgroundField, Field, InstanceField, LightField};
use super::Edits;
use crate::live::parameter_control::{self, range};
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
        let shown = LightField::all().filter(|&field| field != LightField::There);
        let mut rows: Vec<Row> = shown.filter_map(|field| self.row(Field::Light(index, field))).collect();
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
        let rows = on_panel().filter_map(|parameter| self.row(Field::Material(index, parameter))).collect();
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
            Field::Light(_, LightField::Intensity) => "Intensity",
            Field::Light(_, LightField::Of(parameter)) => label(parameter),
            Field::Material(_, parameter) => label(parameter),
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
        let default = self.default(field);
        let [low, high] = default.as_ref().map_or([f32::INFINITY, f32::NEG_INFINITY], range);
        let number = |min: f32, max: f32| Control::Number { min: low.min(min), max: high.max(max), step: 0.0 };
        match field {
            Field::Light(_, LightField::There | LightField::On) => Control::Flag,
            Field::Light(_, LightField::Intensity) => number(0.0, (4.0 * high).clamp(10.0, f32::MAX)),
            Field::Light(_, LightField::Of(parameter)) => self.parameter(parameter, default),
            Field::Material(_, parameter) => self.parameter(parameter, default),
            Field::Instance(_, field) => match field {
                InstanceField::Translate => Control::Vector { step: self.step() },
                InstanceField::Rotate => Control::Vector { step: 1.0 },
                InstanceField::Scale => number(0.01, 100.0),
            },
            Field::Background(_) => Control::Color { max: high.max(2.0) },
        }
    }

    fn parameter<T>(&self, parameter: &Parameter<T>, default: Option<Value>) -> Control {
        let values: Vec<&Value> = default.iter().collect();
        let row = parameter.panel.unwrap_or(PanelRow::new(parameter.name));
        match parameter_control::control(parameter, &row, &values) {
            // A place: its steps are the scene's.
            Control::Vector { step: 0.0 } => Control::Vector { step: self.step() },
            control => control,
        }
    }

    /// A notch of a place in scene units: a decimal hundredth of the scene.
    fn step(&self) -> f32 {
        let hundredth = 0.01 * self.size.clamp(1e-20, 1e20);
        10f32.powf(hundredth.log10().floor())
    }
}

fn label<T>(parameter: &Parameter<T>) -> &'static str {
    parameter.panel.map_or(parameter.name, |row| row.label)
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
