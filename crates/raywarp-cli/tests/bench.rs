//! `raywarp bench` as a process: which rays are measured, and what is said of them. Never how fast.

use crate::common::{Place, Run, SCENE};
use serde_json::Value;

const KINDS: [&str; 6] = ["primary", "shadow", "ao", "reflected", "diffuse", "random"];

fn place() -> Place {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    place
}

/// `bench` of few rays on the CPU.
fn bench(place: &Place, arguments: &[&str]) -> Run {
    let few = ["bench", "--device=cpu", "--size=64x36", "--min-rays=3000", "--repeats=2", "--warmup=1"];
    place.run(&[&few, arguments].concat())
}

fn json(run: Run) -> Value {
    serde_json::from_str(&run.succeeds().out()).unwrap()
}

fn rows<'a>(results: &'a Value, key: &str) -> &'a Vec<Value> {
    results[key].as_array().unwrap()
}

#[test]
fn every_kind_of_ray_is_measured_with_every_structure_and_tree() {
    let place = place();
    let options = ["scene.toml", "--layout=brute,kd,bvh", "--tree=fast,high", "--counts", "--json", "--name=tiny"];
    let results = json(bench(&place, &options));
    assert_eq!((results["repeats"].as_u64(), results["warmup"].as_u64()), (Some(2), Some(1)));
    assert!(results["device"].as_str().unwrap().starts_with("CPU") && results["version"].is_string());
    let rows = rows(&results, "rows");
    // The structures of the paper have one quality.
    assert_eq!(rows.len(), KINDS.len() * (1 + 1 + 2));
    for (index, row) in rows.iter().enumerate() {
        assert_eq!((&row["scene"], &row["rays"]), (&"tiny".into(), &KINDS[index / 4].into()));
        let expected = [("brute", "medium"), ("kd", "medium"), ("bvh", "fast"), ("bvh", "high")][index % 4];
        assert_eq!((&row["layout"], &row["tree"]), (&expected.0.into(), &expected.1.into()));
        let number = |key: &str| row[key].as_f64().unwrap();
        assert!(number("mrays_per_s_least") <= number("mrays_per_s") && number("mrays_per_s") > 0.0, "{row}");
        assert!(number("mrays_per_s") <= number("mrays_per_s_most") && row["ms"]["median"].as_f64() > Some(0.0));
        assert!(number("triangle_bytes") >= 48.0 && number("differ") == 0.0 && row["kernel"].is_null());
        assert_eq!(row["any_hit"], matches!(KINDS[index / 4], "shadow" | "ao"));
        assert_eq!(row["count"], if index / 4 == 0 { 64 * 36 } else { 3000 });
        assert!(row["cost"]["nodes_per_ray"].is_number() && row["build_seconds"].is_number(), "{row}");
    }
    // Brute force tests the one triangle once a ray.
    assert_eq!(rows[0]["cost"]["triangles_per_ray"], 1.0);
    // A fifth of the picture or so is the triangle; alone in space it shadows nothing and no bounce comes back.
    let share = |index: usize| rows[index]["hit_share"].as_f64().unwrap();
    assert!(
        share(0) > 0.1 && share(0) < 0.4 && share(4) == 0.0 && share(8) == 0.0 && share(12) == 0.0 && share(16) == 0.0
    );
}

#[test]
fn results_are_a_table_too() {
    let run = bench(&place(), &["scene.toml", "--rays", "primary,random", "--threads=1", "--layout=bvh"])
        .says("3000 random rays");
    let table = run.out();
    assert!(table.starts_with("CPU, 1 thread; raywarp ") && table.contains("median of 2 after 1"), "{table}");
    assert!(table.contains("| scene | rays | layout | tree | Mrays/s | hits | nodes | triangles |\n"), "{table}");
    for kind in ["primary", "random"] {
        assert!(table.contains(&format!("| scene | {kind} | bvh | medium | ")), "{table}");
    }
}

#[test]
fn trees_are_timed_by_quality() {
    let place = place();
    let results = json(place.run(&["bench", "--trees", "scene.toml", "--tree=fast,medium", "--repeats=2", "--json"]));
    let rows = rows(&results, "rows");
    for (row, (tree, from_device)) in rows.iter().zip([("fast", true), ("medium", false)]) {
        assert_eq!((&row["tree"], &row["from_device"]), (&tree.into(), &from_device.into()));
        assert_eq!((&row["scene"], &row["triangles"], &row["stats"]["nodes"]), (&"scene".into(), &1.into(), &1.into()));
        assert!(row["mtriangles_per_s"].as_f64() > Some(0.0) && row["first_ms"].as_f64() > Some(0.0), "{row}");
    }
    assert_eq!(rows.len(), 2);
    let table = place.run(&["bench", "--trees", "scene.toml", "--tree=fast"]).succeeds().out();
    assert!(table.contains("| scene | 1 | fast | "), "{table}");
}

#[test]
fn the_built_in_scene_is_there_without_a_file() {
    let results = json(bench(&Place::new(), &["--rays=primary", "--json"]));
    let row = &rows(&results, "rows")[0];
    assert_eq!((&row["scene"], row["triangles"].as_u64() > Some(14_000)), (&"built-in".into(), true));
}

#[test]
fn a_camera_that_sees_nothing_has_primary_and_random_rays_alone() {
    let run = bench(&place(), &["scene.toml", "--eye=0,0,4", "--target=0,0,8", "--json"]);
    let results = json(run.says("note: scene: the camera sees nothing that diffuse rays could start from"));
    let kinds: Vec<_> = rows(&results, "rows").iter().map(|row| row["rays"].as_str().unwrap()).collect();
    assert_eq!((kinds, rows(&results, "notes").len()), (vec!["primary", "random"], 4));
}

#[test]
fn unknown_names_are_refused_with_those_that_there_are() {
    let place = place();
    for (option, sentence) in [
        ("--rays=primary,tertiary", "'tertiary' is no kind of rays; expected primary"),
        ("--layout=octree", "'octree' is no acceleration structure"),
        ("--tree=best", "'best' is no quality of a tree"),
        ("--peers=optix", "invalid value 'optix' for '--peers"),
        ("--repeats=0", "give a whole number from 1 to 1000"),
        ("--min-rays=0", "give a whole number from 1 to 1000000000"),
    ] {
        let run = place.run(&["bench", "scene.toml", option]);
        run.fails(2, sentence);
    }
}

#[test]
fn options_that_do_not_go_together_are_refused() {
    let place = place();
    place.write("empty.toml", "version = 1\n");
    for (arguments, sentence) in [
        (&["scene.toml", "empty.toml", "--name=both"] as &[&str], "are for one scene, and there are 2"),
        (&["scene.toml", "empty.toml", "--fov=30"], "are for one scene"),
        (&["scene.toml", "--frames", "--rays=ao"], "cannot be used with"),
        (&["scene.toml", "--trees", "--rays=ao"], "cannot be used with"),
        (&["scene.toml", "--suite=suite.toml"], "cannot be used with"),
        (&["scene.toml", "--python=python3"], "--peers"),
        (&["empty.toml"], "the scene 'empty' has no triangle"),
        (&["scene.toml", "--eye=1,2,3", "--target=1,2,3"], "stands on its own target"),
        (&["absent.obj"], "absent.obj"),
    ] {
        bench(&place, arguments).fails(2, sentence);
    }
    place.run(&["bench", "--frames", "scene.toml", "scene.toml"]).fails(2, "--frames takes one scene");
}

const SUITE: &str = r#"
[[scenes]]
name = "first"
file = "scene.toml"
eye = [0, 0, 2]
target = [0, 0, 0]
up = [0, 1, 0]
fov = 60

[[scenes]]
name = "second"
file = "absent.ply"
"#;

#[test]
fn a_suite_names_scenes_and_leaves_out_those_that_are_not_there() {
    let place = place();
    place.write("suite.toml", SUITE);
    let run = bench(&place, &["--suite=suite.toml", "--rays=primary", "--json"]);
    let results = json(run.says("note: second: left out, as there is no absent.ply"));
    assert_eq!(rows(&results, "rows")[0]["scene"], "first");
    assert_eq!(rows(&results, "notes")[0]["about"], "second");
    // Its camera is nearer than the scene's own.
    let own = json(bench(&place, &["scene.toml", "--rays=primary", "--json"]));
    let share = |results: &Value| rows(results, "rows")[0]["hit_share"].as_f64().unwrap();
    assert!(share(&results) > share(&own));

    bench(&place, &["--suite=suite.toml", "--only=second"]).fails(2, "nothing was measured");
    bench(&place, &["--suite=suite.toml", "--only=third"]).fails(2, "has no scene 'third'; it has first, second");
    bench(&place, &["--suite=absent.toml"]).fails(2, "cannot read the suite absent.toml");
    place.write("suite.toml", SUITE.replace("fov = 60", "fov = 200"));
    bench(&place, &["--suite=suite.toml"]).fails(2, "the fov of 'first' is 200: give an angle");
    place.write("suite.toml", SUITE.replace("eye", "eyes"));
    bench(&place, &["--suite=suite.toml"]).fails(2, "suite.toml:5:1: the unknown key 'eyes'; expected one of 'name'");
}

#[test]
fn the_suite_of_the_documentation_is_one() {
    let suite = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/bench/suite.toml");
    let run = bench(&Place::new(), &["--suite", suite, "--models=."]).fails(2, "nothing was measured");
    for name in ["theodoric", "sponza", "dragon", "bistro", "country-kitchen"] {
        assert!(run.err().contains(&format!("note: {name}: left out, as there is no ")), "{}", run.err());
    }
}

#[test]
fn peers_that_are_not_there_are_a_note() {
    let options = ["scene.toml", "--rays=primary", "--json", "--peers", "--python=absent/python"];
    let results = json(bench(&place(), &options).says("note: embree: left out: cannot run absent/python"));
    assert_eq!((rows(&results, "rows").len(), rows(&results, "peers").len()), (1, 0));
    let about: Vec<_> = rows(&results, "notes").iter().map(|note| note["about"].as_str().unwrap()).collect();
    assert_eq!(about, ["embree", "warp"]);
    // Beside peers there is one thread, whether they come or not.
    assert_eq!(results["device"], "CPU, 1 thread");
}

/// Speaks as the Python script does. One answers that every ray goes to its limit, the other cannot build.
#[cfg(unix)]
const PUPPET: &str = r#"#!/bin/sh
echo "{\"name\": \"puppet $2\", \"version\": \"1\", \"device\": \"$3\"}"
while read -r order; do
    path=$(echo "$order" | sed 's/.*"\(file\|folder\)":"\([^"]*\)".*/\2/')
    case "$2$order" in
    warp*scene*) echo '{"failed": "no wood"}' ;;
    *scene*)
        test -s "$path/vertices" && test -s "$path/triangles" || exit 1
        echo '{"variants": [{"name": "slow", "build_seconds": 1}, {"name": "quick", "build_seconds": 2}]}' ;;
    *rays*)
        limits=$path/limits
        echo '{"rays": 0}' ;;
    *time*'"variant":0'*) echo '{"seconds": [0.5]}' ;;
    *time*) echo '{"seconds": [0.25]}' ;;
    *answers*)
        cp "$limits" "$path"
        echo '{}' ;;
    esac
done
"#;

#[cfg(unix)]
#[test]
fn a_peer_gets_the_rays_and_its_answers_are_compared() {
    use std::os::unix::fs::PermissionsExt;
    let place = place();
    place.write("python", PUPPET);
    std::fs::set_permissions(place.path("python"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let options = ["scene.toml", "--rays=primary,shadow", "--peers", "--python=./python"];
    let run = bench(&place, &[&options as &[&str], &["--json"]].concat());
    let results = json(run.says("note: puppet warp: it failed, and is left out from here on: no wood"));
    let (ours, peers) = (rows(&results, "rows"), rows(&results, "peers"));
    assert_eq!((ours.len(), peers.len()), (2, 2));
    let row = &peers[0];
    assert_eq!(
        (&row["name"], &row["variant"], &row["device"]),
        (&"puppet embree".into(), &"quick".into(), &"cpu".into())
    );
    assert!((row["mrays_per_s"].as_f64().unwrap() - 64.0 * 36.0 * 1e-6 / 0.25).abs() < 1e-9);
    // Limits of primary rays are infinite: it answers that all of them miss.
    let hits = ours[0]["hit_share"].as_f64().unwrap() * 64.0 * 36.0;
    assert_eq!(row["agreement"]["hit_or_miss"].as_f64(), Some(hits.round()));
    // Those of shadow rays are not: it answers that all hit, and none does.
    assert_eq!(
        (peers[1]["agreement"]["hit_or_miss"].as_u64(), peers[1]["rays"].as_str()),
        (Some(3000), Some("shadow"))
    );

    let table = bench(&place, &options).succeeds().out();
    assert!(table.contains("| scene | primary | puppet embree (1), quick | cpu |"), "{table}");
    assert!(table.ends_with("- puppet warp: it failed, and is left out from here on: no wood\n"), "{table}");
}
