//! `raywarp query` as a process: answers are right in every format, and bad rays are told with their place.

use std::io::{Read, Write};
use std::process::Stdio;

use crate::common::{Place, Run};

/// Two squares at z = 0 and z = -1, each of two triangles.
const SQUARES: &str = "\
o front
v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0
f 1 2 3\nf 1 3 4
o back
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1
f 5 6 7\nf 5 7 8
";

/// Down on both squares, past them, and up from between them.
const RAYS: [f32; 18] = [
    0.5, -0.25, 2.0, 0.0, 0.0, -1.0, //
    5.0, 0.0, 2.0, 0.0, 0.0, -1.0, //
    -0.5, 0.25, -0.5, 0.0, 0.0, 0.5,
];

/// A `.npy` file.
fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\x00" as &[u8], &(text.len() as u16).to_le_bytes(), text.as_bytes(), data].concat()
}

fn rays(shape: &str, numbers: &[f32]) -> Vec<u8> {
    npy("<f4", shape, &numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<_>>())
}

fn place() -> Place {
    let place = Place::new();
    place.write("squares.obj", SQUARES);
    place.write("rays.npy", rays("(3, 6)", &RAYS));
    place
}

fn query(place: &Place, arguments: &[&str]) -> Run {
    place.run(&[&["query", "squares.obj", "--device", "cpu"], arguments].concat())
}

/// The head and the data of a `.npy` file.
fn array(bytes: &[u8]) -> (String, Vec<u8>) {
    let len = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    (String::from_utf8_lossy(&bytes[10..10 + len]).trim_end().to_owned(), bytes[10 + len..].to_vec())
}

/// The arrays of an archive that is not compressed, by name: its files, one after the other.
fn arrays(path: &std::path::Path) -> Vec<(String, String, Vec<u8>)> {
    let bytes = std::fs::read(path).unwrap();
    let number = |at: usize, len: usize| bytes[at..at + len].iter().rev().fold(0, |n, b| n << 8 | usize::from(*b));
    let (mut at, mut arrays) = (0, Vec::new());
    while bytes[at..].starts_with(b"PK\x03\x04") {
        let (size, name, extra) = (number(at + 18, 4), number(at + 26, 2), number(at + 28, 2));
        let start = at + 30 + name + extra;
        let (head, data) = array(&bytes[start..start + size]);
        arrays.push((String::from_utf8_lossy(&bytes[at + 30..at + 30 + name]).into_owned(), head, data));
        at = start + size;
    }
    arrays
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect()
}

#[test]
fn the_closest_hits_are_an_archive_of_arrays() {
    let place = place();
    query(&place, &["--rays", "rays.npy"]).says("hits.npz: 3 rays, 2 with a hit on CPU");
    let arrays = arrays(&place.path("hits.npz"));
    let names: Vec<_> = arrays.iter().map(|array| array.0.as_str()).collect();
    assert_eq!(names, ["t.npy", "primitive.npy", "geometry.npy", "uv.npy"]);
    assert_eq!(arrays[0].1, "{'descr': '<f4', 'fortran_order': False, 'shape': (3,), }");
    assert_eq!(arrays[3].1, "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }");
    assert_eq!(floats(&arrays[0].2), [2.0, f32::INFINITY, 1.0]);
    assert_eq!(words(&arrays[1].2), [0, u32::MAX, 1]);
    assert_eq!(words(&arrays[2].2), [0, u32::MAX, 0]);
    assert_eq!(floats(&arrays[3].2)[..2], [0.375, 0.375]);
    assert_eq!(place.names(), ["hits.npz", "rays.npy", "squares.obj"]);
}

#[test]
fn the_shape_of_the_batch_is_kept() {
    let place = place();
    place.write("rays.npy", rays("(3, 1, 6)", &RAYS));
    query(&place, &["-r", "rays.npy", "-m", "count", "-o", "n.npy"]).succeeds();
    let (head, data) = array(&std::fs::read(place.path("n.npy")).unwrap());
    assert_eq!(head, "{'descr': '<u4', 'fortran_order': False, 'shape': (3, 1), }");
    assert_eq!(words(&data), [2, 0, 1]);
    place.write("rays.npy", rays("(6,)", &RAYS[..6]));
    query(&place, &["-r", "rays.npy", "-m", "any", "-o", "a.npy"]).succeeds();
    let (head, data) = array(&std::fs::read(place.path("a.npy")).unwrap());
    assert_eq!((head.as_str(), data), ("{'descr': '|b1', 'fortran_order': False, 'shape': (), }", vec![1]));
}

#[test]
fn all_hits_have_offsets() {
    let place = place();
    query(&place, &["--rays", "rays.npy", "--mode", "all", "-o", "a.npz"]).says("3 rays, 3 hits");
    let all = arrays(&place.path("a.npz"));
    assert_eq!(all[0].0, "offsets.npy");
    let offsets: Vec<_> = all[0].2.chunks(8).map(|b| u64::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(offsets, [0, 2, 2, 3]);
    assert_eq!(floats(&all[1].2), [2.0, 3.0, 1.0]);
    assert_eq!((words(&all[2].2), words(&all[3].2)), (vec![0, 0, 1], vec![0, 1, 0]));
    query(&place, &["--rays", "rays.npy", "--mode", "all", "-o", "b.npz", "--max-hits", "1"]).says("3 rays, 2 hits");
    query(&place, &["--rays", "rays.npy", "--mode", "count", "-o", "c.csv", "--max-hits", "1"]).succeeds();
    assert_eq!(std::fs::read_to_string(place.path("c.csv")).unwrap(), "count\n1\n0\n1\n");
}

#[test]
fn text_goes_in_and_out_through_pipes() {
    let place = place();
    let run = |arguments: &[&str], input: &[u8]| {
        let arguments = [&["query", "squares.obj", "--device", "cpu", "--rays", "-", "-o", "-"], arguments].concat();
        let mut command = place.command(&arguments);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(input).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let text = "ox,oy,oz,dx,dy,dz\n0.5,-0.25,2,0,0,-1\n5,0,2,0,0,-1\n";
    let closest = run(&[], text.as_bytes());
    assert_eq!(
        String::from_utf8(closest).unwrap(),
        "t,primitive,geometry,u,v\n2.0,0,0,0.375,0.375\ninf,4294967295,4294967295,0.0,0.0\n"
    );
    let all = run(&["--mode", "all"], &rays("(3, 6)", &RAYS));
    assert!(String::from_utf8(all)
        .unwrap()
        .starts_with("ray,t,primitive,geometry,u,v\n0,2.0,0,0,0.375,0.375\n0,3.0,0,1,"));
    let (head, data) = array(&run(&["--mode", "any", "--format", "npy"], text.as_bytes()));
    assert_eq!((head.as_str(), data), ("{'descr': '|b1', 'fortran_order': False, 'shape': (2,), }", vec![1, 0]));
    assert!(run(&["--format", "npz"], b"").starts_with(b"PK"));
    assert_eq!(place.names(), ["rays.npy", "squares.obj"]);
}

#[test]
fn ends_are_columns_and_negative_ones_reach_back() {
    let place = place();
    place.write("rays.csv", "0.5,-0.25,-0.5,-inf,0,0,1,inf\n0.5,-0.25,-0.5,-1,0,0,1,0\n0.5,-0.25,-0.5,nan,0,0,1,inf\n");
    query(&place, &["--rays", "rays.csv", "--mode", "all", "-o", "a.csv"]).succeeds();
    let text = std::fs::read_to_string(place.path("a.csv")).unwrap();
    let starts: Vec<_> =
        text.lines().skip(1).map(|line| line.split(',').take(2).collect::<Vec<_>>().join(" ")).collect();
    assert_eq!(starts, ["0 -0.5", "0 0.5", "1 -0.5"]);
}

#[test]
fn every_structure_gives_the_same_file() {
    let place = place();
    let file = |accel| {
        query(&place, &["--rays", "rays.npy", "--accel", accel, "--mode", "all", "--threads", "1"]).succeeds();
        std::fs::read(place.path("hits.npz")).unwrap()
    };
    let [brute, kd, bvh] = ["brute", "kd", "bvh"].map(file);
    assert!(brute == kd && kd == bvh);
}

#[test]
fn no_rays_are_no_error() {
    let place = place();
    place.write("none.npy", rays("(0, 6)", &[]));
    place.write("none.csv", "");
    for (name, mode) in
        ["none.npy", "none.csv"].into_iter().flat_map(|n| ["closest", "any", "count", "all"].map(|m| (n, m)))
    {
        query(&place, &["--rays", name, "--mode", mode, "-o", "a.npz"]).says("a.npz: 0 rays");
        let arrays = arrays(&place.path("a.npz"));
        assert!(arrays.iter().all(|(name, _, data)| data.is_empty() || (name == "offsets.npy" && *data == [0; 8])));
    }
}

#[test]
fn float64_is_rounded_and_said() {
    let place = place();
    let data: Vec<u8> = RAYS.iter().flat_map(|x| f64::from(*x).to_be_bytes()).collect();
    place.write("double.npy", npy(">f8", "(3, 6)", &data));
    query(&place, &["--rays", "double.npy", "-o", "a.csv"]).says("note: the rays are float64, and rounded to float32");
    query(&place, &["--rays", "rays.npy", "-o", "b.csv"]).succeeds();
    assert_eq!(std::fs::read(place.path("a.csv")).unwrap(), std::fs::read(place.path("b.csv")).unwrap());
}

#[test]
fn a_summary_is_json() {
    let place = place();
    let run = query(&place, &["--rays", "rays.npy", "--json", "-q"]).succeeds();
    let json: serde_json::Value = serde_json::from_str(&run.out()).unwrap();
    assert_eq!(
        (json["rays"].as_u64(), json["hits"].as_u64(), json["mode"].as_str()),
        (Some(3), Some(2), Some("closest"))
    );
    assert!(json["seconds"]["query"].as_f64() > Some(0.0) && json["triangles"] == 4);
    assert!(run.err().is_empty());
}

#[test]
fn broken_rays_are_errors_that_name_the_place_and_leave_nothing() {
    let place = place();
    let whole = rays("(3, 6)", &RAYS);
    for (name, contents, sentence) in [
        ("cut.npy", whole[..whole.len() - 4].to_vec(), "the file ends here, and rays of shape (3, 6) take 72 bytes"),
        ("head.npy", whole[..30].to_vec(), "head.npy: byte 10: the file ends within"),
        ("empty.npy", Vec::new(), "empty.npy: byte 0: the file ends"),
        ("text.npy", b"1,2,3,4,5,6\n".to_vec(), "is not how a .npy file begins"),
        ("three.npy", rays("(6, 3)", &RAYS), "an array of shape (6, 3); expected a last axis of 6"),
        ("huge.npy", rays("(4000000000000, 6)", &RAYS), "take 96000000000000 bytes"),
        ("beyond.npy", rays("(99999999999999999999, 6)", &RAYS), "expected a length below 2^64"),
        ("int.npy", npy("<i4", "(3, 6)", &[0; 72]), "items of type '<i4'; expected float32 or float64"),
        ("object.npy", npy("|O", "(3, 6)", &[0; 72]), "items of type '|O'"),
        ("fields.npy", npy("x', 'y", "(3, 6)", &[]), "fields.npy: byte "),
        ("archive.npz", b"PK\x03\x04 and so on".to_vec(), "an archive; expected a single array"),
        (
            "order.npy",
            String::from_utf8_lossy(&npy("<f4", "(3, 6)", &[])).replace("False", "True").into_bytes(),
            "order.npy",
        ),
        ("word.csv", b"0,0,2,0,0,-1\n0,0,two,0,0,-1\n".to_vec(), "word.csv: line 2, column 3: 'two' is no number"),
        ("short.csv", b"0,0,2,0,0,-1\n0,0,2,0,0\n".to_vec(), "short.csv: line 2: 5 numbers; expected 6"),
        ("seven.csv", b"0,0,2,0,0,-1,7\n".to_vec(), "seven.csv: line 1: 7 numbers; expected 6"),
    ] {
        place.write(name, contents);
        query(&place, &["--rays", name]).fails(2, sentence);
    }
    query(&place, &["--rays", "missing.npy"]).fails(2, "cannot read missing.npy: No such file or directory");
    assert!(!place.names().iter().any(|name| name.contains("hits") || name.ends_with(".tmp")));
}

#[test]
fn impossible_wishes_are_refused_before_any_work() {
    let place = place();
    std::fs::create_dir(place.path("taken.npz")).unwrap();
    for (arguments, sentence) in [
        (&["-o", "a.txt"] as &[&str], "its name does not end in .npz, .npy or .csv"),
        (&["-o", "taken.npz"], "it is a directory"),
        (&["-o", "none/a.npz"], "there is no directory none"),
        (&["-o", "a.npy"], "a .npy file holds one: write .npz or .csv"),
        (&["-o", "a.npy", "--mode", "all"], "a .npy file holds one"),
        (&["--mode", "first"], "expected closest, any, count or all"),
        (&["--format", "exr"], "expected npz, npy or csv"),
        (&["--max-hits", "5"], "--max-hits bounds what --mode all and --mode count find"),
        (&["-o", "-", "--json"], "cannot both go to standard output"),
    ] {
        query(&place, &[&["--rays", "rays.npy"], arguments].concat()).fails(2, sentence);
    }
    place.run(&["query", "squares.obj"]).fails(2, "--rays <FILE>");
    place.run(&["query", "none.obj", "--rays", "rays.npy"]).fails(2, "cannot read none.obj");
    place.run(&["query", "squares.obj", "--rays", "rays.npy", "--device", "cuda:99"]).fails(3, "CUDA");
    assert_eq!(place.names(), ["rays.npy", "squares.obj", "taken.npz"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said() {
    let place = place();
    for name in ["full.npz", "full.csv"] {
        std::os::unix::fs::symlink("/dev/full", place.path(name)).unwrap();
        query(&place, &["--rays", "rays.npy", "-o", name]).fails(2, "the disk is full");
    }
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let arguments = ["query", "squares.obj", "--device", "cpu", "--rays", "rays.npy", "-o", "-"];
    let output = place.command(&arguments).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("the disk is full"));
}

#[test]
fn a_reader_that_goes_is_no_failure() {
    let place = place();
    place.write("many.npy", rays("(30000, 6)", &RAYS.repeat(10_000)));
    let arguments = ["query", "squares.obj", "--device", "cpu", "--rays", "many.npy", "-o", "-"];
    let mut child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0), "{said}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_with_130_and_leaves_nothing() {
    let place = place();
    // Brute force on many triangles takes minutes.
    place.write("many.npy", rays("(600000, 6)", &RAYS.repeat(200_000)));
    let arguments = ["query", "--device", "cpu", "--accel", "brute", "--rays", "many.npy"];
    let mut child = place.command(&arguments).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(1500));
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(place.names(), ["many.npy", "rays.npy", "squares.obj"]);
}
