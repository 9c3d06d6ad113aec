//! `raywarp bench --live` as a process: what is measured, and what is said of it. Never how fast.

use crate::common::{Place, Run, SCENE};
use serde_json::Value;

fn place() -> Place {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    place
}

/// For a tenth of a second a row on the CPU.
fn live(place: &Place, arguments: &[&str]) -> Run {
    place.run(&[&["bench", "--live", "--device=cpu", "--seconds=0.1", "--warmup=1"], arguments].concat())
}

fn json(run: Run) -> Value {
    serde_json::from_str(&run.succeeds().out()).unwrap()
}

fn rows(results: &Value) -> &Vec<Value> {
    results["rows"].as_array().unwrap()
}

#[test]
fn every_size_has_both_cases_and_every_row_is_complete() {
    let results = json(live(&place(), &["scene.toml", "--size=64x48,33x20", "--json", "--threads=1"]));
    assert_eq!((&results["device"], results["version"].is_string()), (&"CPU, 1 thread".into(), true));
    assert!(results["command"].as_str().unwrap().starts_with("raywarp bench --live --device=cpu"), "{results}");
    assert_eq!((&results["seconds"], &results["warmup"], &results["aim"]), (&0.1.into(), &1.into(), &60.0.into()));
    assert_eq!((&results["max_depth"], &results["shadows"]), (&5.into(), &true.into()));
    assert!((1..=100).contains(&results["jpeg_quality"].as_u64().unwrap()));
    let of = |row: &Value| (row["size"].clone(), row["case"].as_str().unwrap().to_owned());
    let expected = [([64, 48], "full"), ([64, 48], "held"), ([33, 20], "full"), ([33, 20], "held")];
    let expected: Vec<_> = expected.iter().map(|(size, case)| (serde_json::json!(size), (*case).to_owned())).collect();
    assert_eq!(rows(&results).iter().map(of).collect::<Vec<_>>(), expected);
    for row in rows(&results) {
        assert_eq!((&row["scene"], &row["triangles"], &row["tree"]), (&"scene".into(), &1.into(), &"medium".into()));
        is_complete(row);
    }
}

fn is_complete(row: &Value) {
    let number =
        |pointer: &str| row.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}: {row}"));
    let (frames, seconds) = (number("/frames"), number("/seconds"));
    assert!(frames >= 3.0 && seconds >= 0.1 && (number("/frames_per_s") * seconds - frames).abs() < 1e-6, "{row}");
    for spread in ["/ms", "/jpeg/ms", "/png/ms"] {
        let [least, median, most] = ["least", "median", "most"].map(|name| number(&format!("{spread}/{name}")));
        assert!(0.0 < least && least <= median && median <= most, "{row}");
    }
    assert!(number("/ms/median") <= number("/ms_95") && number("/ms_95") <= number("/ms/most"), "{row}");
    assert!((0.0..=1.0).contains(&number("/late")), "{row}");
    assert!(0.0 < number("/traced_least") && number("/traced_least") <= number("/traced") && number("/traced") <= 1.0);
    // As fast as they come all pixels are traced; else pictures come no sooner than they are due.
    match row["case"].as_str() {
        Some("full") => assert_eq!(number("/traced_least"), 1.0),
        _ => assert!(frames - 1.0 <= 60.0 * seconds, "{row}"),
    }
    // The parts are the frame and what follows it.
    let parts = ["trace", "fetch", "other", "encode"];
    let sum = |what: &str| parts.iter().map(|part| number(&format!("/parts/{part}/{what}"))).sum::<f64>();
    assert!((sum("share") - 1.0).abs() < 1e-9 && number("/parts/trace/ms") > 0.0 && number("/parts/fetch/ms") > 0.0);
    let frame = sum("ms") - number("/parts/encode/ms");
    assert!(number("/ms/least") <= frame * 1.001 && frame <= number("/ms/most") * 1.1, "{row}");
    assert!((number("/parts/encode/ms") - number("/jpeg/ms_mean")).abs() < 1e-9, "{row}");
    assert!(number("/jpeg/pictures") >= 1.0 && number("/jpeg/bytes") > 0.0 && number("/png/bytes") > 0.0, "{row}");
}

#[test]
fn structures_and_trees_are_those_of_the_options() {
    let options = ["scene.toml", "--size=8x8", "--json", "--accel=kd,bvh2", "--tree=fast,high"];
    let results = json(live(&place(), &options));
    let names = |row: &Value| format!("{}, {}", row["layout"].as_str().unwrap(), row["tree"].as_str().unwrap());
    let names: Vec<_> = rows(&results).iter().step_by(2).map(names).collect();
    assert_eq!(names, ["kd, medium", "bvh2, fast", "bvh2, high"]);
}

#[test]
fn results_are_two_tables_too() {
    let run = live(&Place::new(), &["--size=32x24"]).says("built-in: 32x24, held, ");
    let table = run.out();
    assert!(table.starts_with("CPU, ") && table.contains("one sample a pixel, 5 bounces, with shadows; 0.1 s a row"));
    for case in ["full", "held"] {
        let rows: Vec<_> = table.lines().filter(|line| line.contains(&format!("| 32x24 | {case} | "))).collect();
        assert_eq!(rows.len(), 2, "{table}");
        assert!(rows.iter().all(|row| row.starts_with("| built-in | 14852 | ")), "{table}");
    }
}

#[test]
fn suites_and_cameras_are_as_for_rays() {
    let place = place();
    place.write(
        "suite.toml",
        "[[scenes]]\nname = \"first\"\nfile = \"scene.toml\"\nfov = 60\n[[scenes]]\nname = \"second\"\nfile = \"absent.ply\"\n",
    );
    let run = live(&place, &["--suite=suite.toml", "--size=8x8", "--json"]);
    let results = json(run.says("note: second: left out, as there is no absent.ply"));
    assert_eq!((&rows(&results)[0]["scene"], &results["notes"][0]["about"]), (&"first".into(), &"second".into()));
    live(&place, &["--suite=suite.toml", "--only=second"]).fails(2, "nothing was measured");
    live(&place, &["scene.toml", "--size=8x8", "--eye=0,0,9", "--name=far"]).says("far: 8x8, full, ");
    live(&place, &["scene.toml", "--size=8x8", "--eye=1,2,3", "--target=1,2,3"]).fails(2, "stands on its own target");
}

#[test]
fn what_cannot_be_measured_is_refused_with_a_sentence() {
    let place = place();
    place.write("empty.toml", "version = 1\n");
    place.write("broken.toml", "garbage [");
    std::fs::create_dir(place.path("folder.obj")).unwrap();
    for (arguments, sentence) in [
        (&["--frames"] as &[&str], "cannot be used with"),
        (&["--repeats=3"], "cannot be used with"),
        (&["--rays=ao"], "cannot be used with"),
        (&["--counts"], "cannot be used with"),
        (&["--peers"], "cannot be used with"),
        (&["--size=8x8,9"], "give width and height in pixels"),
        (&["scene.toml", "--size=20000x10"], "at most 16384x10 of it"),
        (&["scene.toml", "--size=10x4000"], "too narrow to drag the camera around"),
        (&["empty.toml", "--size=8x8"], "the scene 'empty' has no triangle"),
        (&["broken.toml"], "broken.toml:1"),
        (&["folder.obj"], "folder.obj"),
        (&["absent.obj"], "absent.obj"),
        (&["scene.toml", "empty.toml", "--name=both"], "are for one scene, and there are 2"),
    ] {
        live(&place, arguments).fails(2, sentence);
    }
    for seconds in ["0", "nan", "-1", "1e9", "x"] {
        place.run(&["bench", "--live", &format!("--seconds={seconds}")]).fails(2, "from 0.01 to 3600");
    }
    place.run(&["bench", "--seconds=1"]).fails(2, "--live");
    for mode in [&["bench"] as &[&str], &["bench", "--frames"]] {
        place.run(&[mode, &["--size=8x8,9x9", "--device=cpu"]].concat()).fails(2, "only --live takes several sizes");
    }
}

#[cfg(unix)]
#[test]
fn it_ends_when_it_is_interrupted() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};
    let place = place();
    let options = ["bench", "--live", "scene.toml", "--device=cpu", "--size=8x8", "--seconds=3600"];
    let mut child = place.command(&options).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.map_while(Result::ok).any(|line| line.contains("8x8, full")));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let mut out = String::new();
    child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
    assert_eq!((child.wait().unwrap().code(), out.as_str()), (Some(130), ""));
}
