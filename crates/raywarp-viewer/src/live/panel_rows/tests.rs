//! The panel as a browser sees it, and as one that means no good uses it.

use proptest::prelude::*;
use raywarp::accel::{AccelKind, Build, Quality};
use raywarp::render::framing;
use raywarp::scene::{Camera, Instance, Light, Material, Mesh, Projection, Scene, Transform};

use super::{panel, CommandContext, Effect, Shown};
use crate::live::camera_control::CameraControl;
use crate::live::edits::{Edits, Touched};
use crate::live::keys::Action;
use crate::live::pick::Pick;
use crate::live::view_settings::{View, ViewSettings};
use crate::live::{Control, Panel, Row, Value};

/// A viewer without a picture.
struct Bench {
    view_settings: ViewSettings,
    usual: ViewSettings,
    tree: [Build; 2],
    camera: CameraControl,
    edits: Edits,
    pick: Pick,
}

impl Bench {
    fn new() -> Self {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            materials: vec![0],
            ..Mesh::default()
        };
        let instance = Instance { name: "i".into(), mesh: 0, transform: Transform::default(), material: None };
        let scene = Scene {
            meshes: vec![mesh],
            instances: vec![instance],
            materials: vec![Material::default()],
            lights: vec![Light::default()],
            ..Scene::default()
        };
        let bounds = [[-1.0; 3], [1.0; 3]];
        let camera = Camera { name: "door".into(), eye: [0.0, 0.0, 9.0], ..framing(bounds) };
        let pick = Pick {
            instance: 0,
            mesh: 0,
            triangle: 0,
            material: 0,
            distance: Some(1.0),
            weights: [1.0, 0.0, 0.0],
            position: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            names: Default::default(),
        };
        Self {
            view_settings: ViewSettings::default(),
            usual: ViewSettings::default(),
            tree: [Build::default(); 2],
            camera: CameraControl::new(framing(bounds), vec![camera], bounds, [0.0, 1.0, 0.0]),
            edits: Edits::new(&scene),
            pick,
        }
    }

    fn panel(&self) -> Panel {
        panel(&Shown {
            view_settings: &self.view_settings,
            usual: &self.usual,
            tree: self.tree,
            camera: Some(&self.camera),
            edits: Some(&self.edits),
            pick: Some(&self.pick),
        })
    }

    fn rows(&self) -> Vec<Row> {
        self.panel().sections.into_iter().flat_map(|section| section.rows).collect()
    }

    fn row(&self, id: &str) -> Row {
        self.rows().into_iter().find(|row| row.id == id).unwrap_or_else(|| panic!("no row {id}"))
    }

    fn with<T>(&mut self, work: impl FnOnce(&mut CommandContext) -> T) -> T {
        let Self { view_settings, usual, tree, camera, edits, .. } = self;
        work(&mut CommandContext { view_settings, usual, tree: *tree, camera: Some(camera), edits: Some(edits) })
    }

    /// As the viewer will: a wish for a structure is fulfilled at once.
    fn set(&mut self, id: &str, value: Value) -> Result<Effect, String> {
        let effect = self.with(|context| context.set(id, &value));
        if let Ok(Effect::Build(build)) = effect {
            self.tree[0] = build;
        }
        effect
    }

    fn reset(&mut self, id: &str) -> Vec<Effect> {
        let effects = self.with(|context| context.reset(id));
        for effect in &effects {
            if let Effect::Build(build) = effect {
                self.tree[0] = *build;
            }
        }
        effects
    }
}

/// Another value that a control takes; none for those that only show or act.
fn other(row: &Row) -> Option<Value> {
    Some(match (&row.control, &row.value) {
        (Control::Flag, Value::Flag(on)) => Value::Flag(!on),
        (Control::Number { min, max, .. }, Value::Number(x)) => Value::Number(if x == max { *min } else { *max }),
        (Control::Choice { options }, Value::Text(text)) => {
            Value::Text(options.iter().find(|option| *option != text)?.clone())
        }
        (Control::Color { .. }, Value::Triple(_)) => Value::Triple([0.125, 0.25, 0.5]),
        (Control::Vector { .. }, Value::Triple(v)) => Value::Triple([v[0] + 1.0, v[1] + 0.5, v[2] + 0.25]),
        _ => return None,
    })
}

#[test]
fn names_are_unique_and_nothing_is_changed_at_first() {
    let rows = Bench::new().rows();
    let names: std::collections::HashSet<_> = rows.iter().map(|row| row.id.clone()).collect();
    assert_eq!(names.len(), rows.len());
    assert!(rows.iter().all(|row| !row.changed));
    let view_settings = ViewSettings::default();
    let empty = Shown {
        view_settings: &view_settings,
        usual: &view_settings,
        tree: [Build::default(); 2],
        camera: None,
        edits: None,
        pick: None,
    };
    assert_eq!(panel(&empty).sections.len(), 2);
}

#[test]
fn every_row_takes_another_value_says_so_and_goes_back() {
    for row in Bench::new().rows() {
        let Some(value) = other(&row) else { continue };
        let mut bench = Bench::new();
        let before = bench.panel();
        let effect = bench.set(&row.id, value.clone());
        assert!(effect.is_ok(), "{}: {effect:?}", row.id);
        if row.id == "camera.choice" {
            assert_eq!(bench.camera.camera().name, "door");
            continue;
        }
        let after = bench.row(&row.id);
        assert_eq!((after.value, after.changed), (value, true), "{}", row.id);
        assert!(!bench.reset(&row.id).is_empty(), "{}", row.id);
        let mut now = bench.panel();
        // The field of view gives way to the height for a while, and the distance stays what it became.
        if row.id == "camera.projection" {
            assert_eq!(bench.camera.camera().projection, bench.camera.home().projection);
            bench.reset("camera");
            now = bench.panel();
        }
        assert_eq!(now, before, "{}", row.id);
    }
}

#[test]
fn sections_and_all_go_back_at_once() {
    for id in ["", "rendering"] {
        let mut bench = Bench::new();
        let before = bench.panel();
        bench.set("tree.kind", Value::Text("kd".into())).unwrap();
        bench.set("tree.quality", Value::Text("high".into())).unwrap();
        bench.set("look.samples", Value::Number(7.0)).unwrap();
        assert_eq!(bench.tree[0], Build { kind: AccelKind::Kd, quality: Quality::High, cached: false });
        assert_eq!(bench.reset(id), [Effect::Picture, Effect::Build(bench.tree[1])]);
        assert_eq!(bench.panel(), before);
    }
    let mut bench = Bench::new();
    bench.set("light.0.intensity", Value::Number(3.0)).unwrap();
    bench.set("camera.eye", Value::Triple([1.0, 2.0, 3.0])).unwrap();
    assert_eq!(bench.reset("camera"), [Effect::Picture]);
    assert_eq!(bench.reset("light.0"), [Effect::Scene(vec![Touched::Lights])]);
    assert_eq!((bench.reset(""), bench.reset("nonsense")), (vec![], vec![]));
}

#[test]
fn effects_say_what_remains_to_be_done() {
    let mut bench = Bench::new();
    for (id, value, effect) in [
        ("look.exposure", Value::Number(1.5), Effect::ToneMapFilm),
        ("look.view", Value::Text("depth".into()), Effect::Picture),
        ("look.reference", Value::Flag(true), Effect::Overlay),
        ("camera.projection", Value::Text("parallel".into()), Effect::Picture),
        ("camera.height", Value::Number(2.5), Effect::Picture),
        ("material.0.fresnel", Value::Flag(true), Effect::Scene(vec![Touched::Materials])),
        ("lights.add", Value::Flag(true), Effect::Scene(vec![Touched::Lights])),
        ("light.1.remove", Value::Flag(true), Effect::Scene(vec![Touched::Lights])),
        ("file.save", Value::Flag(true), Effect::Act(Action::Save)),
    ] {
        assert_eq!(bench.set(id, value), Ok(effect), "{id}");
    }
    assert_eq!(bench.view_settings.view, View::Depth);
    assert_eq!(bench.camera.camera().projection, Projection::Orthographic { height: 2.5 });
}

#[test]
fn what_cannot_be_is_refused_with_a_sentence() {
    let mut bench = Bench::new();
    let target = bench.camera.camera().target;
    let before = bench.panel();
    for (id, value, part) in [
        ("look.samples", Value::Number(f32::NAN), "a number from 1"),
        ("look.view", Value::Text("x-ray".into()), "one of picture"),
        ("look.nothing", Value::Flag(true), "nothing called"),
        ("camera.fov", Value::Number(180.0), "from 1 to 150"),
        ("camera.height", Value::Number(1.0), "nothing called"),
        ("camera.eye", Value::Triple(target), "apart from its target"),
        ("camera.choice", Value::Text("window".into()), "one of"),
        ("tree.kind", Value::Text("octree".into()), "one of brute"),
        ("file.format", Value::Flag(true), "nothing called"),
        ("", Value::Flag(true), "nothing called"),
    ] {
        let error = bench.set(id, value).unwrap_err();
        assert!(error.contains(part), "{id}: {error}");
    }
    assert_eq!(bench.panel(), before);
    let mut view_settings = ViewSettings::default();
    let mut early = CommandContext {
        view_settings: &mut view_settings,
        usual: &ViewSettings::default(),
        tree: [Build::default(); 2],
        camera: None,
        edits: None,
    };
    assert_eq!(early.set("camera.fov", &Value::Number(40.0)), Err("there is no scene yet".to_owned()));
    assert_eq!(early.set("light.0.on", &Value::Flag(true)), Err("there is no scene yet".to_owned()));
}

proptest! {
    #[test]
    fn no_value_does_harm(
        deeds in prop::collection::vec((any::<prop::sample::Index>(), 0..5, any::<[f32; 3]>(), ".{0,8}"), 1..50),
    ) {
        let mut bench = Bench::new();
        for (at, kind, numbers, text) in deeds {
            let rows = bench.rows();
            let row = &rows[at.index(rows.len())];
            let value = match kind {
                0 => Value::Flag(numbers[0] > 0.0),
                1 => Value::Number(numbers[0]),
                2 => Value::Triple(numbers),
                3 => Value::Text(text),
                _ => other(row).unwrap_or(Value::Flag(true)),
            };
            let _ = bench.set(&row.id.clone(), value);
            // What is shown can be sent as it is.
            for row in bench.rows() {
                let finite = match row.value {
                    Value::Number(x) => x.is_finite(),
                    Value::Triple(v) => v.iter().all(|x| x.is_finite()),
                    _ => true,
                };
                prop_assert!(finite, "{row:?}");
            }
        }
        prop_assert!(bench.view_settings.render_options([1, 1]).spp >= 1);
    }
}
