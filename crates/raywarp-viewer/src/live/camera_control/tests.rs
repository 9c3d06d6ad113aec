//! What holds of the camera, whatever events come.

use std::time::Duration;

use glam::DVec3;
use proptest::prelude::*;
use raywarp::render::framing;
use raywarp::scene::{Camera, Projection};

use super::pose::{is_usable, vec, World};
use super::{CameraControl, Pose, Preset};
use crate::live::keys::{Action, BINDINGS};
use crate::live::{Button, Event, Modifiers};

const UP: [f32; 3] = [0.0, 1.0, 0.0];

fn control(size: f32, shift: f32) -> CameraControl {
    let bounds = [[shift - size; 3], [shift + size; 3]];
    CameraControl::new(framing(bounds), Vec::new(), bounds, UP)
}

fn distance(camera: &Camera) -> f64 {
    (vec(camera.target) - vec(camera.eye)).length()
}

fn key(key: &str, down: bool) -> Event {
    Event::Key { key: key.to_owned(), down, modifiers: Modifiers::default() }
}

fn press(control: &mut CameraControl, name: &str) -> bool {
    control.handle(&key(name, true), 1.5)
}

fn button(button: Button, down: bool, shift: bool) -> Event {
    Event::Button { button, down, modifiers: Modifiers { shift, ..Modifiers::default() } }
}

fn drag(control: &mut CameraControl, with: Button, shift: bool, from: [f32; 2], to: [f32; 2]) {
    let aspect = 1.5;
    control.handle(&Event::Pointer { x: from[0], y: from[1] }, aspect);
    control.handle(&button(with, true, shift), aspect);
    for i in 1..=10 {
        let share = i as f32 / 10.0;
        let [x, y] = [0, 1].map(|k| from[k] + (to[k] - from[k]) * share);
        control.handle(&Event::Pointer { x, y }, aspect);
    }
    control.handle(&button(with, false, shift), aspect);
}

/// Share of the picture at which a camera shows a point.
fn project(camera: &Camera, point: DVec3, aspect: f64) -> [f64; 2] {
    let pose = Pose::of(camera, &World::new(UP)).unwrap();
    let [right, up, forward] = pose.axes(&World::new(UP));
    let from_eye = point - vec(camera.eye);
    let height = match camera.projection {
        Projection::Perspective { fov_y } => 2.0 * from_eye.dot(forward) * (0.5 * f64::from(fov_y)).tan(),
        Projection::Orthographic { height } => f64::from(height),
    };
    [0.5 + from_eye.dot(right) / (height * aspect), 0.5 - from_eye.dot(up) / height]
}

#[test]
fn an_untouched_camera_is_the_given_one_to_the_bit() {
    let home = Camera {
        name: "odd".into(),
        eye: [0.1, 0.2, 0.3],
        target: [7.7, -3.1, 0.4],
        up: [0.3, 0.9, -0.2],
        projection: Projection::Perspective { fov_y: 0.612_345 },
    };
    let mut control = CameraControl::new(home.clone(), Vec::new(), [[-1.0; 3], [1.0; 3]], UP);
    assert_eq!(control.camera(), &home);
    drag(&mut control, Button::Left, false, [0.2, 0.2], [0.7, 0.9]);
    assert_ne!(control.camera(), &home);
    assert!(press(&mut control, "Enter"));
    assert_eq!(control.camera(), &home);
}

#[test]
fn a_tilted_camera_keeps_its_tilt_when_it_starts_to_orbit() {
    let world = World::new(UP);
    for up in [[0.3, 0.9, -0.2], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
        let projection = Projection::Perspective { fov_y: 0.8 };
        let camera = Camera { name: String::new(), eye: [3.0, 2.0, 1.0], target: [0.0; 3], up, projection };
        let pose = Pose::of(&camera, &world).unwrap();
        let again = Pose::of(&pose.camera(&world, ""), &world).unwrap();
        let (before, after) = (pose.axes(&world), again.axes(&world));
        assert!((0..3).all(|i| before[i].distance(after[i]) < 1e-6), "{up:?}");
        assert!(before[1].dot(vec(up)) > 0.0, "{up:?}");
    }
}

#[test]
fn a_camera_that_cannot_be_is_replaced() {
    let bounds = [[-1.0; 3], [1.0; 3]];
    for break_it in [
        (|camera: &mut Camera| camera.target = camera.eye) as fn(&mut Camera),
        |camera| camera.eye[0] = f32::NAN,
        |camera| camera.projection = Projection::Perspective { fov_y: 4.0 },
        |camera| camera.projection = Projection::Orthographic { height: 0.0 },
        |camera| (camera.eye, camera.target) = ([3e38; 3], [-3e38; 3]),
    ] {
        let mut home = framing(bounds);
        break_it(&mut home);
        let mut control = CameraControl::new(home.clone(), Vec::new(), bounds, UP);
        assert!(is_usable(control.camera()));
        assert!(control.set(home).is_err());
    }
}

#[test]
fn bounds_without_a_size_do_no_harm() {
    for bounds in [
        [[0.0; 3]; 2],
        [[f32::NAN; 3]; 2],
        [[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]],
        [[1.0; 3], [-1.0; 3]],
        [[-3e38; 3], [3e38; 3]],
    ] {
        let mut control = CameraControl::new(framing([[-1.0; 3], [1.0; 3]]), Vec::new(), bounds, [0.0; 3]);
        for name in ["Home", "5", "Home", "5", "w"] {
            press(&mut control, name);
            control.step(Duration::from_millis(100));
            assert!(is_usable(control.camera()), "{bounds:?}");
        }
    }
}

#[test]
fn presets_look_along_the_axes_and_the_top_can_be_left_again() {
    let mut control = control(1.0, 0.0);
    for (name, away) in [
        ("1", [0.0, 0.0, 1.0]),
        ("2", [0.0, 0.0, -1.0]),
        ("3", [1.0, 0.0, 0.0]),
        ("4", [-1.0, 0.0, 0.0]),
        ("7", [0.0, 1.0, 0.0]),
        ("8", [0.0, -1.0, 0.0]),
        ("9", [1.0 / 3f64.sqrt(); 3]),
    ] {
        press(&mut control, name);
        let camera = control.camera();
        let direction = (vec(camera.eye) - vec(camera.target)).normalize();
        assert!(direction.distance(away.into()) < 1e-6, "{name}: {direction}");
    }
    press(&mut control, "7");
    assert_eq!(control.camera().up, [0.0, 0.0, -1.0]);
    // From above, a drag to the right turns the picture about the world's upward axis; back again ends where it began.
    let top = control.camera().clone();
    drag(&mut control, Button::Left, false, [0.2, 0.2], [0.6, 0.2]);
    assert_ne!(control.camera().up, top.up);
    drag(&mut control, Button::Left, false, [0.6, 0.2], [0.2, 0.2]);
    let back = control.camera();
    assert!(vec(back.eye).distance(vec(top.eye)) < 1e-5 && vec(back.up).distance(vec(top.up)) < 1e-5);
}

#[test]
fn other_upward_axes_have_their_own_front() {
    for (up, front) in [([0.0, 0.0, 1.0], [0.0, -1.0, 0.0]), ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0])] {
        let mut control = CameraControl::new(framing([[-1.0; 3], [1.0; 3]]), Vec::new(), [[-1.0; 3], [1.0; 3]], up);
        control.act(Action::Preset(Preset::Front));
        let camera = control.camera();
        let away = (vec(camera.eye) - vec(camera.target)).normalize();
        assert!(away.distance(front.into()) < 1e-6, "{up:?}: {away}");
        assert_eq!(camera.up, up);
    }
}

#[test]
fn a_pole_is_a_stop() {
    let mut control = control(1.0, 0.0);
    press(&mut control, "1");
    for _ in 0..20 {
        drag(&mut control, Button::Left, false, [0.5, 0.1], [0.5, 0.9]);
    }
    let camera = control.camera().clone();
    assert!(camera.eye[1] > 0.0 && camera.up[2] < -0.99, "{camera:?}");
    drag(&mut control, Button::Left, false, [0.5, 0.9], [0.5, 0.65]);
    let camera = control.camera();
    assert!(camera.eye[1] > 0.0 && camera.eye[2] > 0.1, "{camera:?}");
}

#[test]
fn switching_the_projection_keeps_sizes_at_the_target() {
    let mut control = control(1.0, 0.0);
    let before = control.camera().clone();
    press(&mut control, "1");
    let at = vec(control.camera().target) + DVec3::new(0.3, 0.0, 0.0);
    let seen = project(control.camera(), at, 1.5);
    press(&mut control, "5");
    assert!(matches!(control.camera().projection, Projection::Orthographic { .. }));
    let parallel = project(control.camera(), at, 1.5);
    assert!((0..2).all(|i| (seen[i] - parallel[i]).abs() < 1e-5), "{seen:?} {parallel:?}");
    press(&mut control, "5");
    assert_eq!(control.camera().projection, before.projection);
    assert!((distance(control.camera()) / distance(&before) - 1.0).abs() < 1e-5);
}

#[test]
fn framing_sees_everything_in_pictures_of_any_format() {
    for aspect in [0.3f32, 1.0, 3.0] {
        for parallel in [false, true] {
            let mut control = control(1.0, 5.0);
            if parallel {
                press(&mut control, "5");
            }
            drag(&mut control, Button::Right, false, [0.5, 0.5], [0.5, 0.1]);
            control.handle(&key("Home", true), aspect);
            for corner in 0..8 {
                let corner = DVec3::from([0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { 4.0 } else { 6.0 }));
                let at = project(control.camera(), corner, f64::from(aspect));
                assert!(at.iter().all(|share| (0.0..=1.0).contains(share)), "{aspect} {parallel} {at:?}");
            }
        }
    }
}

#[test]
fn a_focus_is_in_the_middle_and_the_eye_stays() {
    let mut control = control(1.0, 0.0);
    let eye = control.camera().eye;
    control.set_focus([0.5, -0.25, 0.1]);
    assert_eq!(control.camera().target, [0.5, -0.25, 0.1]);
    assert!(vec(control.camera().eye).distance(vec(eye)) < 1e-6);
    control.set_focus([f32::NAN; 3]);
    control.set_focus(eye);
    assert!(is_usable(control.camera()));
}

#[test]
fn flight_goes_on_while_a_key_is_held() {
    let mut control = control(1.0, 0.0);
    press(&mut control, "1");
    let start = control.camera().clone();
    assert!(!control.step(Duration::from_millis(100)) && !control.is_moving());
    press(&mut control, "w");
    assert!(control.is_moving() && control.step(Duration::from_millis(100)));
    let one = start.eye[2] - control.camera().eye[2];
    assert!(one > 0.0);
    assert_eq!(distance(control.camera()) as f32, distance(&start) as f32);
    // Shift makes it faster, and the key goes up under another name.
    let shift = Modifiers { shift: true, ..Modifiers::default() };
    control.handle(&Event::Key { key: "Shift".into(), down: true, modifiers: shift }, 1.0);
    let before = control.camera().eye[2];
    control.step(Duration::from_millis(100));
    assert!(((before - control.camera().eye[2]) / one - 4.0).abs() < 1e-3);
    assert!(control.handle(&Event::Key { key: "W".into(), down: false, modifiers: shift }, 1.0));
    assert!(!control.step(Duration::from_millis(100)));
    press(&mut control, "a");
    control.handle(&Event::Blur, 1.0);
    assert!(!control.is_moving());
    // Opposite keys lead nowhere, and a pause of a minute is no leap.
    press(&mut control, "a");
    press(&mut control, "d");
    assert!(!control.step(Duration::from_secs(60)));
}

#[test]
fn the_cameras_of_the_scene_are_stepped_through() {
    let camera = |x: f32| Camera { name: format!("at {x}"), eye: [x, 0.0, 5.0], ..framing([[-1.0; 3], [1.0; 3]]) };
    let cameras = vec![camera(1.0), camera(2.0), camera(3.0)];
    let mut control = CameraControl::new(cameras[0].clone(), cameras.clone(), [[-1.0; 3], [1.0; 3]], UP);
    for (name, expected) in [("PageUp", 2), ("PageDown", 0), ("c", 1), ("PageDown", 2), ("PageDown", 0), ("PageUp", 2)]
    {
        assert!(press(&mut control, name));
        assert_eq!(control.camera(), &cameras[expected], "{name}");
    }
    let mut none = self::control(1.0, 0.0);
    press(&mut none, "PageUp");
}

#[test]
fn a_click_does_not_move_the_camera() {
    let mut control = control(1.0, 0.0);
    let before = control.camera().clone();
    drag(&mut control, Button::Left, false, [0.5, 0.5], [0.501, 0.502]);
    assert_eq!(control.camera(), &before);
}

#[test]
fn reading_the_scene_again_keeps_the_view() {
    let mut control = control(1.0, 0.0);
    drag(&mut control, Button::Left, false, [0.2, 0.2], [0.6, 0.5]);
    let before = control.camera().clone();
    let bounds = [[-9.0; 3], [9.0; 3]];
    control.rebase(framing(bounds), Vec::new(), bounds, UP);
    assert_eq!(control.camera(), &before);
    press(&mut control, "r");
    assert_eq!(control.camera(), &framing(bounds));
}

fn share() -> impl Strategy<Value = f32> {
    prop_oneof![8 => -0.5f32..1.5, 1 => any::<f32>(), 1 => Just(f32::NAN)]
}

fn any_button() -> impl Strategy<Value = Button> {
    prop_oneof![Just(Button::Left), Just(Button::Middle), Just(Button::Right)]
}

fn modifiers() -> impl Strategy<Value = Modifiers> {
    any::<[bool; 3]>().prop_map(|[shift, ctrl, alt]| Modifiers { shift, ctrl, alt })
}

fn any_key() -> impl Strategy<Value = String> {
    let names: Vec<String> = BINDINGS.iter().flat_map(|binding| binding.keys.split(", ")).map(str::to_owned).collect();
    prop::sample::select(names)
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => (share(), share()).prop_map(|(x, y)| Event::Pointer { x, y }),
        2 => (any_button(), any::<bool>(), modifiers())
            .prop_map(|(button, down, modifiers)| Event::Button { button, down, modifiers }),
        2 => prop_oneof![-30f32..30.0, any::<f32>()].prop_map(|notches| Event::Wheel { notches }),
        3 => (any_key(), any::<bool>(), modifiers())
            .prop_map(|(key, down, modifiers)| Event::Key { key, down, modifiers }),
        1 => Just(Event::Blur),
    ]
}

fn size() -> impl Strategy<Value = f32> {
    (-6f32..6.0).prop_map(|power| 10f32.powf(power))
}

proptest! {
    #[test]
    fn whatever_happens_there_is_a_camera(
        size in size(),
        place in -3f32..3.0,
        events in prop::collection::vec((event(), 0u64..400, any::<f32>()), 1..200),
    ) {
        let mut control = control(size, size * place);
        for (event, milliseconds, aspect) in events {
            control.handle(&event, aspect);
            control.step(Duration::from_millis(milliseconds));
            let camera = control.camera();
            prop_assert!(is_usable(camera), "{camera:?}");
            let world = World::new(UP);
            let pose = Pose::of(camera, &world);
            prop_assert!(pose.is_some(), "{camera:?}");
            // Up is well across the view, so that no rounding turns the picture.
            let forward = (vec(camera.target) - vec(camera.eye)).normalize();
            prop_assert!(forward.cross(vec(camera.up).normalize()).length() > 0.05, "{camera:?}");
        }
    }

    #[test]
    fn drags_keep_the_distance(
        size in size(),
        pan in any::<bool>(),
        drags in prop::collection::vec([0f32..1.0, 0f32..1.0, 0f32..1.0, 0f32..1.0], 1..20),
    ) {
        let mut control = control(size, 0.0);
        let before = distance(control.camera());
        for [x0, y0, x1, y1] in drags {
            drag(&mut control, Button::Left, pan, [x0, y0], [x1, y1]);
            let after = distance(control.camera());
            prop_assert!((after / before - 1.0).abs() < 1e-4, "{before} {after}");
        }
    }

    #[test]
    fn a_pan_keeps_the_point_under_the_pointer(
        size in size(),
        parallel in any::<bool>(),
        from in [0.1f32..0.9, 0.1f32..0.9],
        to in [0.1f32..0.9, 0.1f32..0.9],
    ) {
        let mut control = control(size, 0.0);
        if parallel {
            press(&mut control, "5");
        }
        // One step, so that all of the drag counts.
        let aspect = 1.5;
        prop_assume!((from[0] - to[0]).abs() > 0.01);
        let target = vec(control.camera().target);
        let before = project(control.camera(), target, aspect);
        control.handle(&Event::Pointer { x: from[0], y: from[1] }, aspect as f32);
        control.handle(&button(Button::Middle, true, false), aspect as f32);
        control.handle(&Event::Pointer { x: to[0], y: to[1] }, aspect as f32);
        let after = project(control.camera(), target, aspect);
        for i in 0..2 {
            let expected = f64::from(to[i] - from[i]);
            prop_assert!((after[i] - before[i] - expected).abs() < 1e-4, "{before:?} {after:?}");
        }
    }

    #[test]
    fn zoom_never_passes_the_target(size in size(), notches in prop::collection::vec(-20f32..20.0, 1..100)) {
        let mut control = control(size, size);
        let forward = |camera: &Camera| (vec(camera.target) - vec(camera.eye)).normalize();
        let before = forward(control.camera());
        for notches in notches {
            control.handle(&Event::Wheel { notches: notches + 10.0 }, 1.0);
            prop_assert!(forward(control.camera()).dot(before) > 0.999);
        }
        control.handle(&Event::Wheel { notches: -1000.0 }, 1.0);
        prop_assert!(forward(control.camera()).dot(before) > 0.999);
    }

    #[test]
    fn flags_are_read_back_to_the_same_bits(
        eye in any::<[f32; 3]>(),
        target in any::<[f32; 3]>(),
        up in any::<[f32; 3]>(),
        fov_y in 1e-4f32..3.1,
    ) {
        let camera = Camera { name: String::new(), eye, target, up, projection: Projection::Perspective { fov_y } };
        let text = super::flags::flags(&camera, UP);
        let words: Vec<&str> = text.split(' ').collect();
        let vector = |i: usize| words[i].split(',').map(|x| x.parse::<f32>().unwrap().to_bits()).collect::<Vec<_>>();
        prop_assert_eq!((words[0], words[2], words[4], words[6]), ("--eye", "--target", "--up", "--fov"));
        prop_assert_eq!([vector(1), vector(3), vector(5)], [eye, target, up].map(|v| v.map(f32::to_bits).to_vec()));
        prop_assert_eq!(words[7].parse::<f64>().unwrap().to_radians() as f32, fov_y);
    }
}

/// A drag in one step with the left button and Ctrl held or not.
fn turn(control: &mut CameraControl, ctrl: bool, to: [f32; 2]) {
    let modifiers = Modifiers { ctrl, ..Modifiers::default() };
    control.handle(&Event::Pointer { x: 0.5, y: 0.5 }, 1.5);
    control.handle(&Event::Button { button: Button::Left, down: true, modifiers }, 1.5);
    control.handle(&Event::Pointer { x: to[0], y: to[1] }, 1.5);
    control.handle(&Event::Button { button: Button::Left, down: false, modifiers }, 1.5);
}

#[test]
fn a_look_around_leaves_the_eye_where_it_is() {
    let mut looks = control(2.0, 5.0);
    let (eye, target) = (looks.camera().eye, vec(looks.camera().target));
    turn(&mut looks, true, [0.75, 0.5]);
    let apart = (vec(looks.camera().eye) - vec(eye)).length();
    assert!(apart < 1e-5, "{apart}");
    // What was in the middle is about where the pointer went.
    let [x, y] = project(looks.camera(), target, 1.5);
    assert!((x - 0.75).abs() < 0.03 && (y - 0.5).abs() < 0.03, "{x} {y}");
    turn(&mut looks, true, [0.5, 0.25]);
    assert!(project(looks.camera(), target, 1.5)[1] < 0.3);

    // The key makes plain drags do it, and Ctrl the other then.
    let mut keyed = control(2.0, 5.0);
    assert!(press(&mut keyed, "j"));
    turn(&mut keyed, false, [0.75, 0.5]);
    assert!((vec(keyed.camera().eye) - vec(eye)).length() < 1e-5);
    turn(&mut keyed, true, [0.75, 0.5]);
    assert!((vec(keyed.camera().eye) - vec(eye)).length() > 0.1, "it orbits");
}

#[test]
fn parallel_rays_have_no_eye_and_orbit() {
    let [mut looks, mut orbits] = [control(1.0, 0.0), control(1.0, 0.0)];
    for (control, ctrl) in [(&mut looks, true), (&mut orbits, false)] {
        press(control, "5");
        turn(control, ctrl, [0.7, 0.6]);
    }
    assert_eq!(looks.camera(), orbits.camera());
}

#[test]
fn a_camera_without_a_target_turns_about_what_it_sees() {
    let bounds = [[-0.1; 3], [0.1; 3]];
    // As of glTF: a step of one unit, far beyond the scene.
    let home = Camera { eye: [0.0, 0.0, 0.5], target: [0.0, 0.0, -0.5], ..framing(bounds) };
    let control = || CameraControl::new(home.clone(), vec![home.clone()], bounds, [0.0, 1.0, 0.0]).without_targets();
    assert_eq!(control().camera(), &home, "nothing is another picture before something moves");
    let mut moved = control();
    moved.handle(&Event::Wheel { notches: 2.0 }, 1.5);
    let [x, y, z] = moved.camera().eye;
    assert!(x == 0.0 && y == 0.0 && (z - 0.5 * 0.85f32.powi(2)).abs() < 1e-5, "{z}");
    // And so after it was chosen again.
    moved.act(Action::ResetCamera);
    assert_eq!(moved.camera(), &home);
    moved.handle(&Event::Wheel { notches: 2.0 }, 1.5);
    assert!((moved.camera().eye[2] - z).abs() < 1e-6);
    // Looking away from everything it keeps what it has.
    let away = Camera { target: [0.0, 0.0, 1.5], ..home };
    let mut away = CameraControl::new(away, Vec::new(), bounds, [0.0, 1.0, 0.0]).without_targets();
    away.handle(&Event::Wheel { notches: 1.0 }, 1.5);
    assert!((away.camera().eye[2] - 0.65).abs() < 1e-5);
}
