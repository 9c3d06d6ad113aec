//! What people do to a scene in the viewer, on the CPU or on the device that `RAYWARP_TEST_DEVICE` names: pictures are
//! those of the edited scene, rendered anew.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::session::{device, left, pixels, Session, SIZE, SPP};
use raywarp::accel::AccelKind;
use raywarp::render::{RenderOptions, Tracer};
use raywarp::scene::{load, AlphaMode, LoadOptions, Scene, Viewpoint};
use raywarp_viewer::live::{Event, LiveSceneOptions, Modifiers, Outcome, Row, Source, Value};

/// Two things side by side on a floor, below a light.
const SCENE: &str = r#"
version = 1
background = [0.1, 0.2, 0.3]

[[materials]]
name = "red"
diffuse = [0.8, 0.1, 0.1]

[[materials]]
name = "grey"
diffuse = [0.5, 0.5, 0.5]

[[meshes]]
name = "pyramid"
vertices = [[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [0, 1.5, 0]]
faces = [[0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]]
material = "red"

[[meshes]]
name = "floor"
vertices = [[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]]
faces = [[0, 1, 2], [0, 2, 3]]
material = "grey"

[[instances]]
mesh = "floor"

[[instances]]
name = "left"
mesh = "pyramid"
translate = [-1.5, 0, 0]

[[instances]]
name = "right"
mesh = "pyramid"
translate = [1.5, 0, 0]

[[lights]]
kind = "point"
position = [2, 6, 4]
intensity = 1

[[cameras]]
name = "front"
eye = [0, 3, 9]
target = [0, 0.5, 0]

[[cameras]]
name = "above"
eye = [0, 12, 0.1]
target = [0, 0, 0]
"#;

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.write(SCENE);
        place
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("scene.toml")
    }

    fn write(&self, text: &str) {
        fs::write(self.path(), text).unwrap();
    }

    fn open(&self, options: LiveSceneOptions) -> Session {
        Session::open(Source { path: Some(self.path()), ..Source::default() }, options)
    }

    fn watched(&self) -> Session {
        Session::open(Source { path: Some(self.path()), watch: true, ..Source::default() }, LiveSceneOptions::default())
    }
}

fn read(path: &Path) -> Scene {
    load::load(path, &LoadOptions::default()).unwrap().scene
}

/// The picture of a scene, from its first camera.
fn rendered(scene: &Scene) -> Vec<u8> {
    let tracer = Tracer::new(scene, AccelKind::Bvh2, &device()).unwrap();
    let options = RenderOptions { size: SIZE, spp: SPP, ..RenderOptions::default() };
    pixels(&tracer, &scene.cameras[0], &options)
}

impl Session {
    fn row(&self, id: &str) -> Row {
        let sections = self.viewer.panel(&self.live_scene).sections;
        let ids: Vec<_> = sections.iter().flat_map(|section| &section.rows).map(|row| row.id.clone()).collect();
        let found = sections.into_iter().flat_map(|section| section.rows).find(|row| row.id == id);
        found.unwrap_or_else(|| panic!("no row {id} among {ids:?}"))
    }

    fn set(&mut self, id: &str, value: Value) {
        assert!(self.handle(Event::Set { id: id.to_owned(), value }).is_empty());
    }

    fn reset(&mut self, id: &str) {
        self.handle(Event::Reset { id: id.to_owned() });
    }

    fn ctrl(&mut self, key: &str) -> Vec<Outcome> {
        let modifiers = Modifiers { ctrl: true, ..Modifiers::default() };
        self.handle(Event::Key { key: key.to_owned(), down: true, modifiers })
    }

    fn click(&mut self, x: f32, y: f32) {
        self.handle(Event::Pointer { x, y });
        self.handle(left(true));
        self.handle(left(false));
    }

    fn picked(&self, what: &str) -> Option<String> {
        let lines = self.viewer.status(&self.live_scene).pick;
        lines.into_iter().find(|line| line.0 == what).map(|line| line.1)
    }

    /// Until all that was asked for is there: trees, then the picture.
    fn rest(&mut self) -> Vec<u8> {
        let begin = Instant::now();
        let quiet = Duration::from_millis(900);
        let mut since = Instant::now();
        while since.elapsed() < quiet {
            assert!(begin.elapsed() < Duration::from_secs(60), "{:?}", self.viewer.status(&self.live_scene));
            self.live_scene.poll();
            assert!(self.live_scene.is_ready() || self.live_scene.busy().is_some(), "{:?}", self.live_scene.notice());
            if self.frame().is_some() || self.live_scene.busy().is_some() || self.viewer.wants_frame(&self.live_scene) {
                since = Instant::now();
            } else {
                std::thread::sleep(Duration::from_millis(2));
            }
        }
        if self.picked("instance").is_some() {
            return self.kept();
        }
        self.shown()
    }

    /// The picture that the key for files gives: without the outline of what is picked.
    fn kept(&mut self) -> Vec<u8> {
        let Some(Outcome::File(export)) = self.key("F12", true).pop() else { panic!("no file") };
        image::load_from_memory(&export.make().unwrap()).unwrap().to_rgba8().into_raw()
    }

    /// Frames until a condition holds.
    fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let begin = Instant::now();
        while !holds(self) {
            assert!(begin.elapsed() < Duration::from_secs(60), "never: {what}");
            self.frame();
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

#[test]
fn lights_and_materials_change_and_go_back() {
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions::default());
    let first = session.rest();
    let mut scene = read(&place.path());
    assert!(first == rendered(&scene));

    session.set("light.0.position", Value::Triple([-3.0, 4.0, 1.0]));
    scene.lights[0].kind = raywarp::scene::LightKind::Point { position: [-3.0, 4.0, 1.0] };
    let lit = session.rest();
    assert!(lit != first && lit == rendered(&scene));
    assert!(session.row("light.0.position").changed);

    session.click(0.35, 0.55);
    assert_eq!(session.picked("material").as_deref(), Some("0 'red'"));
    session.set("material.0.diffuse", Value::Triple([0.1, 0.1, 0.9]));
    // The ambient colour was the diffuse one, and stays it.
    (scene.materials[0].diffuse, scene.materials[0].ambient) = ([0.1, 0.1, 0.9], [0.1, 0.1, 0.9]);
    let painted = session.rest();
    assert!(painted != lit && painted == rendered(&scene));

    session.ctrl("z");
    assert!(session.rest() == lit);
    session.ctrl("y");
    assert!(session.rest() == painted);
    session.reset("");
    assert!(session.rest() == first);
    assert!(!session.row("light.0.position").changed);
}

#[test]
fn a_reset_is_taken_back_and_so_are_the_steps_before_it() {
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions::default());
    session.rest();
    let value = |session: &Session, id: &str| session.row(id).value;
    let eye = value(&session, "camera.eye");
    session.set("light.0.intensity", Value::Number(3.0));
    session.set("light.0.position", Value::Triple([-3.0, 4.0, 1.0]));
    session.set("look.exposure", Value::Number(2.0));
    session.set("look.shadows", Value::Flag(false));
    session.set("camera.eye", Value::Triple([0.0, 2.0, 7.0]));
    let state = |session: &Session| {
        let ids = ["light.0.intensity", "light.0.position", "look.exposure", "look.shadows", "camera.eye"];
        ids.map(|id| value(session, id))
    };
    let before = state(&session);
    session.reset("");
    let after = state(&session);
    assert_eq!(after[2..], [Value::Number(0.0), Value::Flag(true), eye]);

    // What was done since stays, and is its own step.
    session.set("look.frame_rate", Value::Number(30.0));
    session.ctrl("z");
    assert_eq!((state(&session), value(&session, "look.frame_rate")), (before.clone(), Value::Number(30.0)));
    session.ctrl("z");
    assert!(!session.row("light.0.position").changed);
    assert_eq!(state(&session)[2..], before[2..], "options that were not reset stay");
    session.ctrl("z");
    assert!(!session.row("light.0.intensity").changed);
    (0..3).for_each(|_| drop(session.ctrl("y")));
    assert_eq!(state(&session), after);

    // A reset of options alone has its place among the edits.
    session.set("look.exposure", Value::Number(1.0));
    session.reset("look.exposure");
    session.set("light.0.intensity", Value::Number(5.0));
    session.ctrl("z");
    assert_eq!(value(&session, "look.exposure"), Value::Number(0.0));
    session.ctrl("z");
    assert_eq!(value(&session, "look.exposure"), Value::Number(1.0));
    session.ctrl("y");
    assert_eq!(value(&session, "look.exposure"), Value::Number(0.0));
    session.ctrl("y");
    assert_eq!(value(&session, "light.0.intensity"), Value::Number(5.0));
}

#[test]
fn the_picked_object_has_an_outline_that_is_not_kept() {
    use raywarp_viewer::live::outline::COLOR;
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions::default());
    let plain = session.rest();
    let marked = |session: &Session| session.shown().chunks_exact(4).filter(|pixel| pixel[..3] == COLOR).count();
    assert_eq!(marked(&session), 0);
    session.click(0.65, 0.55);
    assert!(session.rest() == plain, "a file shows the scene alone");
    let around = marked(&session);
    assert!(around > 20, "{around}");
    // Where it is not the picture is as it was.
    let differs = session.shown().chunks_exact(4).zip(plain.chunks_exact(4)).filter(|(a, b)| a != b).count();
    assert_eq!(differs, around);
    // It goes with the object, also while that moves.
    session.handle(Event::Wheel { notches: 1.0 });
    session.frame();
    assert!(marked(&session) > 0);
    session.rest();
    assert_ne!(marked(&session), 0);
    session.handle(Event::Wheel { notches: -1.0 });
    session.key("Escape", true);
    session.rest();
    assert_eq!(marked(&session), 0);
}

#[test]
fn light_goes_through_what_becomes_transparent() {
    let place = Place::new();
    for accel in [None, Some(AccelKind::Kd), Some(AccelKind::Bvh2)] {
        let mut session = place.open(LiveSceneOptions {
            overrides: raywarp::scene::RenderDefaults { accel, ..Default::default() },
            ..LiveSceneOptions::default()
        });
        session.rest();
        session.click(0.35, 0.55);
        session.set("material.0.opacity", Value::Number(0.25));
        session.set("material.0.transmission", Value::Triple([0.5; 3]));
        let mut scene = read(&place.path());
        let red = &mut scene.materials[0];
        (red.opacity, red.alpha, red.transmission) = (0.25, AlphaMode::Blend, [0.5; 3]);
        assert!(session.rest() == rendered(&scene), "{accel:?}");
        let built = session.viewer.status(&session.live_scene).accel;
        assert!(accel.is_none_or(|kind| built.starts_with(kind.name())), "{built}");
    }
}

#[test]
fn a_picked_object_follows_the_pointer() {
    let place = Place::new();
    for accel in [None, Some(AccelKind::Bvh2)] {
        let mut session = place.open(LiveSceneOptions {
            overrides: raywarp::scene::RenderDefaults { accel, ..Default::default() },
            ..LiveSceneOptions::default()
        });
        let first = session.rest();
        session.click(0.65, 0.55);
        assert_eq!(session.picked("instance").as_deref(), Some("2 'right'"));
        session.key("g", true);
        for step in 1..=5 {
            session.handle(Event::Pointer { x: 0.65 + 0.02 * step as f32, y: 0.55 });
            session.frame();
            if step == 3 {
                // A hand that pauses has not let go.
                std::thread::sleep(Duration::from_millis(900));
            }
        }
        let held = session.picked("position").unwrap();
        assert_eq!(session.picked("distance"), None);
        session.key("g", false);
        let moved = session.rest();
        let Value::Triple(shift) = session.row("instance.2.translate").value else { panic!() };
        assert!(shift[0] > 0.5 && shift[2].abs() < 1e-3, "{shift:?}");

        let mut scene = read(&place.path());
        let translation = &mut scene.instances[2].transform.translation;
        *translation = [0, 1, 2].map(|i| translation[i] + shift[i]);
        let expected = rendered(&scene);
        let wrong = moved.iter().zip(&expected).filter(|(a, b)| a.abs_diff(**b) > 2).count();
        // The shift is rounded once more here than in the viewer.
        assert!(moved != first && wrong < moved.len() / 200, "{wrong} of {}", moved.len());
        let good = session.viewer.status(&session.live_scene).accel;
        assert!(good.ends_with("medium"), "{good}");

        session.ctrl("z");
        assert!(session.rest() == first);
        assert_ne!(session.picked("position").unwrap(), held);
        // The camera has not seen any of it.
        assert_eq!(session.viewer.camera().unwrap().name, "front");
    }
}

#[test]
fn a_saved_scene_shows_what_was_saved() {
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions::default());
    session.rest();
    session.set("light.0.intensity", Value::Number(0.5));
    session.set("look.max_depth", Value::Number(1.0));
    session.set("look.exposure", Value::Number(0.5));
    session.click(0.65, 0.55);
    session.set("instance.2.rotate", Value::Triple([0.0, 30.0, 0.0]));
    session.handle(Event::Wheel { notches: 2.0 });
    let shown = session.rest();
    let outcome = session.ctrl("s");
    let [Outcome::File(export)] = &outcome[..] else {
        panic!("{outcome:?} {:?}", session.viewer.status(&session.live_scene).notice)
    };
    assert_eq!((export.name.as_str(), export.media_type), ("scene-edited.toml", "application/toml"));
    // It names the original from the folder that this program runs in.
    let here = std::env::current_dir().unwrap().join(format!("edits-test-{}.toml", std::process::id()));
    fs::write(&here, export.make().unwrap()).unwrap();
    let again =
        Session::open(Source { path: Some(here.clone()), ..Source::default() }, LiveSceneOptions::default()).rest();
    fs::remove_file(&here).unwrap();
    assert!(again == shown);
}

#[test]
fn a_file_that_changes_is_read_again_and_a_broken_one_leaves_the_picture() {
    let place = Place::new();
    let mut session = place.watched();
    let first = session.rest();
    session.set("light.0.intensity", Value::Number(0.5));
    let dim = session.rest();

    place.write("version = 1\n[[meshes]]\nfile = \"none.obj\"\n");
    session.until("the error", |session| session.live_scene.notice().is_some_and(|notice| notice.error));
    assert!(session.live_scene.notice().unwrap().text.contains("none.obj"));
    assert!(session.rest() == dim, "the last good picture stays");

    place.write(
        &SCENE
            .replace("[0.8, 0.1, 0.1]", "[0.1, 0.8, 0.1]")
            .replace("version = 1", "version = 1\nrender = { max_depth = 3 }"),
    );
    session.until("the scene again", |session| session.live_scene.notice().is_none());
    let green = session.rest();
    let mut scene = read(&place.path());
    scene.lights[0].color = [0.5; 3];
    assert!(green == rendered(&scene), "what people changed stays");
    assert_eq!(session.row("look.max_depth").value, Value::Number(3.0));
    session.reset("light.0");
    place.write(SCENE);
    session.until("the first scene", |session| session.row("look.max_depth").value == Value::Number(5.0));
    assert!(session.rest() == first);
}

#[test]
fn what_is_changed_while_the_scene_is_read_again_counts_once() {
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions::default());
    let first = session.rest();
    session.click(0.65, 0.55);
    session.set("instance.2.translate", Value::Triple([0.5, 0.0, 0.0]));
    session.set("lights.add", Value::Flag(true));
    session.live_scene.reload();
    // Nothing of this has a picture in between: the reading goes on.
    session.set("light.0.intensity", Value::Number(0.5));
    session.set("light.1.intensity", Value::Number(0.25));
    let changed = session.rest();
    session.click(0.7, 0.55);
    assert_eq!(session.picked("instance").as_deref(), Some("2 'right'"));
    assert_eq!(session.row("instance.2.translate").value, Value::Triple([0.5, 0.0, 0.0]));
    let mut scene = read(&place.path());
    scene.instances[2].transform.translation[0] += 0.5;
    scene.lights[0].color = [0.5; 3];
    let kind = raywarp::scene::LightKind::Point { position: session.viewer.camera().unwrap().eye };
    scene.lights.push(raywarp::scene::Light { kind, color: [0.25; 3], ..Default::default() });
    assert!(changed == rendered(&scene));
    session.set("light.1.remove", Value::Flag(true));
    session.reset("");
    assert!(session.rest() == first);
}

#[test]
fn a_tree_that_was_begun_before_a_change_does_not_undo_it() {
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions {
        overrides: raywarp::scene::RenderDefaults { accel: Some(AccelKind::Bvh2), ..Default::default() },
        at_once: 0,
        ..LiveSceneOptions::default()
    });
    while !session.live_scene.is_ready() {
        session.live_scene.poll();
    }
    assert!(session.live_scene.busy().is_some_and(|busy| busy.contains("medium")), "the good tree is being built");
    session.set("material.0.transmission", Value::Triple([0.5; 3]));
    let mut scene = read(&place.path());
    scene.materials[0].transmission = [0.5; 3];
    assert!(session.rest() == rendered(&scene));
    assert_eq!(session.viewer.status(&session.live_scene).accel, "bvh2, medium");
}

#[test]
fn an_object_that_was_flat_for_a_while_comes_back_whole() {
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions::default());
    let first = session.rest();
    session.click(0.65, 0.55);
    // So far away single precision has no room for it.
    session.set("instance.2.translate", Value::Triple([3e9, 0.0, 0.0]));
    assert!(session.rest() != first);
    session.ctrl("z");
    assert!(session.rest() == first);
}

#[test]
fn the_structure_can_be_chosen_and_what_it_cannot_is_told() {
    let place = Place::new();
    let mut session = place.open(LiveSceneOptions::default());
    let first = session.rest();
    session.set("tree.kind", Value::Text("kd".to_owned()));
    assert!(session.rest() == first);
    assert!(session.viewer.status(&session.live_scene).accel.starts_with("kd"));
    assert!(session.row("tree.kind").changed);
    session.set("tree.kind", Value::Text("oct".to_owned()));
    let notice = session.viewer.status(&session.live_scene).notice.unwrap();
    assert!(notice.error && notice.text.contains("kd"), "{notice:?}");
    session.reset("tree.kind");
    assert!(session.rest() == first && session.viewer.status(&session.live_scene).notice.is_none());
}

#[test]
fn the_first_view_is_the_one_that_is_asked_for() {
    let place = Place::new();
    let asked = |camera: &str| LiveSceneOptions {
        viewpoint: Viewpoint { camera: Some(camera.to_owned()), fov: Some(50.0), ..Viewpoint::default() },
        ..LiveSceneOptions::default()
    };
    let mut session = place.open(asked("above"));
    session.rest();
    let camera = session.viewer.camera().unwrap().clone();
    assert_eq!(
        (camera.eye, camera.projection),
        ([0.0, 12.0, 0.1], raywarp::scene::Projection::Perspective { fov_y: 50f32.to_radians() })
    );
    session.handle(Event::Wheel { notches: 3.0 });
    session.key("r", true);
    assert_eq!(session.viewer.camera(), Some(&camera));

    let mut lost = place.open(asked("below"));
    lost.until("the failure", |session| session.live_scene.busy().is_none());
    let error = lost.live_scene.take_failure().expect("a failure").to_string();
    assert!(error.contains("'below'") && error.contains("1 'above'"), "{error}");
}
