//! `raywarp-lab bench` as a process: every structure by its name, and the same answers from each. Never how fast.

use crate::place::{Place, SCENE};
use raywarp_lab::structures::StructureKind;
use serde_json::Value;

#[test]
fn every_structure_answers_alike() {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    let names = StructureKind::ALL.map(StructureKind::name).join(",");
    let words =
        ["bench", "scene.toml", "--device=cpu", "--size=32x18", "--min-rays=1", "--repeats=1", "--counts", "--json"];
    let run = place.run(&[&words[..], &["--layout", &names, "--rays=primary,random"]].concat()).succeeds();
    let results: Value = serde_json::from_str(&run.out()).unwrap();
    let rows = results["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * StructureKind::ALL.len());
    for (row, kind) in rows.iter().zip(StructureKind::ALL.into_iter().cycle()) {
        assert_eq!((row["layout"].as_str(), row["differ"].as_u64()), (Some(kind.name()), Some(0)));
        assert!(row["cost"]["triangles_per_ray"].as_f64().is_some());
    }
}

#[test]
fn whole_pictures_are_timed_by_structures_of_the_laboratory() {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    let words =
        ["bench", "--frames", "scene.toml", "--device=cpu", "--size=16x9", "--repeats=1", "--layout=kdsah,bvh8"];
    let table = place.run(&words).succeeds().out();
    assert!(table.contains("| kdsah | primary |") && table.contains("| bvh8 | all |"), "{table}");
    place.run(&["bench", "--layout=octree"]).fails(2, "'octree' is no acceleration structure; expected brute, staged");
}
