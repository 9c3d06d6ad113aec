use std::path::Path;

use crate::load::{self, LoadError, LoadOptions, Loaded};
use crate::{AlphaMode, LightKind, Projection, Scene};

pub(super) const TRIANGLE: &str = "[[meshes]]\nname = \"t\"\nvertices = [[0,0,0],[1,0,0],[0,1,0]]\nfaces = [[0,1,2]]\n";

pub(super) fn load_in(directory: &Path, text: &str) -> Result<Loaded, LoadError> {
    let path = directory.join("scene.toml");
    std::fs::write(&path, text).unwrap();
    load::load(&path, &LoadOptions::default())
}

pub(super) fn scene(text: &str) -> Scene {
    let directory = tempfile::tempdir().unwrap();
    load_in(directory.path(), text).unwrap().scene
}

pub(super) fn error(text: &str) -> String {
    let directory = tempfile::tempdir().unwrap();
    let error = load_in(directory.path(), text).unwrap_err().to_string();
    error.replace(&directory.path().display().to_string(), "").trim_start_matches('/').to_owned()
}

fn close(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
}

#[test]
fn the_built_in_scene_loads_without_a_warning() {
    let loaded = load::builtin().unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let triangles: usize = loaded.scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    assert_eq!(triangles, 14_842 + 10);
    assert!(loaded.scene.lights.len() == 2 && loaded.scene.cameras.len() == 1);
}

#[test]
fn shipped_scenes_load_without_a_warning() {
    for name in ["built-in/paper", "../../scenes/cornell/cornell", "../../scenes/glass/glass"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name).with_extension("toml");
        let loaded = load::load(&path, &LoadOptions { strict: true }).unwrap();
        assert!(!loaded.scene.instances.is_empty(), "{name}");
    }
}

#[test]
fn a_mesh_without_instances_is_placed_once_and_one_with_them_only_by_them() {
    let once = scene(&format!("version = 1\n{TRIANGLE}"));
    assert_eq!((once.instances.len(), once.meshes[0].triangles.len()), (1, 1));
    let twice = "[[instances]]\nmesh = \"t\"\ntranslate = [1,2,3]\n";
    let scene = scene(&format!("version = 1\n{TRIANGLE}{twice}{twice}"));
    assert_eq!(scene.instances.len(), 2);
    assert_eq!(scene.instances[0].transform.translation, [1.0, 2.0, 3.0]);
}

#[test]
fn places_that_lose_digits_are_a_note() {
    let directory = tempfile::tempdir().unwrap();
    let notes = |place: &str| {
        let text = format!("version = 1\n{TRIANGLE}[[instances]]\nmesh = \"t\"\n{place}\n");
        let loaded = load_in(directory.path(), &text).unwrap();
        loaded.notes.into_iter().map(|note| note.message).collect::<Vec<_>>()
    };
    for place in ["translate = [4500000.123, 0, 0]", "matrix = [[1, 0, 0, 4500000.123], [0, 1, 0, 0], [0, 0, 1, 0]]"] {
        let notes = notes(place);
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].starts_with("places of instances lose up to 1.23e-1 scene units"), "{notes:?}");
    }
    assert!(notes("translate = [4500000.5, 0.1, 0.3]").is_empty());
}

#[test]
fn vertices_that_lose_digits_are_a_note() {
    let directory = tempfile::tempdir().unwrap();
    let far = TRIANGLE.replace("[0,0,0],[1,0,0],[0,1,0]", "[4500000.123,0,0],[4500001,0,0],[4500000,1,0]");
    let loaded = load_in(directory.path(), &format!("version = 1\n{far}")).unwrap();
    assert!(loaded.warnings.is_empty() && loaded.notes.len() == 1, "{:?}", loaded.notes);
    assert!(loaded.notes[0].message.starts_with("positions lose up to 1.23e-1 scene units"), "{:?}", loaded.notes);
    assert!(load_in(directory.path(), &format!("version = 1\n{TRIANGLE}")).unwrap().notes.is_empty());
}

#[test]
fn a_textured_material_on_a_mesh_without_uvs_is_its_plain_colour() {
    let directory = tempfile::tempdir().unwrap();
    image::RgbaImage::new(1, 1).save(directory.path().join("a.png")).unwrap();
    let material = "[[materials]]\nname = \"m\"\ndiffuse = [1, 0, 0]\ndiffuse_map = \"a.png\"\n";
    let instance = "[[instances]]\nmesh = \"t\"\nmaterial = \"m\"\n";
    let loaded = load_in(directory.path(), &format!("version = 1\n{TRIANGLE}{material}{instance}")).unwrap();
    let shown = loaded.scene.instances[0].material.unwrap() as usize;
    assert_eq!(
        (loaded.scene.materials[shown].diffuse, loaded.scene.materials[shown].diffuse_map),
        ([1.0, 0.0, 0.0], None)
    );
    assert_eq!(
        loaded.warnings[0].message,
        "the mesh 't' has no coordinates for the textures of the material 'm', which shows its plain colour there"
    );
}

#[test]
fn polygons_are_cut_into_triangles() {
    let text = "version = 1\n[[meshes]]\nvertices = [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]\nfaces = [[0,1,2,3]]\n";
    assert_eq!(scene(text).meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn instances_are_scaled_then_turned_then_moved() {
    let place = |keys: &str| {
        let text = format!("version = 1\n{TRIANGLE}[[instances]]\nmesh = \"t\"\n{keys}\n");
        scene(&text).instances[0].transform.point([1.0, 0.0, 0.0])
    };
    let about = "scale = 2\nrotate = { axis = [0, 0, 3], degrees = 90 }\ntranslate = [0, 0, 5]";
    assert!(close(place(about), [0.0, 2.0, 5.0]));
    assert!(close(place("rotate = [0, 90, 90]"), [0.0, 0.0, -1.0]));
    assert!(close(place("rotate = [0, 0, -90]\nscale = [3, 1, 1]"), [0.0, -3.0, 0.0]));
    assert!(close(place("matrix = [[0, -1, 0, 4], [1, 0, 0, 5], [0, 0, 1, 6]]"), [4.0, 6.0, 6.0]));
}

#[test]
fn z_up_is_turned_to_y_up() {
    let camera = "[[cameras]]\neye = [0, -5, 1]\ntarget = [0, 0, 1]\n";
    let light = "[[lights]]\nkind = \"directional\"\ndirection = [0, 0, -1]\n";
    let scene = scene(&format!("version = 1\nup = \"+Z\"\n{TRIANGLE}{camera}{light}"));
    assert!(close(scene.instances[0].transform.point([0.0, 0.0, 7.0]), [0.0, 7.0, 0.0]));
    assert!(close(scene.cameras[0].eye, [0.0, 1.0, 5.0]) && close(scene.cameras[0].up, [0.0, 1.0, 0.0]));
    let LightKind::Directional { direction } = scene.lights[0].kind else { panic!() };
    assert!(close(direction, [0.0, -1.0, 0.0]));
}

#[test]
fn materials_have_the_stated_defaults() {
    let text = "version = 1\n[[materials]]\nname = \"m\"\ndiffuse = \"#ff0080\"\nreflection = 0.5\nopacity = 0.25\n";
    let material = scene(text).materials.remove(0);
    assert!(material.diffuse[0] == 1.0 && material.diffuse[1] == 0.0 && material.ambient == material.diffuse);
    assert!((material.diffuse[2] - 0.215_86).abs() < 1e-4);
    assert_eq!((material.reflection, material.alpha), ([0.5; 3], AlphaMode::Blend));
}

#[test]
fn lights_and_cameras_are_in_radians() {
    let spot = "[[lights]]\nkind = \"spot\"\nposition = [0,1,0]\ntarget = [0,0,0]\nintensity = 3\nouter = 90\n";
    let camera = "[[cameras]]\neye = [0,0,1]\ntarget = [0,0,0]\nfov = 90\n";
    let scene = scene(&format!("version = 1\n{spot}{camera}"));
    assert_eq!(scene.lights[0].color, [3.0; 3]);
    let LightKind::Spot { direction, outer, inner, .. } = scene.lights[0].kind else { panic!() };
    assert!(close(direction, [0.0, -1.0, 0.0]) && (outer - 90f32.to_radians()).abs() < 1e-6 && inner < outer);
    assert_eq!(scene.cameras[0].projection, Projection::Perspective { fov_y: 90f32.to_radians() });
}

#[test]
fn scene_files_bring_their_lights_cameras_and_materials() {
    let directory = tempfile::tempdir().unwrap();
    let lamp = "[[lights]]\nkind = \"point\"\nposition = [0,1,0]\n[[cameras]]\neye = [0,0,1]\ntarget = [0,0,0]\n";
    let inner = format!("version = 1\n{TRIANGLE}material = \"red\"\n[[materials]]\nname = \"red\"\n{lamp}");
    std::fs::write(directory.path().join("lamp.toml"), inner).unwrap();
    let outer = "version = 1\n[[materials]]\nname = \"own\"\n[[meshes]]\nname = \"l\"\nfile = \"lamp.toml\"\n\
                 [[instances]]\nmesh = \"l\"\n[[instances]]\nmesh = \"l\"\ntranslate = [5,0,0]\nmaterial = \"red\"\n";
    let scene = load_in(directory.path(), outer).unwrap().scene;
    assert_eq!((scene.instances.len(), scene.lights.len(), scene.cameras.len()), (2, 2, 1));
    assert_eq!(scene.lights[1].kind, LightKind::Point { position: [5.0, 1.0, 0.0] });
    let red = scene.materials.iter().position(|material| material.name == "red").unwrap() as u32;
    assert_eq!((scene.meshes[0].materials[0], scene.instances[1].material), (red, Some(red)));
}

#[test]
fn files_that_name_themselves_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("b.toml"), "version = 1\n[[meshes]]\nfile = \"scene.toml\"\n").unwrap();
    for file in ["b.toml", "scene.toml", "./scene.toml"] {
        let error = load_in(directory.path(), &format!("version = 1\n[[meshes]]\nfile = \"{file}\"\n")).unwrap_err();
        assert!(error.to_string().contains("names itself"), "{error}");
    }
}

#[test]
fn few_lines_cannot_name_endlessly_much() {
    let directory = tempfile::tempdir().unwrap();
    let path = |index: usize| directory.path().join(format!("{index}.toml"));
    std::fs::write(path(0), format!("version = 1\n{TRIANGLE}")).unwrap();
    for index in 1..40 {
        let below = format!("[[meshes]]\nname = \"m\"\nfile = \"{}.toml\"\n", index - 1);
        let instances = "[[instances]]\nmesh = \"m\"\n".repeat(30);
        std::fs::write(path(index), format!("version = 1\n{below}{instances}")).unwrap();
    }
    let error = |index| load::load(&path(index), &LoadOptions::default()).unwrap_err().to_string();
    assert!(error(6).contains("more than 1000000"), "{}", error(6));
    assert!(error(39).contains("name each other"), "{}", error(39));
    let often = "[[meshes]]\nfile = \"0.toml\"\n".repeat(65);
    let error = load_in(directory.path(), &format!("version = 1\n{often}")).unwrap_err().to_string();
    assert!(error.contains("read more than 64 times"), "{error}");
}

#[test]
fn errors_say_where_what_and_what_instead() {
    let cases = [
        ("", "scene.toml:1:1: the key 'version' is missing"),
        ("version = 2", "scene.toml:1:11: version 2; expected version = 1."),
        ("version = 1\n[[meshs]]\n", "Did you mean 'meshes'?"),
        ("version = 1\n[[meshes]]\nfiel = 3\n", "scene.toml:3:1: the unknown key 'fiel'"),
        ("version = 1\nambient = nan\n", "scene.toml:2:11: the number NaN;"),
        ("version = 1\nambient = [1, 2]\n", "scene.toml:2:11: an array of 2; expected a colour"),
        ("version = 1\nambient = -1\n", "expected a number from 0 to 1e12"),
        ("version = 1\nambient = 1e300\n", "expected a number from 0 to 1e12"),
        ("version = 1\nambient = \"#12345\"\n", "expected a colour"),
        ("version = 1\n[[meshes]]\n", "scene.toml:2:1: a mesh without geometry"),
        ("version = 1\n[[lights]]\nkind = \"sopt\"\n", "Did you mean 'spot'?"),
        ("version = 1\n[[lights]]\nkind = \"point\"\n", "a point light without position"),
        ("version = 1\n[[cameras]]\neye = [0,0,0]\ntarget = [0,0,0]\n", "looks at its own place"),
        ("version = 1\n[[materials]]\nname = \"a\"\nreflection = 2\n", "expected a number from 0 to 1"),
        ("version = 1\n[[materials]]\nname = \"a\"\n[[materials]]\nname = \"a\"\n", "a second material 'a'"),
        ("version = 1\nx = [[[", "scene.toml:2:"),
    ];
    for (text, expected) in cases {
        let error = error(text);
        assert!(error.contains(expected), "{text:?}: {error}");
    }
}

#[test]
fn errors_in_meshes_and_instances_say_where() {
    let cases = [
        ("[[instances]]\nmesh = \"T\"\n", "scene.toml:7:8: there is no mesh 'T'; expected one of t. Did you mean 't'?"),
        ("[[instances]]\nmesh = \"t\"\nscale = 0\n", "none of them 0"),
        ("[[instances]]\nmesh = \"t\"\nmaterial = \"x\"\n", "there is no material 'x'"),
        ("[[instances]]\nmesh = \"t\"\nmatrix = [[1,0,0,0]]\n", "a matrix of 1 rows; expected 3 or 4 rows"),
        ("[[instances]]\nmesh = \"t\"\nscale = 1\nmatrix = []\n", "a matrix beside"),
        ("[[instances]]\nmesh = \"t\"\nmatrix = [[0,0,0,0],[0,0,0,0],[0,0,0,0]]\n", "flattens space"),
        ("[[instances]]\nmesh = \"t\"\nrotate = { axis = [0,0,0], degrees = 1 }\n", "without length"),
        ("[[meshes]]\nvertices = [[0,0,0]]\nfaces = [[0,1,2]]\n", "the vertex index 1; expected one from 0 to 0"),
        ("[[meshes]]\nvertices = [[0,0,0]]\nfaces = [[0,0]]\n", "a face of 2 vertices; expected at least 3"),
        ("[[meshes]]\nvertices = [[0,0,inf]]\nfaces = [[0,0,0]]\n", "expected a number between"),
        ("[[meshes]]\nfile = \"none.obj\"\n", "scene.toml:7:8 names none.obj: cannot read /none.obj: No such file"),
        ("[[meshes]]\nfile = \"none.xyz\"\n", "scene.toml:7:8 names none.xyz: /none.xyz: the scene format '.xyz'"),
        ("[[meshes]]\nname = \"t\"\nfile = \"none.obj\"\n", "a second mesh 't'"),
    ];
    for (text, expected) in cases {
        let error = error(&format!("version = 1\n{TRIANGLE}{text}"));
        assert!(error.contains(expected), "{text:?}: {error}");
    }
}

#[test]
fn no_message_speaks_of_the_program() {
    let wrong = ["3", "1.5", "true", "\"x\"", "[]", "[[1]]", "{}", "{ a = 1 }", "1979-05-27", "-7", "99999999999"];
    let keys = [
        "version",
        "base",
        "up",
        "background",
        "environment",
        "ambient",
        "meshes",
        "instances",
        "moves",
        "materials",
        "lights",
        "cameras",
        "paths",
        "render",
    ];
    let within = [
        ("meshes", "name file vertices faces uvs normals material lights cameras"),
        ("instances", "mesh name translate rotate scale matrix material"),
        ("moves", "instance translate rotate scale matrix"),
        (
            "materials",
            "name replaces diffuse shininess reflection ior fresnel opacity alpha unlit diffuse_map normal_map base_color metallic thin_walled roughness_map",
        ),
        ("lights", "name kind position color intensity attenuation range inner"),
        ("cameras", "name eye target fov height"),
        ("paths", "name closed duration keys"),
        ("render", "size samples spp integrator max_depth shadows seed exposure tone_map accel tree"),
    ];
    let top = keys.iter().map(|key| format!("{key} = "));
    let inner = within.iter().flat_map(|(table, keys)| {
        let head = if *table == "render" { "[render]".to_owned() } else { format!("[[{table}]]") };
        keys.split(' ').map(move |key| format!("{head}\n{key} = ")).collect::<Vec<_>>()
    });
    let directory = tempfile::tempdir().unwrap();
    for start in top.chain(inner) {
        for value in wrong {
            let version = if start.starts_with("version") { "" } else { "version = 1\n" };
            let Err(error) = load_in(directory.path(), &format!("{version}{start}{value}\n")) else { continue };
            let said = error.to_string();
            let words = [
                "struct",
                "i64",
                "u32",
                "f32",
                "invalid type",
                "invalid value",
                "sequence",
                "`",
                "variant",
                "field",
                "enum",
                "map,",
                "tuple",
            ];
            // Whole words: a camera has a field of view.
            let said = said.replace("field of view", "");
            assert!(!words.iter().any(|word| said.contains(word)), "{start}{value}: {said}");
        }
    }
}

#[test]
fn a_mesh_with_a_name_gives_it_to_its_instance() {
    let directory = tempfile::tempdir().unwrap();
    let triangle = |name: &str| format!("o {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
    std::fs::write(directory.path().join("one.obj"), triangle("a")).unwrap();
    std::fs::write(directory.path().join("two.obj"), triangle("a") + &triangle("b")).unwrap();
    let mesh = |name: &str, file: &str| format!("[[meshes]]\nname = \"{name}\"\nfile = \"{file}\"\n");
    let text = format!(
        "version = 1\n{}{}[[meshes]]\nfile = \"one.obj\"\n{}[[instances]]\nmesh = \"chair\"\nname = \"mine\"\n\
         [[instances]]\nmesh = \"chair\"\n",
        mesh("floor", "one.obj"),
        mesh("house", "two.obj"),
        mesh("chair", "one.obj"),
    );
    let scene = load_in(directory.path(), &text).unwrap().scene;
    let names: Vec<_> = scene.instances.iter().map(|instance| instance.name.as_str()).collect();
    assert_eq!(names, ["mine", "chair", "floor", "a", "b", "a"]);
}

#[test]
fn garbage_is_an_error_and_no_panic() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("scene.toml");
    let nested = "[".repeat(100_000);
    for bytes in [b"\xff\xfe\x00".as_slice(), b"\0\0\0", nested.as_bytes(), format!("a={nested}").as_bytes()] {
        std::fs::write(&path, bytes).unwrap();
        assert!(load::load(&path, &LoadOptions::default()).is_err());
    }
}
