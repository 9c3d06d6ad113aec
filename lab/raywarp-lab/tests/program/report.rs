//! `raywarp-lab study` as a process: that the report is whole, and that what is counted is right. Never how fast.

use crate::place::{Place, Run, SCENE};
use raywarp::accel::{Accel, AccelKind};
use raywarp::query::{opaque_triangles, tests, RaySource};
use raywarp::render::default_camera;
use raywarp::scene::load::{load, LoadOptions};
use raywarp_lab::structures::StructureKind;
use serde_json::Value;

/// The short study of small pictures on the CPU.
fn study(place: &Place, arguments: &[&str]) -> Run {
    place.run(&[&["study", "--quick", "--device=cpu", "--size=48x27", "--repeats=1"], arguments].concat())
}

fn numbers(place: &Place) -> Value {
    serde_json::from_slice(&std::fs::read(place.path("report/study.json")).unwrap()).unwrap()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

const KINDS: [&str; 4] = ["primary", "shadow", "reflected", "diffuse"];

#[test]
fn a_study_does_not_write_over_its_suite() {
    let place = Place::new();
    std::fs::create_dir(place.path("study")).unwrap();
    let suite = "[[scenes]]\nname = \"one\"\nfile = \"model.obj\"\n";
    std::fs::write(place.path("study/report.html"), suite).unwrap();
    study(&place, &["--suite", "study/report.html"]).fails(2, "cannot write study/report.html: it is read");
    assert_eq!(std::fs::read_to_string(place.path("study/report.html")).unwrap(), suite);
}

#[test]
fn the_papers_scene_fills_every_part_of_the_report() {
    let place = Place::new();
    study(&place, &["-o", "report"]).succeeds();
    for name in ["report.html", "report.md", "study.json", "plots"] {
        assert!(place.path("report").join(name).exists(), "{name}");
    }
    let page = std::fs::read_to_string(place.path("report/report.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("data:image/png;base64,") && !page.contains("<script"));
    // What a plot is said to show is there.
    let text = std::fs::read_to_string(place.path("report/report.md")).unwrap();
    let plots = text.split("](plots/").skip(1).filter_map(|rest| rest.split(')').next());
    assert!(plots.map(|name| assert!(place.path("report/plots").join(name).is_file(), "{name}")).count() > 15);

    let study = numbers(&place);
    let scene = &study["scenes"][0];
    assert_eq!((scene["name"].as_str(), scene["triangles"].as_u64()), (Some("built-in"), Some(14_852)));
    let structures = list(&scene["structures"]);
    let kinds: Vec<&str> = structures.iter().filter_map(|row| row["accel"].as_str()).collect();
    for kind in StructureKind::ALL.map(StructureKind::name).iter().filter(|kind| **kind != "bvh2c") {
        assert!(kinds.contains(kind), "{kind} is missing of {kinds:?}");
    }
    for row in structures {
        let rates: Vec<&str> = list(&row["rates"]).iter().filter_map(|rate| rate["rays"].as_str()).collect();
        assert_eq!(rates, KINDS, "{}", row["name"]);
    }
    for (part, least) in [("tests", 36), ("shares", 4), ("loads", 6), ("lanes", 18), ("shapes", 12), ("sharing", 68)] {
        assert!(list(&scene[part]).len() >= least, "{part} has {}", list(&scene[part]).len());
    }
    assert_eq!(list(&scene["paths"]).len(), 6);
    assert_eq!(list(&study["growth"]).len(), 20);

    // Shares are shares.
    let sum = |row: &Value, parts: &[&str]| parts.iter().map(|part| row[part].as_f64().unwrap()).sum::<f64>();
    for row in list(&scene["shares"]) {
        assert!((sum(row, &["generation", "intersection", "shading"]) - 1.0).abs() < 1e-9, "{row}");
    }
    for row in list(&scene["lanes"]) {
        let parts = ["useful", "boxes", "leaves", "finished", "shading"];
        assert!((sum(row, &parts) - 1.0).abs() < 1e-9, "{row}");
    }
    for row in list(&scene["tests"]) {
        for what in ["nodes", "triangles"] {
            let columns = list(&row[what]["histogram"]);
            assert!((columns.iter().map(|bin| bin["share"].as_f64().unwrap()).sum::<f64>() - 1.0).abs() < 1e-9);
        }
    }
    // All schemes follow the same rays.
    let traced: Vec<&Value> = list(&scene["paths"]).iter().map(|row| &row["traced"]).collect();
    assert!(traced[..3].iter().all(|count| *count == traced[0]) && traced[3..].iter().all(|count| *count == traced[3]));
}

/// The report's numbers are those that the same rays give when they are counted one by one.
#[test]
fn what_is_counted_is_exact() {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    study(&place, &["scene.toml", "-o", "report"]).succeeds();
    let study = numbers(&place);
    let scene = load(&place.path("scene.toml"), &LoadOptions::default()).unwrap().scene;
    let triangles = opaque_triangles(&scene).unwrap();
    let camera = default_camera(&scene);
    let rays = RaySource::new(&triangles, &camera, [48, 27]).unwrap().primary().rays;
    for (kind, name) in [(AccelKind::Kd, "k-d tree of the paper"), (AccelKind::Bvh2, "BVH2, medium")] {
        let accel = Accel::build(kind, triangles.clone()).unwrap();
        let each = tests(&accel, &rays, false, usize::MAX);
        let mean = |counts: Vec<u32>| counts.into_iter().map(f64::from).sum::<f64>() / each.len() as f64;
        let rows = list(&study["scenes"][0]["tests"]);
        let row = rows.iter().find(|row| row["structure"] == name && row["rays"] == "primary").unwrap();
        assert_eq!(row["counted"].as_u64(), Some(48 * 27));
        assert_eq!(row["nodes"]["mean"].as_f64(), Some(mean(each.iter().map(|tests| tests.nodes).collect())));
        assert_eq!(row["triangles"]["mean"].as_f64(), Some(mean(each.iter().map(|tests| tests.triangles).collect())));
        assert_eq!(
            row["triangles"]["most"].as_f64(),
            each.iter().map(|tests| f64::from(tests.triangles)).reduce(f64::max)
        );
    }
    // One triangle: brute force tests it once for each camera ray.
    let brute = &list(&study["scenes"][0]["tests"])[0];
    assert_eq!((brute["structure"].as_str(), brute["triangles"]["mean"].as_f64()), (Some("brute force"), Some(1.0)));
}

#[test]
fn what_is_wrong_is_said() {
    let place = Place::new();
    study(&place, &["gone.obj"]).fails(2, "gone.obj");
    place.write("file", "");
    study(&place, &["-o", "file/report"]).fails(2, "cannot make the folder");
    place.write("empty.obj", "v 0 0 0\n");
    study(&place, &["empty.obj"]).fails(2, "has no triangle");
    place.write("suite.toml", "[[scenes]]\nname = \"away\"\nfile = \"away.ply\"\n");
    study(&place, &["--suite", "suite.toml", "-o", "report"]).fails(2, "no scene was studied");
}
