//! Edits as people make them, and as a browser that means no good does.

use std::time::{Duration, Instant};

use proptest::prelude::*;
use raywarp::render::framing;
use raywarp::scene::{AlphaMode, Instance, Light, LightKind, Material, Mesh, Scene, Transform};

use super::history::Join;
use super::{Edits, Touched};
use crate::live::{Control, Value};

fn scene() -> Scene {
    let mesh = Mesh {
        positions: vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        materials: vec![0],
        ..Mesh::default()
    };
    let instance =
        |name: &str| Instance { name: name.into(), mesh: 0, transform: Transform::default(), material: None };
    let material = |name: &str| Material { name: name.into(), ..Material::default() };
    let lamp = Light {
        name: "lamp".into(),
        kind: LightKind::Point { position: [1.0, 2.0, 3.0] },
        color: [4.0, 2.0, 0.3],
        ..Light::default()
    };
    Scene {
        meshes: vec![mesh],
        instances: vec![instance("left"), instance("right")],
        materials: vec![material("red"), material("blue")],
        lights: vec![lamp, Light::default()],
        ..Scene::default()
    }
}

/// What matters of a scene, comparable.
fn seen(scene: &Scene) -> impl PartialEq + std::fmt::Debug {
    let places: Vec<Transform> = scene.instances.iter().map(|instance| instance.transform).collect();
    (scene.lights.clone(), scene.materials.clone(), places, scene.background, scene.ambient)
}

fn number(x: f32) -> Value {
    Value::Number(x)
}

#[test]
fn each_change_touches_its_own_part_and_can_be_taken_back() {
    let scene = scene();
    let mut edits = Edits::new(&scene);
    assert_eq!(seen(edits.scene()), seen(&scene));
    for (id, value, touched) in [
        ("light.0.color", Value::Triple([1.0, 0.0, 0.5]), Touched::Lights),
        ("light.1.direction", Value::Triple([1.0, -1.0, 0.0]), Touched::Lights),
        ("material.1.diffuse", Value::Triple([0.1, 0.2, 0.3]), Touched::Materials),
        ("instance.1.translate", Value::Triple([0.0, 5.0, 0.0]), Touched::Instance(1)),
        ("background.zenith", Value::Triple([0.0, 0.0, 1.0]), Touched::Lights),
        ("background.ambient", Value::Triple([0.1; 3]), Touched::Lights),
    ] {
        let before = seen(edits.scene());
        assert_eq!(edits.set(id, &value), Ok(vec![touched]), "{id}");
        assert_eq!(edits.set(id, &value), Ok(vec![]), "{id}: the same again is no change");
        let after = seen(edits.scene());
        assert_ne!(after, before, "{id}");
        assert_eq!(edits.undo(), [touched]);
        assert_eq!(seen(edits.scene()), before, "{id}");
        assert_eq!(edits.redo(), [touched]);
        assert_eq!(seen(edits.scene()), after, "{id}");
    }
    assert_eq!(edits.scene().lights[0].color, [4.0, 0.0, 2.0]);
    assert_eq!(edits.scene().instances[1].transform.translation, [0.0, 5.0, 0.0]);
    let mut again = scene.clone();
    edits.apply(&mut again);
    assert_eq!(seen(&again), seen(edits.scene()));
    assert_eq!(edits.reset(""), [Touched::Lights, Touched::Materials, Touched::Instance(1)]);
    assert!(!edits.is_changed());
    assert_eq!(seen(edits.scene()), seen(&scene));
    assert_eq!(edits.undo().len(), 3);
    assert_eq!(seen(&again), seen(edits.scene()));
}

#[test]
fn the_drag_of_a_slider_is_one_step() {
    let mut edits = Edits::new(&scene());
    let start = Instant::now();
    for i in 1..50u64 {
        let now = start + Duration::from_millis(20 * i);
        edits.set_at("material.0.opacity", &number(1.0 - i as f32 / 100.0), Join::Soon(now)).unwrap();
    }
    edits.set_at("material.0.ior", &number(1.5), Join::Soon(start + Duration::from_secs(1))).unwrap();
    edits.set_at("material.0.ior", &number(1.6), Join::Soon(start + Duration::from_secs(3))).unwrap();
    assert_eq!((edits.scene().materials[0].alpha, edits.scene().materials[0].opacity), (AlphaMode::Blend, 0.51));
    edits.undo();
    assert_eq!(edits.scene().materials[0].ior, 1.5);
    edits.undo();
    assert_eq!(edits.scene().materials[0].ior, 1.0);
    edits.undo();
    assert_eq!(edits.scene().materials[0], Material { name: "red".into(), ..Material::default() });
    assert!(!edits.can_undo() && edits.can_redo());
    edits.set("material.0.ior", &number(2.0)).unwrap();
    assert!(!edits.can_redo(), "what was taken back is gone once something else is done");
}

#[test]
fn steps_are_kept_in_bounds() {
    let mut edits = Edits::new(&scene());
    for i in 0..1000 {
        edits.set_at("material.0.shininess", &number(1.0 + i as f32 / 10.0), Join::Never).unwrap();
    }
    let undone = (0..1000).take_while(|_| !edits.undo().is_empty()).count();
    assert_eq!(undone, 256);
}

#[test]
fn a_value_of_the_file_is_no_edit() {
    let mut edits = Edits::new(&scene());
    edits.set("light.0.intensity", &number(2.0)).unwrap();
    edits.set("light.0.intensity", &number(4.0)).unwrap();
    assert!(!edits.is_changed());
    assert_eq!(edits.scene().lights, scene().lights);
}

#[test]
fn lights_are_turned_off_added_and_removed() {
    let mut edits = Edits::new(&Scene { lights: Vec::new(), ..scene() });
    assert_eq!(edits.set("light.0.remove", &Value::Flag(true)).map_err(|e| e.contains("added")), Err(true));
    let built_in = edits.background_section().rows.pop().unwrap().value;
    let camera = framing([[-1.0; 3], [1.0; 3]]);
    assert_eq!(edits.add_light(&camera), Ok(vec![Touched::Lights]));
    assert_eq!(edits.scene().lights[0].kind, LightKind::Point { position: camera.eye });
    assert_ne!(edits.background_section().rows.pop().unwrap().value, built_in, "without lights it is brighter");
    edits.set("light.0.on", &Value::Flag(false)).unwrap();
    assert_eq!(edits.scene().lights.len(), 1, "else the built-in lights would come back");
    assert_eq!(edits.scene().lights[0].color, [0.0; 3]);
    assert_eq!(edits.set("light.0.remove", &Value::Flag(true)), Ok(vec![Touched::Lights]));
    assert!(edits.scene().lights.is_empty() && !edits.is_changed());
    assert!(edits.set("light.0.on", &Value::Flag(true)).is_err());
    edits.undo();
    assert_eq!(edits.scene().lights.len(), 1);
    edits.reset("light.0");
    assert_eq!(edits.scene().lights[0].color, [1.0; 3], "it stays, as it was added");
    edits.reset("lights");
    assert!(edits.scene().lights.is_empty());
    let added = (0..1000).take_while(|_| edits.add_light(&camera).is_ok()).count();
    assert!(added < 64 && edits.scene().lights.len() == added);
}

#[test]
fn the_ambient_colour_follows_the_diffuse_one_until_it_has_its_own() {
    let mut edits = Edits::new(&scene());
    edits.set("material.0.diffuse", &Value::Triple([0.0, 1.0, 0.0])).unwrap();
    assert_eq!(edits.scene().materials[0].ambient, [0.0, 1.0, 0.0]);
    edits.set("material.0.ambient", &Value::Triple([0.2; 3])).unwrap();
    edits.set("material.0.diffuse", &Value::Triple([1.0, 0.0, 0.0])).unwrap();
    assert_eq!(edits.scene().materials[0].ambient, [0.2; 3]);
}

#[test]
fn the_scene_read_again_keeps_what_still_fits() {
    let mut edits = Edits::new(&scene());
    edits.set("material.0.diffuse", &Value::Triple([0.0; 3])).unwrap();
    edits.set("material.1.shininess", &number(9.0)).unwrap();
    edits.set("instance.0.scale", &number(2.0)).unwrap();
    edits.add_light(&framing([[-1.0; 3], [1.0; 3]])).unwrap();
    let mut changed = scene();
    changed.materials[0].name = "green".into();
    edits.rebase(&changed);
    assert_eq!(edits.scene().materials[0].diffuse, [0.7; 3]);
    assert_eq!(edits.scene().materials[1].shininess, 9.0);
    assert_eq!(edits.scene().instances[0].transform.columns[0], [2.0, 0.0, 0.0]);
    assert_eq!(edits.scene().lights.len(), 3);
    changed.lights.pop();
    changed.instances.clear();
    edits.rebase(&changed);
    assert_eq!(edits.scene().lights, changed.lights);
    assert!(!edits.can_undo());
}

#[test]
fn what_cannot_be_is_refused_with_a_sentence() {
    let mut edits = Edits::new(&scene());
    for (id, value, part) in [
        ("", Value::Flag(true), "nothing called"),
        ("light.9.color", Value::Triple([1.0; 3]), "nothing called"),
        ("light.0.direction", Value::Triple([1.0; 3]), "nothing called"),
        ("light.0.there", Value::Flag(false), "nothing called"),
        ("light.1.direction", Value::Triple([0.0; 3]), "not zero"),
        ("light.0.color", Value::Triple([f32::NAN; 3]), "Colour needs"),
        ("material.0.opacity", number(2.0), "from 0 to 1"),
        ("material.0.opacity", Value::Text("1".into()), "Opacity needs a number"),
        ("material.99999999999999999999.opacity", number(0.5), "nothing called"),
        ("instance.0.scale", number(0.0), "from 0.01"),
        ("instance.0.translate", Value::Triple([1e30, 0.0, 0.0]), "three numbers"),
    ] {
        let error = edits.set(id, &value).unwrap_err();
        assert!(error.contains(part), "{id}: {error}");
    }
    assert!(
        !edits.is_changed()
            && edits.reset("nonsense").is_empty()
            && edits.shift_instance(7, [1.0; 3], false).is_empty()
    );
    assert_eq!(edits.shift_instance(0, [f32::INFINITY, 0.0, 0.0], false), []);
}

#[test]
fn rows_show_what_is_and_what_differs() {
    let mut edits = Edits::new(&scene());
    edits.set("material.0.ior", &number(1.5)).unwrap();
    let section = edits.material_section(0).unwrap();
    assert_eq!((section.id.as_str(), section.title.as_str()), ("material.0", "Material 0: red"));
    let row = section.rows.iter().find(|row| row.id == "material.0.ior").unwrap();
    assert_eq!((&row.value, row.changed), (&number(1.5), true));
    assert_eq!(section.rows.iter().filter(|row| row.changed).count(), 1);
    let lights = edits.light_sections();
    assert_eq!(lights.iter().map(|s| s.id.as_str()).collect::<Vec<_>>(), ["lights", "light.0", "light.1"]);
    let step = |id: &str| {
        let rows = edits.instance_section(0).unwrap().rows;
        rows.into_iter().find(|row| row.id == id).map(|row| row.control)
    };
    assert_eq!(step("instance.0.translate"), Some(Control::Vector { step: 0.01 }));
    assert!(edits.material_section(9).is_none() && edits.instance_section(9).is_none());
}

fn id() -> impl Strategy<Value = String> {
    let rows = {
        let edits = Edits::new(&scene());
        let mut sections = edits.light_sections();
        sections.extend(edits.material_section(0));
        sections.extend(edits.material_section(1));
        sections.extend(edits.instance_section(1));
        sections.push(edits.background_section());
        sections.into_iter().flat_map(|section| section.rows).map(|row| row.id).collect::<Vec<_>>()
    };
    prop_oneof![8 => prop::sample::select(rows), 1 => "[a-z]{1,8}\\.[0-9]{1,3}\\.[a-z]{1,8}"]
}

fn value() -> impl Strategy<Value = Value> {
    prop_oneof![
        any::<bool>().prop_map(Value::Flag),
        prop_oneof![any::<f32>(), 0f32..2.0].prop_map(Value::Number),
        prop_oneof![any::<[f32; 3]>(), [0f32..1.0, 0f32..1.0, 0f32..1.0]].prop_map(Value::Triple),
        ".{0,8}".prop_map(Value::Text),
    ]
}

#[derive(Clone, Debug)]
enum Deed {
    Set(String, Value),
    Reset(String),
    Undo,
    Redo,
    Add,
}

fn deed() -> impl Strategy<Value = Deed> {
    prop_oneof![
        6 => (id(), value()).prop_map(|(id, value)| Deed::Set(id, value)),
        1 => id().prop_map(Deed::Reset),
        2 => Just(Deed::Undo),
        2 => Just(Deed::Redo),
        1 => Just(Deed::Add),
    ]
}

proptest! {
    #[test]
    fn whatever_is_done_can_be_undone_and_stays_finite(deeds in prop::collection::vec(deed(), 1..60)) {
        let scene = scene();
        let mut edits = Edits::new(&scene);
        let camera = framing([[-1.0; 3], [1.0; 3]]);
        for deed in deeds {
            match deed {
                Deed::Set(id, value) => _ = edits.set_at(&id, &value, Join::Never),
                Deed::Reset(id) => _ = edits.reset(&id),
                Deed::Undo => _ = edits.undo(),
                Deed::Redo => _ = edits.redo(),
                Deed::Add => _ = edits.add_light(&camera),
            }
            for instance in &edits.scene().instances {
                prop_assert!(instance.transform.columns.iter().flatten().all(|x| x.is_finite()));
                prop_assert!(instance.transform.translation.iter().all(|x| x.is_finite()));
            }
            prop_assert!(edits.scene().lights.iter().all(|light| light.color.iter().all(|x| x.is_finite())));
        }
        let end = seen(edits.scene());
        let mut steps = 0;
        while edits.can_undo() {
            edits.undo();
            steps += 1;
        }
        prop_assert_eq!(seen(edits.scene()), seen(&scene));
        for _ in 0..steps {
            edits.redo();
        }
        prop_assert_eq!(seen(edits.scene()), end);
        edits.reset("");
        prop_assert_eq!(seen(edits.scene()), seen(&scene));
    }
}
