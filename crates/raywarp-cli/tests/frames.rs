//! Turntables and camera flights: names, resuming, parts, animations, and what is refused.

use std::io::BufReader;
use std::path::Path;

use crate::common::{png, Place, SCENE};

/// A scene with paths: past the triangle and on to where nothing is, and a loop.
const PATHS: &str = r#"
[[paths]]
name = "past"
[[paths.keys]]
eye = [0, 0, 4]
target = [0, 0, 0]
[[paths.keys]]
eye = [1, 0, 4]
target = [5, 0, 0]
[[paths.keys]]
eye = [0, 0, 4]
target = [0, 0, 8]

[[paths]]
name = "around"
closed = true
[[paths.keys]]
eye = [0, 0, 4]
target = [0, 0, 0]
[[paths.keys]]
eye = [4, 0, 0]
target = [0, 0, 0]
[[paths.keys]]
eye = [0, 0, -4]
target = [0, 0, 0]
"#;

fn place() -> Place {
    let place = Place::new();
    place.write("scene.toml", format!("{SCENE}{PATHS}"));
    place
}

/// `render scene.toml` of small frames.
fn render(place: &Place, arguments: &[&str]) -> crate::common::Run {
    place.render(&[&["scene.toml", "--size", "16x12"], arguments].concat())
}

/// What is drawn in the middle of a frame.
fn middle(place: &Place, name: &str) -> [u8; 3] {
    png(&place.path(name)).2[6 * 16 + 8]
}

const RED: [u8; 3] = [188, 0, 0];
const SKY: [u8; 3] = [137, 188, 99];

#[test]
fn an_orbit_starts_at_the_camera_and_comes_back() {
    let place = place();
    render(&place, &["-o", "still.png"]).succeeds();
    render(&place, &["--frames", "1..4", "--orbit", "-o", "f-####.png"]).says("f-####.png: 4 frames of 16x12 pixels");
    assert_eq!(place.names(), ["f-0001.png", "f-0002.png", "f-0003.png", "f-0004.png", "scene.toml", "still.png"]);
    assert_eq!(png(&place.path("f-0001.png")), png(&place.path("still.png")));
    // From the side a triangle is a line; from behind it is there again.
    assert_eq!((middle(&place, "f-0001.png"), middle(&place, "f-0003.png")), (RED, RED));
    // The frame after the last would be the first.
    render(&place, &["--frames", "5", "--of", "1..5", "--orbit=-360", "-o", "{frame}.png"]).succeeds();
    render(&place, &["--frames", "2", "--of", "1..5", "--orbit=360", "-o", "{frame}.png"]).succeeds();
    assert_eq!(png(&place.path("5.png")), png(&place.path("2.png")));
    // An arc ends where it is told to.
    render(&place, &["--frames", "1..3", "--orbit=180", "-o", "arc{frame}.png"]).succeeds();
    assert_eq!(png(&place.path("arc3.png")), png(&place.path("f-0003.png")));
}

#[test]
fn parts_are_the_frames_of_the_whole() {
    let place = place();
    render(&place, &["--frames", "0..5", "--orbit", "-o", "all-#.png"]).succeeds();
    for part in ["0..2", "3..5"] {
        render(&place, &["--frames", part, "--of", "0..5", "--orbit", "-o", "part-#.png"]).succeeds();
    }
    render(&place, &["--frames", "0..5/2", "--of", "0..5", "--orbit", "-o", "step-#.png"]).succeeds();
    for frame in 0..6 {
        let all = png(&place.path(&format!("all-{frame}.png")));
        assert_eq!(png(&place.path(&format!("part-{frame}.png"))), all, "{frame}");
        assert!(frame % 2 == 1 || png(&place.path(&format!("step-{frame}.png"))) == all, "{frame}");
    }
}

#[test]
fn a_path_leads_from_its_first_key_to_its_last() {
    let place = place();
    render(&place, &["--frames", "1..3", "--path", "past", "-o", "#.png"]).succeeds();
    let seen = ["1.png", "2.png", "3.png"].map(|name| middle(&place, name));
    assert_eq!(seen, [RED, SKY, SKY]);
    render(&place, &["-o", "still.png"]).succeeds();
    assert_eq!(png(&place.path("1.png")), png(&place.path("still.png")));
    // Of three frames around three keys each is a key.
    render(&place, &["--frames", "1..3", "--path", "1", "-o", "around-#.png"]).succeeds();
    render(&place, &["--eye", "0,0,-4", "-o", "behind.png"]).succeeds();
    assert_eq!(png(&place.path("around-3.png")), png(&place.path("behind.png")));
    // What is said of every camera holds for every frame.
    render(&place, &["--frames", "1..3", "--path", "past", "--target", "0,0,0", "-o", "at-#.png"]).succeeds();
    assert_eq!(middle(&place, "at-3.png"), RED);
}

#[test]
fn frames_that_are_there_are_kept() {
    let place = place();
    let words = ["--frames", "1..4", "--orbit", "-o", "#.png", "-o", "#.exr", "--aov", "depth", "--heatmap", "h#.png"];
    let frames = |more: &[&str]| render(&place, &[&words as &[&str], more].concat());
    frames(&[]).succeeds();
    let names = place.names();
    assert_eq!(names.len(), 4 * 4 + 1, "{names:?}");
    // A mark that rendering would wipe out.
    let marked: Vec<_> = names.iter().filter(|name| name.ends_with("png")).collect();
    let mark = |name: &str| {
        let bytes = std::fs::read(place.path(name)).unwrap();
        let (head, rest) = bytes.split_at(33);
        place.write(name, [head, b"\0\0\0\x03tEXta\0b\x07\x5c\x95\x4c", rest].concat());
    };
    marked.iter().for_each(|name| mark(name));
    let is_marked = |name: &str| std::fs::read(place.path(name)).unwrap()[37..44] == *b"tEXta\0b";
    frames(&[]).says("#.png, #.exr: 0 frames of 16x12 pixels").says("; 4 were there already and are kept");

    // Missing, cut off, empty, and missing beside the picture.
    std::fs::remove_file(place.path("1.exr")).unwrap();
    let bytes = std::fs::read(place.path("2.png")).unwrap();
    place.write("2.png", &bytes[..bytes.len() - 1]);
    place.write("4.depth.png", "");
    let run = frames(&["--stats=json"]).says("3 frames of 16x12");
    let stats: serde_json::Value = serde_json::from_str(&run.out()).unwrap();
    assert_eq!((&stats["frames"]["rendered"], &stats["frames"]["kept"]), (&3.into(), &1.into()));
    assert!(stats["tests"]["rays"].as_u64() >= Some(3 * 16 * 12));
    assert_eq!(place.names(), names);
    for name in marked {
        assert_eq!(is_marked(name), name.contains('3'), "{name}");
    }

    frames(&["--overwrite"]).says("4 frames of 16x12");
    assert!(!is_marked("3.png"));
}

#[test]
fn frames_of_other_options_or_another_scene_are_made_anew_and_others_pictures_are_not() {
    let place = place();
    for ending in ["png", "exr"] {
        let output = format!("#.{ending}");
        let words = ["--frames", "1..4", "--orbit", "-o", &output];
        let frames = |more: &[&str]| render(&place, &[&words as &[&str], more].concat());
        let made = |name: &str| std::fs::read(place.path(name)).unwrap();
        let second = format!("2.{ending}");
        frames(&[]).succeeds();
        let usual = made(&second);
        for more in [&["--samples", "2"] as &[&str], &["--crop", "0,0,8,8"], &["--orbit=180"], &["--seed", "7"], &[]] {
            let words: Vec<_> =
                words.iter().filter(|word| more != ["--orbit=180"] || **word != "--orbit").copied().collect();
            let run = render(&place, &[&words, more].concat()).says("4 were there of another scene or other options");
            assert!(!run.err().contains("kept"), "{}", run.err());
        }
        assert_eq!(made(&second), usual);
        frames(&["--threads", "1", "--accel", "kd"]).says("0 frames").says("4 were there already");
        // The scene changes.
        place.write("scene.toml", format!("{SCENE}{PATHS}").replace("[0.5, 0, 0]", "[0, 0.5, 0]"));
        frames(&[]).says("4 were there of another scene");
        assert_ne!(made(&second), usual);
        place.write("scene.toml", format!("{SCENE}{PATHS}"));
        // Cut short or damaged anywhere.
        frames(&[]).succeeds();
        for length in [usual.len() - 1, usual.len() / 2, 100, 0] {
            place.write(&second, &usual[..length]);
            frames(&[]).says("1 frame of").says("3 were there already");
            assert_eq!(made(&second), usual, "{length}");
        }
    }
    // Whose is a picture that does not say how it was made?
    image::RgbImage::new(3, 3).save(place.path("1.png")).unwrap();
    render(&place, &["--frames", "1..4", "--orbit", "-o", "#.png"])
        .fails(2, "1.png is there, of 3x3 pixels instead of 16x12");
}

#[test]
fn a_picture_tells_how_to_make_it_again() {
    let place = place();
    render(&place, &["--eye", "0.1,-2,3", "--samples", "3", "-o", "a.png", "-o", "a.exr"]).succeeds();
    let reader = png::Decoder::new(BufReader::new(std::fs::File::open(place.path("a.png")).unwrap())).read_info();
    let texts = reader.unwrap().info().utf8_text.clone();
    let text = |keyword: &str| texts.iter().find(|text| text.keyword == keyword).unwrap().get_text().unwrap();
    assert!(text("Software").starts_with("raywarp "));
    let comment = text("Comment");
    assert!(comment.starts_with("raywarp render scene.toml --size 16x12 --samples 3 "), "{comment}");
    let exr = std::fs::read(place.path("a.exr")).unwrap();
    assert!(exr.windows(comment.len()).any(|bytes| bytes == comment.as_bytes()));
    let words: Vec<_> = comment.split(' ').skip(2).chain(["-o", "again.png"]).collect();
    place.render(&words).succeeds();
    assert_eq!(std::fs::read(place.path("again.png")).unwrap(), std::fs::read(place.path("a.png")).unwrap());
}

#[test]
fn standard_output_takes_frame_after_frame() {
    let place = place();
    let run = render(&place, &["--frames", "1..3", "--orbit", "-o", "-"]).says("standard output: 3 frames");
    let heads = run.0.stdout.windows(8).filter(|bytes| bytes == b"\x89PNG\r\n\x1a\n").count();
    assert_eq!(heads, 3);
    assert_eq!(place.names(), ["scene.toml"]);
}

#[test]
fn frames_without_a_name_have_one() {
    let place = place();
    render(&place, &["--frames", "9..10", "--of", "12", "--orbit"]).succeeds();
    assert_eq!(place.names(), ["raywarp-0009.png", "raywarp-0010.png", "scene.toml"]);
}

/// Frames of an APNG: its size, and the pixels of each.
fn apng(path: &Path) -> ([u32; 2], Vec<Vec<u8>>) {
    let mut reader = png::Decoder::new(BufReader::new(std::fs::File::open(path).unwrap())).read_info().unwrap();
    let info = reader.info();
    let (size, count) = ([info.width, info.height], info.animation_control().unwrap().num_frames);
    assert_eq!(info.frame_control().map(|control| (control.delay_num, control.delay_den)), Some((1, 12)));
    let frame = |_| {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels
    };
    (size, (0..count).map(frame).collect())
}

/// Frames of a GIF: its size, and colours and delay of each.
fn gif(path: &Path) -> ([u16; 2], Vec<Vec<u8>>, Vec<u16>) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(std::fs::File::open(path).unwrap()).unwrap();
    let (mut frames, mut delays) = (Vec::new(), Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        frames.push(frame.buffer.chunks(4).flat_map(|rgba| rgba[..3].to_vec()).collect());
        delays.push(frame.delay);
    }
    ([decoder.width(), decoder.height()], frames, delays)
}

#[test]
fn animations_hold_every_frame() {
    let place = place();
    for (name, frames) in [("a.png", "1..5"), ("a.gif", "1..5"), ("b.apng", "3..7")] {
        let words = ["--frames", frames, "--orbit", "--animation", name, "--fps", "12"];
        render(&place, &words).says(&format!("{name}: 5 frames, 12 a second"));
    }
    // No frame is left beside them.
    assert_eq!(place.names(), ["a.gif", "a.png", "b.apng", "scene.toml"]);
    let ((size, frames), (gif_size, gif_frames, delays)) = (apng(&place.path("a.png")), gif(&place.path("a.gif")));
    assert_eq!((size, gif_size, frames.len()), ([16, 12], [16, 12], 5));
    assert_eq!(apng(&place.path("b.apng")), (size, frames.clone()));
    // So few colours stay what they are.
    assert_eq!(gif_frames, frames);
    assert_eq!(delays, [8, 9, 8, 8, 9]);
    assert!(frames[0] != frames[1]);
}

#[test]
fn frames_that_are_kept_are_in_the_animation() {
    let place = place();
    let words = ["--frames", "1..5", "--orbit", "--fps", "12", "-o", "#.png", "--animation"];
    render(&place, &[&words as &[&str], &["whole.png"]].concat()).succeeds();
    for name in ["2.png", "5.png"] {
        std::fs::remove_file(place.path(name)).unwrap();
    }
    render(&place, &[&words as &[&str], &["mended.png"]].concat()).says("2 frames of").says("3 were there");
    assert_eq!(apng(&place.path("mended.png")), apng(&place.path("whole.png")));
    // An EXR shows no pixels: such frames are rendered.
    let linear = ["--frames", "1..5", "--orbit", "--fps", "12", "-o", "#.exr", "--animation", "linear.png"];
    render(&place, &linear).succeeds();
    render(&place, &linear).says("5 frames of");
    assert_eq!(apng(&place.path("linear.png")), apng(&place.path("whole.png")));
}

/// An ffmpeg of our own: it notes its arguments, and does as told with its input.
#[cfg(unix)]
fn put_ffmpeg(place: &Place, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::create_dir_all(place.path("bin")).unwrap();
    let ffmpeg = format!(
        "#!/bin/sh\nPATH=/usr/bin:/bin\n[ \"$1\" = -version ] && exit 0\nprintf '%s\\n' \"$@\" > arguments\n\
         for target in \"$@\"; do :; done\ntarget=\"${{target#file:}}\"\n{script}\n"
    );
    place.write("bin/ffmpeg", ffmpeg);
    std::fs::set_permissions(place.path("bin/ffmpeg"), std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// `render` with only that ffmpeg on the path.
#[cfg(unix)]
fn with_ffmpeg(place: &Place, script: &str, arguments: &[&str]) -> crate::common::Run {
    put_ffmpeg(place, script);
    let words = [&["render", "--device", "cpu", "scene.toml", "--size", "16x12"], arguments].concat();
    let output = place.command(&words).env("PATH", place.path("bin")).output().unwrap();
    crate::common::Run(output, words.join(" "))
}

#[cfg(unix)]
#[test]
fn ffmpeg_is_given_every_frame() {
    let place = place();
    let words = ["--frames", "1..3", "--orbit", "-o", "#.png", "--fps", "12.5", "--animation"];
    for name in ["a.mp4", "a.webm"] {
        let run = with_ffmpeg(&place, "cat > \"$target\"", &[&words as &[&str], &[name]].concat());
        run.says(&format!("{name}: 3 frames, 12.5 a second"));
        let frames = ["1.png", "2.png", "3.png"].map(|name| png(&place.path(name)).2);
        assert_eq!(std::fs::read(place.path(name)).unwrap(), frames.concat().as_flattened());
        let arguments = std::fs::read_to_string(place.path("arguments")).unwrap();
        for words in ["-video_size\n16x12\n-framerate\n12.5\n", "-pix_fmt\nrgb24\n", &format!("-f\n{}\n", &name[2..])] {
            assert!(arguments.contains(words), "{arguments}");
        }
    }
    let names = ["1.png", "2.png", "3.png", "a.mp4", "a.webm", "arguments", "bin", "scene.toml"];
    assert_eq!(place.names(), names);
}

#[cfg(unix)]
#[test]
fn an_ffmpeg_that_fails_is_quoted_and_leaves_nothing() {
    let place = place();
    let words = ["--frames", "1..200", "--orbit", "--animation", "a.mp4"];
    for script in ["echo no such codec >&2; exit 8", "cat > /dev/null; echo no such codec >&2; exit 8"] {
        with_ffmpeg(&place, script, &words).fails(2, "cannot write a.mp4: ffmpeg ended with exit status: 8: no such");
    }
    assert_eq!(place.names(), ["arguments", "bin", "scene.toml"]);
}

#[test]
fn without_ffmpeg_it_is_said_what_to_do() {
    let place = place();
    let words = ["render", "--frames", "1..9", "--orbit", "--spp", "10000", "--animation", "a.mp4"];
    let output = place.command(&words).env("PATH", place.path("empty")).output().unwrap();
    crate::common::Run(output, words.join(" ")).fails(
        2,
        "cannot write a.mp4: that takes ffmpeg, and there is none on the PATH. Install ffmpeg, or write a .gif",
    );
    assert_eq!(place.names(), ["scene.toml"]);
}

#[test]
fn a_real_ffmpeg_makes_a_video() {
    let is_there = |name: &str| std::process::Command::new(name).arg("-version").output().is_ok();
    if !is_there("ffmpeg") || !is_there("ffprobe") {
        eprintln!("there is no ffmpeg: not tested");
        return;
    }
    let place = place();
    for name in ["a.mp4", "a.webm"] {
        // Sides are made even.
        let words = ["scene.toml", "--size", "33x17", "--frames", "1..7", "--orbit", "--animation", name];
        place.render(&words).says(&format!("{name}: 7 frames, 24 a second"));
        let mut probe = std::process::Command::new("ffprobe");
        probe.args(["-v", "error", "-count_frames", "-of", "csv=p=0"]).arg(place.path(name));
        probe.args(["-show_entries", "stream=width,height,nb_read_frames,r_frame_rate"]);
        let said = String::from_utf8(probe.output().unwrap().stdout).unwrap();
        assert_eq!(said.trim(), "34,18,24/1,7", "{name}");
    }
}

/// Ends `render` with SIGINT once it has written five frames.
#[cfg(unix)]
fn interrupted(place: &Place, animation: &str) {
    let words =
        ["render", "--device", "cpu", "--size", "64x36", "--frames", "1..100000", "--orbit", "-o", "{frame}.png"];
    let mut command = place.command(&[&words as &[&str], &["--animation", animation]].concat());
    let mut child = command.env("PATH", place.path("bin")).spawn().unwrap();
    while place.names().iter().filter(|name| name.ends_with("png")).count() < 5 {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    for name in place.names().iter().filter(|name| !["arguments", "bin"].contains(&name.as_str())) {
        assert!(name.ends_with(".png") && png(&place.path(name)).0 == 64, "{name}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_whole_frames_only() {
    interrupted(&Place::new(), "a.gif");
    let place = Place::new();
    put_ffmpeg(&place, "cat > \"$target\"");
    interrupted(&place, "a.mp4");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let place = place();
    let orbit = ["--frames", "1..4", "--orbit"];
    for (arguments, sentence) in [
        (&["--orbit"] as &[&str], "--frames <RANGE>"),
        (&["--path", "past"], "--frames <RANGE>"),
        (&["--animation", "a.gif"], "--frames <RANGE>"),
        (&["--overwrite"], "--frames <RANGE>"),
        (&["--frames", "1..4"], "<--orbit[=<DEGREES>]|--path <NAME|INDEX>>"),
        (&["--frames", "1..4", "--orbit", "--path", "past"], "cannot be used with"),
        (&["--frames", "1..4", "--path", "past", "--eye", "0,0,1"], "cannot be used with"),
        (&["--frames", "1..4", "--path", "past", "--camera", "near"], "cannot be used with"),
        (&["--frames", "1..4", "--orbit", "--fps", "12"], "--animation <FILE>"),
        (&["--frames", "4..1", "--orbit"], "it holds no frames"),
        (&["--frames", "all", "--orbit"], "such as 1..240"),
        (&["--frames", "7", "--orbit"], "--frames 7 is one frame of how many?"),
        (&["--frames", "1..9", "--of", "8", "--orbit"], "--frames 1..9 are no part of --of 1..8"),
        (&["--frames", "1..9", "--orbit=x"], "give an angle"),
        (&["--frames", "1..9", "--path", "home"], "there is no camera path 'home'; the scene has 0 'past', 1 'around'"),
        (&["--frames", "1..9", "--path", "2"], "there is no camera path '2'"),
        (&["--frames", "1..3", "--path", "past", "--target", "1,0,4"], "frame 2: the camera 'past' stands on its own"),
        (&[&orbit as &[&str], &["-o", "a.png"]].concat(), "as in a-####.png"),
        (&[&orbit as &[&str], &["-o", "{frame:4}.png"]].concat(), "is not understood"),
        (&[&orbit as &[&str], &["-o", "#.png", "-o", "{frame}.png"]].concat(), "two outputs have the same name, 1.png"),
        (&[&orbit as &[&str], &["-o", "#.png", "--animation", "3.png"]].concat(), "the same name, 3.png"),
        (&[&orbit as &[&str], &["-o", "none/#.png"]].concat(), "there is no directory none"),
        (&[&orbit as &[&str], &["-o", "#.gif"]].concat(), "its name does not end in .png or .exr"),
        (&[&orbit as &[&str], &["--heatmap", "h.png"]].concat(), "as in h-####.png"),
        (&[&orbit as &[&str], &["--animation", "a.avi"]].concat(), "does not end in .gif, .png, .apng, .mp4 or .webm"),
        (&[&orbit as &[&str], &["--animation", "none/a.gif"]].concat(), "there is no directory none"),
        (&[&orbit as &[&str], &["--animation", "a.gif", "--fps", "60"]].concat(), "at most 50 frames a second"),
        (&[&orbit as &[&str], &["--animation", "a.gif", "--fps", "0"]].concat(), "from 0.01 to 1000"),
        (&[&orbit as &[&str], &["--animation", "a.gif", "--aov", "depth"]].concat(), "give -o too"),
        (&[&orbit as &[&str], &["-o", "-", "--stats=json"]].concat(), "cannot both go to standard output"),
    ] {
        place.run(&[&["render", "scene.toml", "--device", "cpu"], arguments].concat()).fails(2, sentence);
    }
    assert_eq!(place.names(), ["scene.toml"]);
    place.render(&["--frames", "1..4", "--path", "past"]).fails(2, "the scene has none; write [[paths]]");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said() {
    let place = place();
    std::os::unix::fs::symlink("/dev/full", place.path("full.gif")).unwrap();
    render(&place, &["--frames", "1..2", "--orbit", "--animation", "full.gif"]).fails(2, "the disk is full");
    assert_eq!(place.names(), ["full.gif", "scene.toml"]);
}
