//! Scene files that start from another scene: what comes along, what is edited, and what is refused.

use std::path::Path;

use crate::common::shipped;
use raywarp::scene::load::{self, LoadOptions};
use raywarp::scene::{AlphaMode, RenderDefaults, Scene, Transform};

/// Three materials, a mesh that is placed twice, a light, a camera, a sky and options.
const BASE: &str = r#"
version = 1
background = 0.5
ambient = 0.25

[render]
size = [64, 48]
spp = 3

[[materials]]
name = "red"
diffuse = [1, 0, 0]
specular = 0.5
opacity = 0.5

[[materials]]
name = "masked"
alpha = "mask"
cutoff = 0.75

[[materials]]
name = "plain"

[[meshes]]
name = "t"
vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
uvs = [[0, 0], [1, 0], [0, 1]]
faces = [[0, 1, 2]]
material = "red"

[[instances]]
mesh = "t"
name = "a"

[[instances]]
mesh = "t"
name = "twin"

[[instances]]
mesh = "t"
name = "twin"
material = "masked"

[[lights]]
name = "base's"
kind = "point"
position = [0, 1, 0]

[[cameras]]
name = "base's"
eye = [0, 0, 1]
target = [0, 0, 0]
"#;

const OWN: &str = "[[lights]]\nname = \"own\"\nkind = \"point\"\nposition = [0,0,3]\n\
                   [[cameras]]\nname = \"own\"\neye = [0,0,9]\ntarget = [0,0,0]\n";

fn load_in(folder: &Path, text: &str) -> Result<Scene, String> {
    std::fs::write(folder.join("base.toml"), BASE).unwrap();
    let path = folder.join("scene.toml");
    std::fs::write(&path, format!("version = 1\n{text}")).unwrap();
    match load::load(&path, &LoadOptions::default()) {
        Ok(loaded) => Ok(loaded.scene),
        Err(error) => Err(error.to_string().replace(&format!("{}/", folder.display()), "")),
    }
}

fn scene(text: &str) -> Scene {
    load_in(tempfile::tempdir().unwrap().path(), text).unwrap()
}

fn names<'a, T: 'a>(list: &'a [T], name: impl Fn(&'a T) -> &'a String) -> Vec<&'a str> {
    list.iter().map(|item| name(item).as_str()).collect()
}

#[test]
fn a_base_comes_along_whole_and_apart() {
    let scene = scene("base = \"base.toml\"\n");
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.lights.len(), scene.cameras.len()), (1, 3, 1, 1));
    assert!(scene.background.is_some() && scene.ambient == Some([0.25; 3]));
    assert_eq!(scene.render.to_string(), "size 64x48, samples 3");
    let built_in = self::scene("base = \"built-in\"\n");
    assert_eq!(built_in.cameras, load::builtin().unwrap().scene.cameras);
}

#[test]
fn a_file_adds_to_its_base() {
    let mesh =
        "[[meshes]]\nname = \"t\"\nvertices = [[0,0,0],[1,0,0],[0,1,0]]\nfaces = [[0,1,2]]\nmaterial = \"red\"\n";
    let render = "[render]\nspp = 8\ntone_map = \"filmic\"\n";
    let scene =
        scene(&format!("base = \"base.toml\"\nambient = 0\n{render}{OWN}{mesh}[[materials]]\nname = \"red\"\n"));
    assert_eq!(names(&scene.lights, |light| &light.name), ["base's", "own"]);
    assert_eq!(names(&scene.cameras, |camera| &camera.name), ["own", "base's"]);
    assert_eq!((scene.instances.len(), scene.ambient), (4, Some([0.0; 3])));
    assert_eq!(scene.render.to_string(), "size 64x48, samples 8, tone map filmic");
    // The file's own "red" comes before its base's of that name.
    let own = scene.meshes[1].materials[0] as usize;
    assert_eq!((scene.materials[own].diffuse, scene.materials[0].diffuse), ([0.7; 3], [1.0, 0.0, 0.0]));
}

#[test]
fn parts_of_a_base_can_stay_behind() {
    let none = "lights = false, cameras = false, background = false, ambient = false, render = false";
    let scene = scene(&format!("base = {{ file = \"base.toml\", {none} }}\n{OWN}"));
    assert_eq!(names(&scene.lights, |light| &light.name), ["own"]);
    assert_eq!(names(&scene.cameras, |camera| &camera.name), ["own"]);
    assert_eq!((scene.background, scene.ambient, scene.render), (None, None, RenderDefaults::default()));
}

#[test]
fn materials_of_other_files_are_edited_key_by_key() {
    let edit = |keys: &str| scene(&format!("base = \"base.toml\"\n[[materials]]\n{keys}\n")).materials;
    let red = edit("replaces = \"red\"\ndiffuse = 0").remove(0);
    assert_eq!((red.name.as_str(), red.diffuse, red.ambient), ("red", [0.0; 3], [1.0, 0.0, 0.0]));
    assert_eq!((red.specular, red.alpha), ([0.5; 3], AlphaMode::Blend));
    assert_eq!(edit("replaces = 1\ncutoff = 0.25")[1].alpha, AlphaMode::Mask(0.25));
    assert_eq!(edit("replaces = 1\nname = \"new\"\nalpha = \"opaque\"")[1].alpha, AlphaMode::Opaque);
    // Opaque stays opaque until the file says otherwise.
    let opaque = edit("replaces = 2\nopacity = 0.5");
    assert_eq!((opaque[2].name.as_str(), opaque[2].alpha), ("plain", AlphaMode::Opaque));
}

#[test]
fn materials_of_named_meshes_are_edited_too_all_of_a_name() {
    let meshes = "[[meshes]]\nfile = \"base.toml\"\n".repeat(2);
    let scene = scene(&format!("{meshes}[[materials]]\nreplaces = \"red\"\ndiffuse = 0.125\n"));
    assert_eq!(scene.materials.iter().filter(|material| material.diffuse == [0.125; 3]).count(), 2);
}

#[test]
fn names_of_materials_are_those_before_any_change() {
    let rename = "[[materials]]\nreplaces = \"red\"\nname = \"blue\"\n";
    let mesh = "[[meshes]]\nname = \"m\"\nfile = \"base.toml\"\n[[instances]]\nmesh = \"m\"\nmaterial = \"red\"\n";
    let scene = scene(&format!("{rename}{mesh}"));
    let index = scene.instances[0].material.unwrap() as usize;
    assert_eq!(scene.materials[index].name, "blue");
}

#[test]
fn maps_can_be_given_and_taken_away() {
    let folder = tempfile::tempdir().unwrap();
    let image = shipped("glass/checker.png");
    std::fs::copy(image, folder.path().join("c.png")).unwrap();
    let maps = "diffuse_map = \"c.png\"\nheight_map = { file = \"c.png\", strength = 2 }\n";
    let with = load_in(folder.path(), &format!("base = \"base.toml\"\n[[materials]]\nreplaces = 0\n{maps}")).unwrap();
    assert!(with.materials[0].diffuse_map.is_some() && with.materials[0].normal_map.is_some());
    assert_eq!(with.images.len(), 1);
    std::fs::rename(folder.path().join("scene.toml"), folder.path().join("maps.toml")).unwrap();
    let none = "diffuse_map = false\nnormal_map = false\n";
    let none = load_in(folder.path(), &format!("base = \"maps.toml\"\n[[materials]]\nreplaces = \"red\"\n{none}"));
    let material = none.unwrap().materials.remove(0);
    assert!(material.diffuse_map.is_none() && material.normal_map.is_none());
}

#[test]
fn moves_set_the_whole_transform() {
    let moved = "[[moves]]\ninstance = \"a\"\nmatrix = [[1,0,0,4],[0,2,0,5],[0,0,1,6]]\n\
                 [[moves]]\ninstance = 2\ntranslate = [0, 0, 7]\n";
    let scene = scene(&format!("base = \"base.toml\"\n{moved}"));
    let columns = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(scene.instances[0].transform, Transform { columns, translation: [4.0, 5.0, 6.0] });
    assert_eq!(scene.instances[1].transform, Transform::IDENTITY);
    assert_eq!(scene.instances[2].transform.translation, [0.0, 0.0, 7.0]);
}

#[test]
fn the_render_table_is_read_and_that_of_a_mesh_ignored() {
    let table = "[render]\nsize = [320, 200]\nspp = 4\nmax_depth = 0\nshadows = false\nseed = 4294967295\n\
                 exposure = -1.5\ntone_map = \"filmic\"\naccel = \"bvh8f\"\ntree = \"high\"\n";
    let expected =
        "size 320x200, samples 4, max depth 0, shadows off, seed 4294967295, exposure -1.5, tone map filmic, \
                    accel bvh8f, tree high";
    assert_eq!(scene(table).render.to_string(), expected);
    assert_eq!(scene("[[meshes]]\nfile = \"base.toml\"\n").render, RenderDefaults::default());
}

#[test]
fn a_base_is_never_its_own_and_not_endlessly_deep() {
    let folder = tempfile::tempdir().unwrap();
    let error = load_in(folder.path(), "base = \"scene.toml\"\n").unwrap_err();
    assert!(error.contains("names itself"), "{error}");
    std::fs::write(folder.path().join("b.toml"), "version = 1\nbase = \"./scene.toml\"\n").unwrap();
    let error = load_in(folder.path(), "base = \"b.toml\"\n").unwrap_err();
    assert!(error.contains("names itself"), "{error}");

    let write = |index: usize, base: &str| {
        std::fs::write(folder.path().join(format!("{index}.toml")), format!("version = 1\nbase = \"{base}\"\n"))
            .unwrap();
    };
    write(0, "base.toml");
    (1..20).for_each(|index| write(index, &format!("{}.toml", index - 1)));
    assert_eq!(load_in(folder.path(), "base = \"13.toml\"\n").unwrap().lights.len(), 1);
    let error = load_in(folder.path(), "base = \"14.toml\"\n").unwrap_err();
    assert!(error.contains("more than 16 scene files name each other"), "{error}");
}

#[test]
fn errors_say_where_what_and_what_instead() {
    let cases = [
        ("base = 3", "scene.toml:2:8: the whole number 3; expected a scene's file name"),
        ("base = { fiel = \"x\" }", "Did you mean 'file'?"),
        ("base = \"none.glb\"", "cannot read none.glb"),
        ("base = \"base.toml\"\nup = \"+Z\"", "scene.toml:2:8: an `up` beside a base"),
        ("[[materials]]\ndiffuse = 1", "scene.toml:2:1: a material without a name"),
        ("[[materials]]\nreplaces = \"x\"", "scene.toml:3:12: there is no material 'x'"),
        ("base = \"base.toml\"\n[[materials]]\nreplaces = \"rad\"", "Did you mean 'red'?"),
        ("base = \"base.toml\"\n[[materials]]\nreplaces = 3", "there is no material 3; expected a number from 0 to 2"),
        ("base = \"base.toml\"\n[[materials]]\nreplaces = -1", "the whole number -1; expected a name, or a number"),
        ("base = \"base.toml\"\n[[materials]]\nreplaces = 0.5", "expected a name, or a number from 0"),
        ("[[materials]]\nname = \"own\"\n[[materials]]\nreplaces = 0", "material 0, which is of this file"),
        (
            "base = \"base.toml\"\n[[materials]]\nreplaces = 0\n[[materials]]\nreplaces = \"red\"",
            "6:12: a second change",
        ),
        ("base = \"base.toml\"\n[[materials]]\nreplaces = \"red\"\ncutoff = 0.5", "a cutoff without alpha"),
        ("base = \"base.toml\"\n[[materials]]\nreplaces = 0\ndiffuse_map = true", "or false"),
        ("base = \"base.toml\"\n[[moves]]\ninstance = \"b\"\nscale = 2", "scene.toml:4:12: there is no instance 'b'"),
        ("base = \"base.toml\"\n[[moves]]\ninstance = 3\nscale = 2", "expected a number from 0 to 2"),
        ("base = \"base.toml\"\n[[moves]]\ninstance = \"twin\"\nscale = 2", "2 instances of that name"),
        ("base = \"base.toml\"\n[[moves]]\ninstance = \"a\"", "scene.toml:3:1: a move without a place"),
        ("base = \"base.toml\"\n[[moves]]\ninstance = 0\nscale = 2\nmatrix = []", "a matrix beside"),
        ("[[moves]]\ninstance = 0\nscale = 2", "there is no instance 0; expected no number"),
        ("[render]\nsize = [0, 5]", "expected a whole number from 1 to 65536"),
        ("[render]\nsize = 5", "scene.toml:3:8: "),
        ("[render]\nspp = 1.5", "expected a whole number from 1 to"),
        ("[render]\nmax_depth = 17", "expected a whole number from 0 to 16"),
        ("[render]\nexposure = 99", "expected a number from -60 to 60"),
        ("[render]\naccel = \"bvh9\"", "Did you mean 'bvh"),
        ("[render]\ntone_map = \"filmc\"", "Did you mean 'filmic'?"),
        ("[render]\nsample = 4", "the unknown key 'sample'; expected one of"),
    ];
    for (text, expected) in cases {
        let folder = tempfile::tempdir().unwrap();
        let error = load_in(folder.path(), &format!("{text}\n")).unwrap_err();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
}
