//! What people change about a scene: lights, materials, places of instances, background.
//!
//! The edits are the values that differ from those of the files. Each change says [what it touched](Touched), so that only
//! that goes to the device, and can be taken back.
//!
//! ```
//! use raywarp::scene::{Material, Scene};
//! use raywarp_viewer::live::edits::{Edits, Touched};
//! use raywarp_viewer::live::Value;
//!
//! let scene = Scene { materials: vec![Material::default()], ..Scene::default() };
//! let mut edits = Edits::new(&scene);
//! assert_eq!(edits.set("material.0.shininess", &Value::Number(20.0)), Ok(vec![Touched::Materials]));
//! assert_eq!(edits.scene().materials[0].shininess, 20.0);
//! assert_eq!(edits.undo(), [Touched::Materials]);
//! assert_eq!(edits.scene().materials, scene.materials);
//! ```

mod field;
mod history;
mod place;
mod rows;
#[cfg(test)]
mod tests;
mod values;

use std::time::Instant;

use raywarp::scene::{Camera, Light, LightKind, Scene};

use super::{control_value, Value};
use field::{Field, LightField};
use history::{History, Join};

/// What a change is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Touched {
    /// Lights, background or ambient light.
    Lights,
    /// Some material.
    Materials,
    /// The place of this instance.
    Instance(usize),
}

/// The edits of a scene.
#[derive(Clone, Debug)]
pub struct Edits {
    /// As read, without geometry and texels, and with all lights that were ever added at the end.
    base: Scene,
    /// The same with the edits.
    edited: Scene,
    /// Lights of the files.
    lights_read: usize,
    /// Of each mesh, the middle of its box.
    middles: Vec<[f32; 3]>,
    /// Largest size of a placed mesh, in scene units.
    size: f32,
    history: History,
}

/// Most lights that are added to a scene, those that were removed again included.
const MOST_ADDED: usize = 64;

impl Edits {
    /// None so far. Looks at all vertices once: to be made beside the loop that draws.
    pub fn new(scene: &Scene) -> Self {
        let base = scene.outline();
        let boxes: Vec<[[f32; 3]; 2]> = scene.meshes.iter().map(place::bounds).collect();
        Self {
            edited: base.clone(),
            lights_read: base.lights.len(),
            size: place::size(&base.instances, &boxes),
            base,
            middles: boxes.into_iter().map(place::middle).collect(),
            history: History::default(),
        }
    }

    /// The scene with all edits, without meshes and images: its lights, materials, instances and background are those to
    /// render and to save.
    pub fn scene(&self) -> &Scene {
        &self.edited
    }

    /// Writes all edits into the scene that they are of, read a second time say.
    pub fn apply(&self, scene: &mut Scene) {
        let Scene { lights, materials, instances, background, ambient, .. } = self.edited.clone();
        (scene.lights, scene.materials, scene.instances) = (lights, materials, instances);
        (scene.background, scene.ambient) = (background, ambient);
    }

    /// Takes the scene as it was read again. Edits stay where materials and instances have the same names at the same
    /// places and there are as many lights; the steps are forgotten.
    pub fn rebase(&mut self, scene: &Scene) {
        let mut next = Self::new(scene);
        next.adopt(self);
        *self = next;
    }

    /// Takes over what was edited before the scene was read again, as [`rebase`](Self::rebase), instead of its own edits.
    pub fn adopt(&mut self, before: &Self) {
        let same_lights = before.lights_read == self.lights_read;
        self.base.lights.truncate(self.lights_read);
        if same_lights {
            self.base.lights.extend_from_slice(&before.base.lights[before.lights_read..]);
        }
        let (old, new) = (&before.base, &self.base);
        let mut history = before.history.clone();
        history.retain(|&field| match field {
            Field::Light(..) => same_lights,
            Field::Material(i, _) => {
                let names = [old, new].map(|scene| scene.materials.get(i).map(|m| &m.name));
                names[0].is_some() && names[0] == names[1]
            }
            Field::Instance(i, _) => {
                let names = [old, new].map(|scene| scene.instances.get(i).map(|i| &i.name));
                names[0].is_some() && names[0] == names[1]
            }
            Field::Background(_) => true,
        });
        (self.history, self.edited) = (history, self.base.clone());
        self.refresh_lights();
        let fields: Vec<Field> = self.history.changes().keys().copied().collect();
        self.refresh(fields);
    }

    /// Whether the values differ from those of earlier edits of the same scene.
    pub fn changed_since(&self, before: &Self) -> bool {
        self.history.changes() != before.history.changes()
    }

    /// Whether anything differs from the files.
    pub fn is_changed(&self) -> bool {
        !self.history.changes().is_empty()
    }

    /// Whether there is a step to take back.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Whether there is a step to do again.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Number of the step that [`undo`](Self::undo) would take back, 0 for none: no other step ever has it.
    pub(super) fn last_step(&self) -> u64 {
        self.history.last_step()
    }

    /// Number of the step that [`redo`](Self::redo) would do again.
    pub(super) fn next_step(&self) -> Option<u64> {
        self.history.next_step()
    }

    /// Gives the value of a row. Fast changes of one row are one step.
    ///
    /// # Errors
    /// A sentence where there is no such row or it cannot take the value; then nothing changes.
    pub fn set(&mut self, id: &str, value: &Value) -> Result<Vec<Touched>, String> {
        self.set_at(id, value, Join::Soon(Instant::now()))
    }

    fn set_at(&mut self, id: &str, value: &Value, join: Join) -> Result<Vec<Touched>, String> {
        if let Some(index) = id.strip_prefix("light.").and_then(|rest| rest.strip_suffix(".remove")) {
            return self.remove_light(index.parse().ok());
        }
        let missing = || format!("there is nothing called '{id}' to change in this scene");
        let field = Field::of(id).ok_or_else(missing)?;
        let default = self.default(field).filter(|_| self.is_shown(field)).ok_or_else(missing)?;
        let refuse = |why: String| format!("{} {why}", self.label(field));
        control_value::check(&self.control(field), value).map_err(refuse)?;
        if matches!(field, Field::Light(_, light) if light.is("direction")) && *value == Value::Triple([0.0; 3]) {
            return Err(refuse("is not zero".to_owned()));
        }
        let wanted = (*value != default).then(|| value.clone());
        let touched = self.history.set(vec![(field, wanted)], join);
        Ok(self.refresh(touched))
    }

    /// Back to the files' values: of a row, of a section ("lights", "light.2", "material.0", "instance.4", "background"),
    /// or with an empty name of all.
    pub fn reset(&mut self, id: &str) -> Vec<Touched> {
        let named = Field::of(id);
        let mut wanted: Vec<Field> = self.history.changes().keys().copied().collect();
        wanted.retain(|&field| id.is_empty() || named == Some(field) || field.is_within(id));
        // An added light stays, with the values that it was added with, unless all is reset.
        wanted.retain(|field| id.is_empty() || id == "lights" || !matches!(field, Field::Light(_, LightField::There)));
        let touched = self.history.set(wanted.into_iter().map(|field| (field, None)).collect(), Join::Never);
        self.refresh(touched)
    }

    /// Takes the last step back.
    pub fn undo(&mut self) -> Vec<Touched> {
        let fields = self.history.undo();
        self.refresh(fields)
    }

    /// Does the last step that was taken back again.
    pub fn redo(&mut self) -> Vec<Touched> {
        let fields = self.history.redo();
        self.refresh(fields)
    }

    /// Adds a white light where the camera is. In a scene without lights the built-in ones give way to it.
    ///
    /// # Errors
    /// A sentence where there are too many.
    pub fn add_light(&mut self, camera: &Camera) -> Result<Vec<Touched>, String> {
        let index = self.base.lights.len();
        let added = index - self.lights_read;
        if added == MOST_ADDED {
            return Err(format!("no more than {MOST_ADDED} lights can be added"));
        }
        let name = format!("added {}", added + 1);
        let kind = LightKind::Point { position: camera.eye };
        self.base.lights.push(Light { name, kind, ..Light::default() });
        let touched =
            self.history.set(vec![(Field::Light(index, LightField::There), Some(Value::Flag(true)))], Join::Never);
        Ok(self.refresh(touched))
    }

    fn remove_light(&mut self, index: Option<usize>) -> Result<Vec<Touched>, String> {
        let added = index.filter(|&index| self.is_there(index) && index >= self.lights_read);
        let index = added.ok_or("only lights that were added can be removed; others can be turned off")?;
        let of_it = |field: &&Field| matches!(field, Field::Light(light, _) if *light == index);
        let fields = self.history.changes().keys().filter(of_it).map(|&field| (field, None)).collect();
        let touched = self.history.set(fields, Join::Never);
        Ok(self.refresh(touched))
    }

    /// Shifts an instance from where it is now, in a step of its own or as a part of the one before.
    pub fn shift_instance(&mut self, index: usize, by: [f32; 3], goes_on: bool) -> Vec<Touched> {
        let id = format!("instance.{index}.translate");
        let Some(Value::Triple(now)) = Field::of(&id).and_then(|field| self.value(field)) else { return Vec::new() };
        let to = [0, 1, 2].map(|i| now[i] + by[i]);
        // What cannot be is refused there.
        let join = if goes_on { Join::Always } else { Join::Never };
        self.set_at(&id, &Value::Triple(to), join).unwrap_or_default()
    }

    fn is_there(&self, light: usize) -> bool {
        self.value(Field::Light(light, LightField::There)) == Some(Value::Flag(true))
    }

    /// Whether the field is one that people may set: lights come and go by buttons.
    fn is_shown(&self, field: Field) -> bool {
        match field {
            Field::Light(_, LightField::There) => false,
            Field::Light(light, _) => self.is_there(light),
            _ => true,
        }
    }

    /// Brings the edited scene up to date.
    fn refresh(&mut self, fields: Vec<Field>) -> Vec<Touched> {
        let mut touched: Vec<Touched> = fields
            .iter()
            .map(|field| match *field {
                Field::Light(..) | Field::Background(_) => Touched::Lights,
                Field::Material(..) => Touched::Materials,
                Field::Instance(index, _) => Touched::Instance(index),
            })
            .collect();
        touched.sort_unstable();
        touched.dedup();
        let mut materials: Vec<usize> = fields
            .iter()
            .filter_map(|field| match field {
                Field::Material(index, _) => Some(*index),
                _ => None,
            })
            .collect();
        materials.dedup();
        for index in materials {
            if let Some(material) = self.material(index) {
                self.edited.materials[index] = material;
            }
        }
        for &touched in &touched {
            match touched {
                Touched::Lights => self.refresh_lights(),
                Touched::Materials => {}
                Touched::Instance(index) => {
                    if let Some(transform) = self.transform(index) {
                        self.edited.instances[index].transform = transform;
                    }
                }
            }
        }
        touched
    }

    fn refresh_lights(&mut self) {
        self.edited.lights = (0..self.base.lights.len()).filter_map(|index| self.light(index)).collect();
        (self.edited.background, self.edited.ambient) = (self.background(), self.ambient());
    }
}
