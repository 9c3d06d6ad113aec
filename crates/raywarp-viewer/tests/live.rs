//! The interactive core as a front end uses it, on the CPU or on the device that `RAYWARP_TEST_DEVICE` names.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::session::{developed, device, Session, SIZE, SPP};
use raywarp::accel::{AccelKind, Quality};
use raywarp::image::Development;
use raywarp::render::{Integrator, RenderOptions, Tracer};
use raywarp::scene::{load, Camera, Environment, Radiance, RenderDefaults};
use raywarp_viewer::live::{Event, LiveScene, LiveSceneOptions, Modifiers, Outcome, Source};
use raywarp_viewer::ViewerError;

impl Session {
    fn new(options: LiveSceneOptions) -> Self {
        Self::open(Source::default(), options)
    }
}

/// What `raywarp render` gives.
fn rendered(camera: Option<&Camera>, options: &RenderOptions, development: &Development) -> Vec<u8> {
    let scene = load::builtin().unwrap().scene;
    let tracer = Tracer::new(&scene, AccelKind::Bvh2, &device()).unwrap();
    let options = RenderOptions { size: SIZE, spp: SPP, ..*options };
    developed(&tracer, camera.unwrap_or(tracer.default_camera()), &options, development)
}

#[test]
fn at_rest_the_picture_becomes_that_of_render_to_the_bit() {
    let mut session = Session::new(LiveSceneOptions::default());
    let last = session.settle().pop().unwrap();
    assert_eq!(last.size, SIZE);
    assert!(last.rgba == rendered(None, &RenderOptions::default(), &Development::default()));
    let status = session.viewer.status(&session.live_scene);
    assert_eq!((status.samples, status.spp, status.settled), (SPP, SPP, true));
    assert!(status.mrays_per_s.unwrap() > 0.0 && status.kernel_ms > 0.0 && status.fetch_ms > 0.0);
    assert!(status.kernel_ms + status.fetch_ms <= status.frame_ms, "{status:?}");
    // Nothing happens: nothing is rendered.
    assert!(session.frame().is_none() && !session.viewer.wants_frame(&session.live_scene));
}

#[test]
fn paths_settle_to_the_picture_of_render_too() {
    let overrides = RenderDefaults { integrator: Some(Integrator::Path), ..RenderDefaults::default() };
    let mut session = Session::new(LiveSceneOptions { overrides, ..LiveSceneOptions::default() });
    let options = RenderOptions { integrator: Integrator::Path, ..RenderOptions::default() };
    assert!(session.settle().pop().unwrap().rgba == rendered(None, &options, &Development::default()));
    session.drag(0.6);
    assert!(!session.frame().expect("a picture of the camera that moved").settled);
    session.drop_it();
    let after = session.settle().pop().unwrap();
    let camera = session.viewer.camera().unwrap().clone();
    assert!(after.rgba == rendered(Some(&camera), &options, &Development::default()));
}

#[test]
fn a_drag_moves_the_camera_and_its_picture_settles_too() {
    let mut session = Session::new(LiveSceneOptions::default());
    let before = session.settle().pop().unwrap();
    session.drag(0.6);
    assert!(session.viewer.wants_frame(&session.live_scene));
    let moving = session.frame().expect("a picture of the camera that moved");
    assert!(!moving.settled);
    session.drop_it();
    let after = session.settle().pop().unwrap();
    assert!(after.rgba != before.rgba);
    let camera = session.viewer.camera().unwrap().clone();
    assert!(after.rgba == rendered(Some(&camera), &RenderOptions::default(), &Development::default()));
    session.key("r", true);
    assert!(session.settle().pop().unwrap().rgba == before.rgba);
}

#[test]
fn a_held_key_flies_until_it_is_released() {
    let mut session = Session::new(LiveSceneOptions::default());
    session.settle();
    let eye = |session: &Session| session.viewer.camera().unwrap().eye;
    session.key("w", true);
    let first = eye(&session);
    for _ in 0..5 {
        session.frame();
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_ne!(eye(&session), first);
    session.key("w", false);
    session.settle();
    let rest = eye(&session);
    session.frame();
    assert_eq!(eye(&session), rest);
}

#[test]
fn exposure_develops_the_same_samples_again() {
    let mut session = Session::new(LiveSceneOptions::default());
    session.settle();
    session.key("+", true);
    let pictures = session.settle();
    assert_eq!(pictures.len(), 1, "no sample is taken again");
    let brighter = Development { exposure: 0.5, ..Development::default() };
    assert!(pictures[0].rgba == rendered(None, &RenderOptions::default(), &brighter));
    session.key("u", true);
    let without = RenderOptions { shadows: false, ..RenderOptions::default() };
    assert!(session.settle().pop().unwrap().rgba == rendered(None, &without, &brighter));
}

#[test]
fn every_view_is_one_key_away_and_costs_have_a_scale() {
    let mut session = Session::new(LiveSceneOptions::default());
    let picture = session.settle().pop().unwrap();
    let mut seen = vec![picture.rgba.clone()];
    for (key, name) in [
        ("n", "normals"),
        ("z", "depth"),
        ("o", "albedo"),
        ("t", "primitives"),
        ("m", "materials"),
        ("x", "tests"),
        ("l", "load"),
    ] {
        session.key(key, true);
        let view = session.settle().pop().unwrap();
        assert!(!seen.contains(&view.rgba), "{name} is like another");
        seen.push(view.rgba.clone());
        let status = session.viewer.status(&session.live_scene);
        let legend = status.legend.expect("a legend");
        assert_eq!((status.view.as_str(), legend.title.is_empty()), (name, false));
        assert_eq!(legend.colors.is_empty(), !["depth", "tests", "load"].contains(&name));
        assert_eq!(legend.title.ends_with("; 99 % are within the scale"), ["tests", "load"].contains(&name));
    }
    session.key("l", true);
    assert!(session.settle().pop().unwrap().rgba == picture.rgba);
}

#[test]
fn a_better_tree_takes_over_without_a_change_of_the_picture() {
    for (accel, quality) in [(None, Quality::High), (Some(AccelKind::Kd), Quality::Medium)] {
        let mut session = Session::new(LiveSceneOptions {
            overrides: RenderDefaults { accel, tree: Some(quality), ..RenderDefaults::default() },
            at_once: 0,
            ..LiveSceneOptions::default()
        });
        let first = session.settle().pop().unwrap();
        let begin = Instant::now();
        while session.live_scene.busy().is_some() {
            session.live_scene.poll();
            assert!(begin.elapsed() < Duration::from_secs(60));
            assert!(session.frame().is_none_or(|picture| picture.rgba == first.rgba));
        }
        let accel = session.viewer.status(&session.live_scene).accel;
        assert!(accel.contains(&quality.to_string()), "{accel}");
    }
}

#[test]
fn keys_ask_for_files_texts_and_the_end() {
    let mut session = Session::new(LiveSceneOptions::default());
    assert!(session.key("F12", true).is_empty(), "there is no picture yet");
    let picture = session.settle().pop().unwrap();
    let asked = session.key("F12", true);
    let [Outcome::File(export)] = &asked[..] else { panic!("{asked:?}") };
    assert_eq!((export.name.as_str(), export.media_type), ("raywarp.png", "image/png"));
    let decoded = image::load_from_memory(&export.make().unwrap()).unwrap().to_rgba8();
    assert!(decoded.into_raw() == picture.rgba);
    let ctrl = Modifiers { ctrl: true, ..Modifiers::default() };
    let copied = session.handle(Event::Key { key: "c".to_owned(), down: true, modifiers: ctrl });
    assert!(matches!(&copied[..], [Outcome::Copy(flags)] if flags.starts_with("--eye ")), "{copied:?}");
    let quit = session.handle(Event::Key { key: "q".to_owned(), down: true, modifiers: ctrl });
    assert!(matches!(quit[..], [Outcome::Quit]), "{quit:?}");
}

#[test]
fn a_viewer_has_one_file_on_its_way() {
    let mut session = Session::new(LiveSceneOptions::default());
    session.settle();
    let mut asked = session.key("F12", true);
    let Some(Outcome::File(export)) = asked.pop() else { panic!("{asked:?}") };
    let ticket = export.ticket();
    drop(export);
    assert!(session.key("F12", true).is_empty(), "it is made, and not yet where it belongs");
    let notice = session.viewer.status(&session.live_scene).notice.unwrap();
    assert!(notice.error && notice.text.contains("still on its way"), "{notice:?}");
    drop(ticket);
    assert!(matches!(session.key("F12", true)[..], [Outcome::File(_)]));
}

#[test]
fn a_scene_that_cannot_be_read_is_a_notice() {
    let source = Source { path: Some("no-such-scene.obj".into()), ..Source::default() };
    let mut live_scene = LiveScene::open(source, device(), LiveSceneOptions::default());
    let begin = Instant::now();
    while live_scene.busy().is_some() {
        assert!(begin.elapsed() < Duration::from_secs(10));
        live_scene.poll();
    }
    assert!(matches!(live_scene.take_failure(), Some(ViewerError::Load(_))));
    let notice = live_scene.notice().expect("a notice");
    assert!(notice.error && notice.text.contains("no-such-scene.obj"), "{notice:?}");
    assert!(!live_scene.is_ready());
}

/// A red square before a green sky: nothing of it is black.
const BRIGHT: &str = r#"
version = 1
background = [0.1, 0.5, 0.2]
[[materials]]
name = "red"
emission = [0.8, 0.1, 0.1]
[[meshes]]
vertices = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
faces = [[0, 1, 2], [0, 2, 3]]
material = "red"
[[cameras]]
eye = [0, 0, 4]
target = [0, 0, 0]
"#;

#[test]
fn no_picture_has_holes_whatever_its_size_and_however_it_came_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bright.toml");
    std::fs::write(&path, BRIGHT).unwrap();
    let source = Source { path: Some(path), ..Source::default() };
    let mut session = Session::open(source, LiveSceneOptions::default());
    let settled = |session: &mut Session, what: &str| {
        let pictures = session.settle();
        for picture in &pictures {
            let black = picture.rgba.chunks_exact(4).filter(|pixel| pixel[..3] == [0; 3]).count();
            assert_eq!(black, 0, "{what}: a picture of {:?}", picture.size);
        }
        pictures
    };
    // More than is traced in the time of a frame.
    session.handle(Event::Resize { width: 1500, height: 1100 });
    assert!(settled(&mut session, "the first picture").len() > 1);
    session.drag(0.6);
    session.frame();
    session.drop_it();
    settled(&mut session, "a drag");
    session.handle(Event::Resize { width: 1700, height: 1200 });
    let first = settled(&mut session, "another size").remove(0);
    assert_eq!(first.size, [1700, 1200]);
    session.key(" ", true);
    session.drag(0.7);
    settled(&mut session, "at full quality");
    session.drop_it();
}

#[test]
fn a_background_takes_the_place_of_the_scenes_own() {
    let green = LiveSceneOptions { background: Some([0.0, 1.0, 0.0]), ..LiveSceneOptions::default() };
    let corner = |options| Session::new(options).settle().pop().unwrap().rgba[..4].to_vec();
    assert_eq!(corner(green), [0, 255, 0, 255]);
    assert_ne!(corner(LiveSceneOptions::default()), [0, 255, 0, 255]);
}

#[test]
fn an_environment_is_seen_where_paths_are_traced() {
    let picture = Radiance { name: "blue".to_owned(), width: 1, height: 1, texels: vec![[0.0, 0.0, 0.5]] };
    let environment = Some(Environment { picture: Arc::new(picture), rotation: 0.0, strength: 2.0 });
    let overrides = RenderDefaults { integrator: Some(Integrator::Path), ..RenderDefaults::default() };
    let mut session = Session::new(LiveSceneOptions { environment, overrides, ..LiveSceneOptions::default() });
    assert_eq!(session.settle().pop().unwrap().rgba[..4], [0, 0, 255, 255]);
}

#[test]
fn any_size_can_be_asked_for() {
    let mut session = Session::new(LiveSceneOptions::default());
    session.settle();
    for [width, height] in [[1, 1], [0, 7], [301, 2]] {
        session.handle(Event::Resize { width, height });
        let size = session.settle().pop().unwrap().size;
        assert_eq!(size, [width.max(1), height.max(1)]);
    }
}
