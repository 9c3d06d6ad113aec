//! Nothing that a run reads is overwritten, whatever it is called and wherever links lead, and nothing is written before
//! that is known.

use crate::common::{Place, Run};

/// A textured triangle, its picture, and an MTL that nobody has.
fn place() -> Place {
    let place = Place::new();
    place.write(
        "model.obj",
        "mtllib model.mtl\nmtllib lost.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n",
    );
    place.write("model.mtl", "newmtl m\nmap_Kd model.png\nmap_Ks lost.png\n");
    image::RgbImage::new(2, 2).save(place.path("model.png")).unwrap();
    place.write("rays.csv", "0.2,0.2,5,0,0,-1\n");
    place
}

fn contents(place: &Place) -> Vec<(String, Vec<u8>)> {
    let read = |name: String| (name.clone(), std::fs::read(place.path(&name)).unwrap_or_default());
    place.names().into_iter().map(read).collect()
}

/// Ends with 2 and the sentence, and changes no file.
#[track_caller]
fn refused(place: &Place, arguments: &[&str], sentence: &str) {
    let before = contents(place);
    place.run(arguments).fails(2, sentence);
    assert_eq!(contents(place), before, "{}", arguments.join(" "));
}

const RENDER: [&str; 6] = ["render", "model.obj", "--device", "cpu", "--size", "8x8"];

#[test]
fn no_output_of_render_is_a_file_of_the_scene() {
    let place = place();
    let orbit = ["--frames", "1..3", "--orbit"];
    for (more, sentence) in [
        (&["-o", "model.png"] as &[&str], "cannot write model.png: it is read, and would be lost"),
        (&["-o", "./model.png"], "cannot write ./model.png: it is the same file as model.png, which is read"),
        (&["-o", "a.png", "-o", "model.png"], "cannot write model.png"),
        (&["-o", "a.png", "--heatmap", "model.png"], "cannot write model.png"),
        (&["-o", "lost.png"], "cannot write lost.png"),
        (&["-o", "a.png", "-o", "./a.png"], "two outputs are the same file, a.png and ./a.png"),
        (&[&orbit as &[&str], &["-o", "a-#.png", "--animation", "model.png"]].concat(), "cannot write model.png"),
    ] {
        refused(&place, &[&RENDER as &[&str], more].concat(), sentence);
    }
    // Layers beside a picture, and single frames.
    place.write("model.mtl", "newmtl m\nmap_Kd a.depth.png\nmap_Ks frame-2.png\n");
    refused(&place, &[&RENDER as &[&str], &["-o", "a.png", "--aov", "depth"]].concat(), "cannot write a.depth.png");
    refused(&place, &[&RENDER as &[&str], &orbit, &["-o", "frame-#.png"]].concat(), "cannot write frame-2.png");
    place.run(&[&RENDER as &[&str], &["-o", "a.png"]].concat()).succeeds();
}

#[cfg(unix)]
#[test]
fn links_of_both_kinds_are_followed() {
    let place = place();
    std::os::unix::fs::symlink("model.obj", place.path("soft.png")).unwrap();
    std::os::unix::fs::symlink("lost.mtl", place.path("dangling.png")).unwrap();
    std::fs::hard_link(place.path("model.mtl"), place.path("hard.exr")).unwrap();
    for (name, file) in [("soft.png", "model.obj"), ("dangling.png", "lost.mtl"), ("hard.exr", "model.mtl")] {
        let sentence = format!("cannot write {name}: it is the same file as {file}, which is read, and would be lost");
        refused(&place, &[&RENDER as &[&str], &["-o", name]].concat(), &sentence);
    }
    let query = ["query", "model.obj", "--rays", "rays.csv", "--format", "csv", "-o"];
    refused(&place, &[&query as &[&str], &["soft.png"]].concat(), "the same file as model.obj");
}

#[test]
fn answers_are_not_written_over_rays() {
    let place = place();
    refused(
        &place,
        &["query", "model.obj", "--rays", "rays.csv", "-o", "rays.csv"],
        "cannot write rays.csv: it is read",
    );
    let texture = ["query", "model.obj", "--rays", "rays.csv", "--format", "csv", "-o", "model.png"];
    refused(&place, &texture, "cannot write model.png");
    place.run(&["query", "model.obj", "--rays", "rays.csv", "-o", "answers.csv"]).succeeds();
}

#[cfg(unix)]
#[test]
fn standard_streams_may_be_files_too() {
    let place = place();
    let before = contents(&place);
    let ends = |mut command: std::process::Command| Run(command.output().unwrap(), "query".to_owned());
    let mut command = place.command(&["query", "model.obj", "--rays", "-", "-o", "rays.csv"]);
    command.stdin(std::fs::File::open(place.path("rays.csv")).unwrap());
    ends(command).fails(2, "cannot write rays.csv: it is the same file as standard input, which is read");
    // As `>> model.obj` does.
    for arguments in [&["query", "model.obj", "--rays", "rays.csv", "-o", "-"] as &[&str], &["info", "model.obj"]] {
        let mut command = place.command(arguments);
        command.stdout(std::fs::OpenOptions::new().append(true).open(place.path("model.obj")).unwrap());
        ends(command).fails(2, "which is read, and would be lost");
    }
    assert_eq!(contents(&place), before);
}

#[test]
fn a_tree_of_the_cache_is_no_output() {
    let place = place();
    std::fs::create_dir(place.path("trees")).unwrap();
    place.write("trees/0123.tree", "a tree");
    let words = ["query", "model.obj", "--rays", "rays.csv", "--format", "csv", "-o", "trees/0123.tree"];
    let output = place.command(&words).env("RAYWARP_CACHE", place.path("trees")).output().unwrap();
    Run(output, words.join(" ")).fails(2, "cannot write trees/0123.tree");
    assert_eq!(std::fs::read(place.path("trees/0123.tree")).unwrap(), b"a tree");
}

#[cfg(unix)]
#[test]
fn nobody_guesses_a_temporary_name_and_what_a_killed_run_left_is_cleared() {
    let place = Place::new();
    place.write("victim.txt", "precious");
    let words = ["render", "--device", "cpu", "--size", "4000x4000", "--samples", "100", "--frames", "1..9", "--orbit"];
    let words = [&words as &[&str], &["-o", "#.png", "--animation", "a.mp4"]].concat();
    // An ffmpeg that never ends keeps its file.
    std::fs::create_dir(place.path("bin")).unwrap();
    place.write("bin/ffmpeg", "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nexec /bin/cat > /dev/null\n");
    let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    std::fs::set_permissions(place.path("bin/ffmpeg"), executable).unwrap();
    let mut child = place.command(&words).env("PATH", place.path("bin")).spawn().unwrap();
    let left = || place.names().into_iter().filter(|name| name.starts_with(".raywarp-")).collect::<Vec<_>>();
    while left().is_empty() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    // The file of a run that is alive stays.
    place.render(&["--size", "8x8", "-o", "beside.png", "-q"]).succeeds();
    assert_eq!(left().len(), 1);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(left().len(), 1);
    place.render(&["--size", "8x8", "-o", "after.png", "-q"]).succeeds();
    assert_eq!(left(), [""; 0]);
    assert_eq!(std::fs::read(place.path("victim.txt")).unwrap(), b"precious");
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_to_is_a_sentence() {
    let place = place();
    std::fs::create_dir(place.path("locked")).unwrap();
    let read_only: std::fs::Permissions = std::os::unix::fs::PermissionsExt::from_mode(0o555);
    std::fs::set_permissions(place.path("locked"), read_only).unwrap();
    if std::fs::write(place.path("locked/trial"), "").is_ok() {
        eprintln!("an administrator may write everywhere: not tested");
        return;
    }
    refused(
        &place,
        &[&RENDER as &[&str], &["-o", "locked/a.png"]].concat(),
        "Choose a directory that you may write to",
    );
}
