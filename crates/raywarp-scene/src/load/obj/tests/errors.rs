//! The sentences of errors.

use super::*;

fn error(bytes: &[u8]) -> String {
    let files = Files::new(&[("a.obj", bytes)]);
    files.local(&files.read().unwrap_err().to_string())
}

#[test]
fn numbers_are_numbers() {
    assert_eq!(
        error(b"v 0 0 0\r\nv 1,5 0 0"),
        "a.obj:2:3: '1,5' is not a number; expected 'v x y z', then perhaps a weight, or 'r g b' and perhaps 'a'. Write \
         numbers as 1.5 or -2e-3."
    );
    assert_eq!(
        error(b"vn 0 0"),
        "a.obj:1:7: 'vn 0 0' has 2 numbers; expected 'vn x y z'. Complete the line, or export the file again."
    );
    assert!(error(b"v 1 2").contains("has 2 numbers"));
    assert!(error(b"vt").contains("has 0 numbers"));
}

#[test]
fn indices_are_in_range() {
    assert_eq!(
        error(format!("{TRIANGLE}f 1 2 4").as_bytes()),
        "a.obj:4:7: '4' names vertex 4; expected 1 to 3 or -3 to -1, as the file has 3 'v', 3 before this line. Check \
         that the file is complete."
    );
    assert!(error(format!("f -1 -2 -3\n{TRIANGLE}").as_bytes()).contains("none of them before this line"));
    for face in ["0 1 2", "1 2 999999999999999999", "-4 1 2"] {
        assert!(error(format!("{TRIANGLE}f {face}").as_bytes()).contains("names vertex"), "{face}");
    }
}

#[test]
fn corners_are_corners() {
    for corner in ["a", "1.5", "1/2/3/4", "/1", "//", "1/x", "99999999999999999999", "1-"] {
        let error = error(format!("{TRIANGLE}vt 0 0\nvt 0 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf {corner} 2 3").as_bytes());
        assert_eq!(
            error,
            format!(
                "a.obj:9:3: '{corner}' is not a corner of a face; expected 'v', 'v/vt', 'v//vn' or 'v/vt/vn'. Indices are \
                 whole numbers, from 1, or below 0 to count backwards."
            )
        );
    }
}

#[test]
fn smoothing_groups_are_numbers() {
    assert_eq!(
        error(b"s x"),
        "a.obj:1:3: 'x' is not a smoothing group; expected 'off' or a number from 0. Correct or remove the line."
    );
}

#[test]
fn what_is_no_obj_is_refused_in_a_sentence() {
    const HELP: &str =
        "is not a statement; expected a keyword such as v, vt, vn, f, g, o, s or usemtl. Check that this \
                        is a Wavefront OBJ file, as text.";
    assert_eq!(error(b"\x7fELF\0\x01\x02 x"), format!("a.obj:1:1: '\\u{{7f}}ELF\\0\\u{{1}}\\u{{2}}' {HELP}"));
    assert_eq!(error(b"\n <!DOCTYPE html>"), format!("a.obj:2:2: '<!DOCTYPE' {HELP}"));
    assert_eq!(error(&[0; 1 << 20]), format!("a.obj:1:1: '{}...' {HELP}", "\\0".repeat(40)));
    assert_eq!(
        error("\u{feff}v".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>().as_slice()),
        "a.obj:1:1: the file is UTF-16; expected ASCII or UTF-8. Save it as UTF-8."
    );
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let read = |path: &Path| read(path, &mut Sources::new(&LoadOptions::default())).unwrap_err().to_string();
    assert!(read(folder.path()).ends_with("a directory as a scene is not supported. Name the scene file inside it."));
    assert!(read(&folder.path().join("b.obj")).ends_with("No such file or directory (os error 2). Check the path."));
    #[cfg(unix)]
    assert!(read(Path::new("/dev/zero"))
        .ends_with("a pipe or a device as a scene is not supported. Write it to a file first."));
}

#[test]
fn warnings_are_errors_where_that_is_asked() {
    let files = Files::new(&[("a.obj", b"l 1 2")]);
    let error = read(&files.1, &mut Sources::new(&LoadOptions { strict: true })).unwrap_err();
    assert_eq!(
        files.local(&error.to_string()),
        "a.obj:1: 1 'l' statement is skipped (lines) (an error, as reading is strict)"
    );
}
