//! What the program does when all is well: pictures are what was asked for.

use std::io::Read;
use std::path::Path;
use std::process::Stdio;

use crate::common::{png, Place, SCENE};

fn place() -> Place {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    place
}

/// Channel names of an EXR, and the samples of one of them as numbers.
fn exr_channel(path: &Path, wanted: &str) -> (Vec<String>, Vec<f64>) {
    use exr::prelude::*;
    let image = read_first_flat_layer_from_file(path).unwrap();
    let channels = image.layer_data.channel_data.list;
    let names = channels.iter().map(|channel| channel.name.to_string()).collect();
    let found = channels.iter().find(|channel| channel.name.eq(wanted)).unwrap();
    let samples = match &found.sample_data {
        FlatSamples::F32(samples) => samples.iter().map(|&sample| f64::from(sample)).collect(),
        FlatSamples::U32(samples) => samples.iter().map(|&sample| f64::from(sample)).collect(),
        FlatSamples::F16(samples) => samples.iter().map(|sample| sample.to_f64()).collect(),
    };
    (names, samples)
}

#[test]
fn a_picture_has_its_size_its_background_and_its_triangle() {
    let place = place();
    let run = place.render(&["scene.toml", "-o", "a.png", "--size", "40x30"]).says("a.png: 40x30 pixels on CPU");
    assert!(run.out().is_empty());
    let (width, height, pixels) = png(&place.path("a.png"));
    assert_eq!((width, height), (40, 30));
    // Linear 0.25, 0.5, 0.125 and 0.5, 0, 0 in sRGB.
    assert_eq!((pixels[0], pixels[15 * 40 + 20]), ([137, 188, 99], [188, 0, 0]));
    assert_eq!(place.names(), ["a.png", "scene.toml"]);
}

#[test]
fn the_order_of_options_does_not_matter() {
    let place = place();
    place.render(&["scene.toml", "--size", "16x16", "--spp", "3", "-o", "a.png"]).succeeds();
    place.run(&["render", "-o", "b.png", "--spp=3", "--device=cpu", "--size=16x16", "scene.toml"]).succeeds();
    assert_eq!(png(&place.path("a.png")), png(&place.path("b.png")));
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    let place = place();
    let common = ["scene.toml", "--size", "32x24", "--spp", "4"];
    place.render(&[&common as &[&str], &["-o", "all.png"]].concat()).succeeds();
    place.render(&[&common as &[&str], &["-o", "part.png", "--crop", "8,6,24,18"]].concat()).succeeds();
    let ((_, _, all), (width, height, part)) = (png(&place.path("all.png")), png(&place.path("part.png")));
    assert_eq!((width, height), (16, 12));
    for (row, pixels) in part.chunks(16).enumerate() {
        let start = (row + 6) * 32 + 8;
        assert_eq!(pixels, &all[start..start + 16]);
    }
}

#[test]
fn cameras_are_chosen_by_name_and_by_number() {
    let place = place();
    for (camera, sees) in [("near", true), ("away", false), ("0", true), ("1", false)] {
        place.render(&["scene.toml", "--size", "9x9", "--camera", camera]).succeeds();
        let (_, _, pixels) = png(&place.path("raywarp.png"));
        assert_eq!(pixels[40] == [188, 0, 0], sees, "{camera}");
    }
    place.render(&["scene.toml", "--size", "9x9", "--camera", "away", "--target", "0,0,-1"]).succeeds();
    assert_eq!(png(&place.path("raywarp.png")).2[40], [188, 0, 0]);
}

#[test]
fn exposure_doubles_what_png_shows_and_leaves_exr_alone() {
    let place = place();
    let common = ["scene.toml", "--size", "4x4", "--camera", "away"];
    let stop = ["--exposure", "-1", "-o", "b.png", "-o", "b.exr"];
    place.render(&[&common as &[&str], &["-o", "a.png", "-o", "a.exr"]].concat()).succeeds();
    place.render(&[&common as &[&str], &stop].concat()).succeeds();
    // Linear 0.125, 0.25, 0.0625.
    assert_eq!((png(&place.path("a.png")).2[0], png(&place.path("b.png")).2[0]), ([137, 188, 99], [99, 137, 71]));
    for name in ["a.exr", "b.exr"] {
        assert_eq!(exr_channel(&place.path(name), "G").1, [0.5; 16]);
    }
}

#[test]
fn layers_are_channels_of_an_exr_and_pictures_beside_a_png() {
    let place = place();
    let all = "depth,normal,albedo,uv,position,primitive,material,tests";
    place.render(&["scene.toml", "--size", "9x9", "-o", "a.exr", "-o", "b.png", "--aov", all]).says("white is");
    let (names, depth) = exr_channel(&place.path("a.exr"), "depth.Z");
    for name in ["R", "A", "normal.X", "albedo.G", "uv.U", "position.Y", "primitive.ID", "material.ID", "tests.nodes"] {
        assert!(names.iter().any(|known| known == name), "{name} is not in {names:?}");
    }
    assert!((depth[40] - 4.0).abs() < 1e-5 && depth[0].is_infinite());
    let (_, ids) = exr_channel(&place.path("a.exr"), "primitive.ID");
    assert_eq!((ids[40], ids[0]), (0.0, f64::from(u32::MAX)));
    assert_eq!(exr_channel(&place.path("a.exr"), "A").1[40], 1.0);
    for layer in all.split(',') {
        assert_eq!(png(&place.path(&format!("b.{layer}.png"))).0, 9, "{layer}");
    }
}

#[test]
fn a_heat_map_comes_with_its_scale() {
    let place = place();
    let run = place.render(&["scene.toml", "--size", "64x64", "--heatmap", "h.png", "--heatmap-max", "50"]);
    run.says("the brightest is 50; mean ");
    let (width, height, _) = png(&place.path("h.png"));
    assert!(width == 64 && height > 64);
}

#[test]
fn every_structure_and_thread_count_gives_the_same_picture() {
    let place = Place::new();
    let render = |name: &str, arguments: &[&str]| {
        place.render(&[&["--size", "24x14", "-o", name], arguments].concat()).succeeds();
        png(&place.path(name))
    };
    let picture = render("a.png", &[]);
    for accel in ["brute", "kd", "bvh"] {
        assert_eq!(render("b.png", &["--accel", accel, "--threads", "1"]), picture, "{accel}");
    }
}

#[test]
fn statistics_are_a_table_or_json() {
    let place = place();
    place.render(&["scene.toml", "--size", "8x8", "--stats"]).says("tests a ray");
    let words = ["scene.toml", "--size", "8x8", "--stats=json", "--quiet", "--accel=bvh2"];
    let run = place.render(&words).succeeds();
    assert!(run.err().is_empty(), "{}", run.err());
    let json: serde_json::Value = serde_json::from_str(&run.out()).unwrap();
    assert_eq!((json["size"][0].as_u64(), json["scene"]["triangles"].as_u64()), (Some(8), Some(1)));
    assert!(json["tests"]["rays"].as_u64() >= Some(64) && json["seconds"]["kernel"].as_f64() > Some(0.0));
    assert_eq!(json["accel"], "bvh2");
}

#[test]
fn standard_output_takes_a_png_and_nothing_else() {
    let place = place();
    let run = place.render(&["scene.toml", "--size", "8x8", "-o", "-"]).says("standard output: 8x8");
    assert!(run.0.stdout.starts_with(b"\x89PNG") && run.0.stdout.ends_with(b"IEND\xaeB`\x82"));
    assert_eq!(place.names(), ["scene.toml"]);
}

#[test]
fn a_reader_that_goes_is_no_failure() {
    let place = place();
    let long = ["render", "--device", "cpu", "scene.toml", "--size", "900x900", "-o", "-", "--aov="];
    for arguments in [&long[..8], &["completions", "bash"], &["info"]] {
        let mut child = place.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{arguments:?}: {said}");
        assert!(!said.contains("error"), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_130_and_leaves_no_picture() {
    let place = Place::new();
    let arguments = ["render", "--device", "cpu", "--spp", "20000", "-o", "a.png", "-o", "b.exr"];
    let mut child = place.command(&arguments).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(700));
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(place.names().is_empty(), "{:?}", place.names());
}

#[test]
fn info_says_what_is_in_a_scene() {
    let place = place();
    let text = place.run(&["info", "scene.toml"]).succeeds().out();
    for part in ["triangles       1 (0 dropped)", "2: 'near', 'away'", "red", "tree kd", "tree bvh"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let json: serde_json::Value = serde_json::from_str(&place.run(&["info", "--json"]).succeeds().out()).unwrap();
    assert_eq!(json["scene"]["triangles"], 14_852);
    assert_eq!(json["trees"].as_array().map(Vec::len), Some(3));
}

#[test]
fn the_doctor_says_what_there_is_and_ends_by_it() {
    let run = Place::new().run(&["doctor"]);
    assert!(run.out().contains("kernels ") && run.out().contains("CPU"), "{}", run.out());
    match run.code() {
        0 => assert!(run.out().contains("All is well")),
        3 => assert!(run.out().contains("the CPU works") && run.err().starts_with("error: ")),
        code => panic!("{code}"),
    }
}

#[test]
fn quiet_says_nothing() {
    let run = place().render(&["scene.toml", "--size", "8x8", "-q"]).succeeds();
    assert!(run.out().is_empty() && run.err().is_empty());
}

#[test]
fn bench_of_frames_times_every_structure_and_counts_its_rays() {
    let place = place();
    let options = ["bench", "--frames", "scene.toml", "--device", "cpu", "--size", "16x12", "--repeats", "1", "--json"];
    let run = place.run(&options).succeeds();
    let bench: serde_json::Value = serde_json::from_str(&run.out()).unwrap();
    assert_eq!(bench["size"], serde_json::json!([16, 12]));
    let rows = bench["rows"].as_array().unwrap();
    let names: Vec<_> = rows.iter().map(|row| format!("{} {}", row["accel"], row["rays"])).collect();
    assert_eq!(names.len(), 6, "{names:?}");
    assert_eq!(names[5], r#""bvh8f" "all""#);
    // Camera rays alone: one a pixel, for every structure.
    assert!(rows.iter().filter(|row| row["rays"] == "primary").all(|row| row["tests"]["rays"] == 16 * 12));
    assert!(rows.iter().all(|row| row["kernel_ms"]["median"].as_f64().unwrap() > 0.0));
    let table =
        place.run(&["bench", "scene.toml", "--frames", "--device=cpu", "--size=8x8", "--repeats=1", "--accel=bvh"]);
    let table = table.out();
    assert_eq!(table.lines().filter(|line| line.starts_with("| bvh |")).count(), 2, "{table}");
}

/// A unit square that faces +Z, without a camera or a light.
const SQUARE: &str = "v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\nf 1 2 3 4\n";

/// Columns and rows that something covers, of a picture with transparent pixels.
fn covered(path: &Path) -> [u32; 4] {
    let image = image::open(path).unwrap().to_rgba8();
    let there = image.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[3] > 0);
    there.fold([u32::MAX, 0, u32::MAX, 0], |[left, right, top, bottom], (x, y, _)| {
        [left.min(x), right.max(x), top.min(y), bottom.max(y)]
    })
}

#[test]
fn what_is_framed_takes_four_fifths_of_a_side() {
    let place = place();
    place.write("a.obj", SQUARE);
    let framed = |more: &[&str], size: &str| {
        let common = ["a.obj", "--background", "none", "--samples", "64", "--size", size];
        place.render(&[&common as &[&str], more].concat()).succeeds();
        covered(&place.path("raywarp.png"))
    };
    assert_eq!(framed(&["--view", "front"], "200x100"), [60, 139, 10, 89]);
    assert_eq!(framed(&["--view", "back"], "100x200"), [10, 89, 60, 139]);
    assert_eq!(framed(&["--view", "top", "--up", "+Z"], "200x100"), [60, 139, 10, 89]);
    assert_eq!(framed(&["--azimuth", "0", "--elevation", "0", "--zoom", "0.5"], "200x100"), [80, 119, 30, 69]);
    let [left, right, top, bottom] = framed(&[], "200x200");
    assert!((158..=160).contains(&(right - left + 1).max(bottom - top + 1)));
}

#[test]
fn a_background_is_a_colour_or_transparent() {
    let place = place();
    let common = ["scene.toml", "--size", "9x9", "--camera", "near"];
    let pixel = |background: &str, index: usize| {
        place.render(&[&common as &[&str], &["--background", background]].concat()).succeeds();
        image::open(place.path("raywarp.png")).unwrap().to_rgba8().pixels().nth(index).unwrap().0
    };
    assert_eq!(pixel("#336699", 0), [0x33, 0x66, 0x99, 255]);
    assert_eq!(pixel("#336699", 40), [188, 0, 0, 255]);
    assert_eq!(pixel("none", 0), [0; 4]);
    assert_eq!(pixel("none", 40), [188, 0, 0, 255]);
    place.render(&[&common as &[&str], &["--background", "none", "-o", "a.exr"]].concat()).succeeds();
    let alpha = exr_channel(&place.path("a.exr"), "A").1;
    let green = exr_channel(&place.path("a.exr"), "G").1;
    assert_eq!((alpha[0], green[0], alpha[40], green[40]), (0.0, 0.0, 1.0, 0.0));
    place.render(&["scene.toml", "--background", "sky"]).fails(2, "give none, black, white, an sRGB colour");
}

#[test]
fn a_camera_that_sees_nothing_is_told() {
    let place = place();
    let said = "the camera sees nothing of the scene; --view front frames all of it";
    place.render(&["scene.toml", "--size", "9x9", "--camera", "away"]).says(said);
    assert!(!place.render(&["scene.toml", "--size", "9x9"]).succeeds().err().contains(said));
}

#[test]
fn an_axis_that_is_up_turns_the_built_in_sky_and_sun() {
    let place = place();
    // Lying on the ground where +Y is up, and where +Z is.
    place.write("y.obj", "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0.25 0.5 0.25\nf 1 2 3\nf 1 3 4\n");
    place.write("z.obj", "v 0 0 0\nv 0 -1 0\nv 1 0 0\nv 0.25 -0.25 0.5\nf 1 2 3\nf 1 3 4\n");
    place.render(&["y.obj", "--size", "40x30", "-o", "y.png"]).succeeds();
    place.render(&["z.obj", "--size", "40x30", "-o", "z.png", "--up", "+Z"]).succeeds();
    let ((_, _, y), (_, _, z)) = (png(&place.path("y.png")), png(&place.path("z.png")));
    let farthest = y.iter().flatten().zip(z.iter().flatten()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(farthest <= Some(2), "{farthest:?}");
}
