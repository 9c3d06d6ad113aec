//! Scene files that ask for how they are rendered, and edited ones that were saved.

use crate::common::{png, Place, SCENE};
use raywarp::scene::load::{self, LoadOptions};
use raywarp::scene::save::{self, Original};

/// A place with a scene of 40x30 pixels without shadows, and a mesh file.
fn place() -> Place {
    let place = Place::new();
    let render = "[render]\nsize = [40, 30]\nspp = 2\nshadows = false\nexposure = 1\naccel = \"kd\"\n";
    place.write("scene.toml", format!("{SCENE}\n{render}"));
    place
}

#[test]
fn the_scene_file_has_the_defaults_and_the_command_line_wins() {
    let place = place();
    let run = place.render(&["scene.toml", "-o", "a.png", "--stats=json"]).says("a.png: 40x30 pixels");
    assert!(run.out().contains("\"accel\": \"kd\"") && run.out().contains("\"spp\": 2"), "{}", run.out());
    let run = place.render(&["scene.toml", "--size", "8x6", "--spp", "1", "--accel", "bvh2", "--stats=json"]);
    let run = run.says("8x6 pixels");
    assert!(run.out().contains("\"accel\": \"bvh2\"") && run.out().contains("\"spp\": 1"), "{}", run.out());
    // One stop brighter than without, and as dark as the command line says.
    place.render(&["scene.toml", "-o", "b.png", "--exposure", "0"]).succeeds();
    let (bright, dark) = (png(&place.path("a.png")).2[0], png(&place.path("b.png")).2[0]);
    assert_eq!((bright, dark), ([188, 255, 137], [137, 188, 99]));
    place.render(&["scene.toml", "--crop", "0,0,41,3"]).fails(2, "leaves the picture of 40x30 pixels");
}

#[test]
fn shadows_are_what_was_said_last() {
    let place = Place::new();
    let triangle = "vertices = [[-9, -9, 0], [9, -9, 0], [0, 9, 0]]\nfaces = [[0, 1, 2]]\n";
    let scene = "version = 1\nambient = 0\nbackground = 0\n[render]\nsize = [5, 5]\nshadows = false\n\
                 [[cameras]]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\nfov = 5\n\
                 [[lights]]\nkind = \"directional\"\ndirection = [0, -1, -1]\n";
    let (wall, roof) = (format!("[[meshes]]\n{triangle}"), format!("[[meshes]]\nname = \"r\"\n{triangle}"));
    let raised = "[[instances]]\nmesh = \"r\"\ntranslate = [0, 6, 6]\n";
    place.write("s.toml", format!("{scene}{wall}{roof}{raised}"));
    let lit = |options: &[&str]| {
        place.render(&[&["s.toml", "-o", "a.png"], options].concat()).succeeds();
        png(&place.path("a.png")).2[12] != [0; 3]
    };
    assert!(lit(&[]) && !lit(&["--shadows"]) && lit(&["--no-shadows"]));
    assert!(lit(&["--shadows", "--no-shadows"]) && !lit(&["--no-shadows", "--shadows"]));
}

#[test]
fn queries_take_the_structure_of_the_scene_file() {
    let place = place();
    place.write("rays.csv", "0,0,4,0,0,-1\n");
    let ask = |options: &[&str]| {
        let all = [&["query", "scene.toml", "--rays", "rays.csv", "--device", "cpu", "-q", "--json"], options].concat();
        place.run(&all).succeeds().out()
    };
    assert!(ask(&[]).contains("\"accel\": \"kd\""));
    assert!(ask(&["--accel", "bvh2"]).contains("\"accel\": \"bvh2\""));
}

#[test]
fn an_edited_scene_that_was_saved_is_the_picture_of_one_written_by_hand() {
    let place = place();
    let path = place.path("scene.toml");
    let by_hand = std::fs::read_to_string(&path).unwrap();
    let by_hand = by_hand.replace("emission = [0.5, 0, 0]", "emission = [0.1, 0.3, 0.7]\nreflection = 0.25");
    place.write("hand.toml", by_hand.replace("eye = [0, 0, 4]", "eye = [0.25, 0.5, 3]"));

    let loaded = load::load(&path, &LoadOptions::default()).unwrap();
    let mut now = loaded.scene.outline();
    let material = now.materials.iter_mut().find(|material| material.name == "red").unwrap();
    (material.emission, material.reflection) = ([0.1, 0.3, 0.7], [0.25; 3]);
    now.cameras.iter_mut().for_each(|camera| camera.eye = [0.25, 0.5, 3.0]);
    save::to_file(&Original::of(Some(&path), &loaded), &loaded.scene, &now, &place.path("saved.toml")).unwrap();

    for (scene, picture) in [("hand.toml", "hand.png"), ("saved.toml", "saved.png"), ("scene.toml", "scene.png")] {
        place.render(&[scene, "-o", picture]).succeeds();
    }
    let pixels = |name: &str| png(&place.path(name));
    assert!(pixels("hand.png") == pixels("saved.png"));
    assert!(pixels("hand.png") != pixels("scene.png"));
    place.run(&["info", "saved.toml"]).succeeds();
}

#[test]
fn the_built_in_scene_is_a_base() {
    let place = Place::new();
    place.write("scene.toml", "version = 1\nbase = \"built-in\"\n");
    place.render(&["scene.toml", "-o", "a.png", "--size", "48x27", "--samples", "1"]).succeeds();
    place.render(&["-o", "b.png", "--size", "48x27"]).succeeds();
    assert!(png(&place.path("a.png")) == png(&place.path("b.png")));
}

#[test]
fn info_counts_what_edits_name_by_number() {
    let place = place();
    let run = place.run(&["info", "scene.toml"]).succeeds();
    for part in ["1: 0 ''", "  0 red", "size 40x30, samples 2, shadows off, exposure 1, accel kd"] {
        assert!(run.out().contains(part), "{}", run.out());
    }
}
