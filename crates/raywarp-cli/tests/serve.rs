//! `raywarp serve` as a program: its words, its errors, its end. The page is tested in `browser.rs`.

use std::io::{BufRead, BufReader, Read};
use std::net::TcpListener;
use std::process::{Command, Stdio};

use crate::common::{Place, SCENE};

#[test]
fn a_taken_port_is_told_before_anything_is_read() {
    let held = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = held.local_addr().unwrap().port().to_string();
    Place::new().run(&["serve", "missing.obj", "--port", &port]).fails(2, "is taken").fails(2, "--port 0");
}

#[test]
fn a_scene_that_cannot_be_read_ends_it() {
    let place = Place::new();
    let serve = |scene: &str| place.run(&["serve", scene, "--port", "0", "--device", "cpu"]);
    serve("missing.obj").fails(2, "missing.obj");
    place.write("bad.toml", "version = 1\nnonsense = 2\n");
    serve("bad.toml").fails(2, "nonsense");
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let place = Place::new();
    let serve = |option: &str| place.run(&["serve", "--port", "0", option]);
    serve("--host=192.0.2.1").fails(2, "no address of this machine");
    serve("--viewers=0").fails(2, "a whole number from 1 to 1000");
    place.run(&["serve", "--port=65536"]).fails(2, "65536");
}

#[test]
fn a_missing_scene_is_told_before_the_address() {
    let place = Place::new();
    place.write("scene.xyz", "");
    std::fs::create_dir(place.path("folder.toml")).unwrap();
    for scene in ["missing.obj", "scene.xyz", "folder.toml"] {
        let run = place.run(&["serve", scene, "--port", "0", "--device", "cpu"]).fails(2, scene);
        assert_eq!(run.out(), "", "{scene}");
    }
}

#[test]
fn the_secret_is_not_taken_from_the_command_line() {
    let place = Place::new();
    let run = place.run(&["serve", "--port", "0", "--token=open-sesame"]).fails(2, "--token-file");
    assert!(run.err().contains("RAYWARP_TOKEN") && !run.err().contains("sesame"), "{}", run.err());
    place.run(&["serve", "--port", "0", "--token", "open-sesame"]).fails(2, "--token-file");
}

#[test]
fn a_secret_that_nobody_can_type_is_refused() {
    let place = Place::new();
    let with = |file: &[u8]| {
        place.write("secret", file);
        place.run(&["serve", "--port", "0", "--token-file", "secret"])
    };
    with(b"short\n").fails(2, "5 characters").fails(2, "of secret");
    with(b"").fails(2, "0 characters");
    with(b"open sesame\nand more\n").fails(2, "control character");
    with(b" open sesame").fails(2, "space at one end");
    with(&[b'x'; 5000]).fails(2, "more than 1024 bytes");
    with(&[0xff; 10]).fails(2, "secret");
    place.run(&["serve", "--port", "0", "--token-file", "none"]).fails(2, "cannot read the token of none");
    let mut command = place.command(&["serve", "--port", "0"]);
    let output = command.env("RAYWARP_TOKEN", "short").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("RAYWARP_TOKEN"), "{said}");
}

/// The address that a server prints, which is ended then.
fn address(command: &mut Command) -> String {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    line.trim().to_owned()
}

#[test]
fn the_secret_comes_from_a_file_or_the_environment() {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    place.write("secret", "a b+c&d=ü\r\n");
    let words = ["serve", "scene.toml", "--port", "0", "--device", "cpu"];
    let from_file =
        address(place.command(&[&words[..], &["--token-file", "secret"]].concat()).env("RAYWARP_TOKEN", "no"));
    let from_environment = address(place.command(&words).env("RAYWARP_TOKEN", "open-sesame"));
    let random = address(&mut place.command(&[&words[..], &["--token"]].concat()));
    for printed in [&from_file, &from_environment, &random] {
        let ticket = printed.split_once("/#ticket=").unwrap().1;
        assert!(ticket.len() == 32 && ticket.bytes().all(|byte| byte.is_ascii_hexdigit()), "{printed}");
    }
    assert!(!address(&mut place.command(&words)).contains('#'));
}

#[test]
#[cfg(unix)]
fn it_ends_soon_whoever_is_connected() {
    use std::io::Write;
    use std::time::{Duration, Instant};
    for signal in ["-INT", "-TERM"] {
        let place = Place::new();
        place.write("scene.toml", SCENE);
        let words = ["serve", "scene.toml", "--port", "0", "--device", "cpu"];
        let mut child = place.command(&words).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let mut url = String::new();
        output.read_line(&mut url).unwrap();
        let at = url.trim().trim_start_matches("http://").trim_end_matches('/').to_owned();
        // One that says nothing, and one whose picture nobody takes.
        let _silent = std::net::TcpStream::connect(&at).unwrap();
        let mut deaf = std::net::TcpStream::connect(&at).unwrap();
        let upgrade = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n";
        let key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
        write!(deaf, "GET /live HTTP/1.1\r\nHost: {at}\r\n{upgrade}{key}").unwrap();
        deaf.read_exact(&mut [0; 12]).unwrap();
        let hello = br#"{"type":"hello","protocol":1,"width":640,"height":480}"#;
        // A text, masked with zeros.
        deaf.write_all(&[&[0x81, 0x80 | hello.len() as u8, 0, 0, 0, 0], &hello[..]].concat()).unwrap();
        std::thread::sleep(Duration::from_millis(500));

        Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        let start = Instant::now();
        let status = child.wait().unwrap();
        eprintln!("{signal}: {:?}", start.elapsed());
        assert_eq!(status.code(), Some(130));
        // 0.2 s, and what a busy machine adds.
        assert!(start.elapsed() < Duration::from_millis(700), "{:?}", start.elapsed());
    }
}

#[test]
#[cfg(unix)]
fn it_prints_an_address_and_ends_on_an_interrupt() {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    let words = ["serve", "scene.toml", "--port", "0", "--host", "0.0.0.0", "--device", "cpu"];
    let mut child = place.command(&words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    let mut url = String::new();
    output.read_line(&mut url).unwrap();
    let port = url.split([':', '/']).nth(4).unwrap().to_owned();

    // Words come before the server does: it answers once the page is there.
    let mut page = None;
    while page.is_none() {
        page = ureq::get(format!("http://localhost:{port}/")).call().ok();
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let status = child.wait().unwrap();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    output.read_to_string(&mut url).unwrap();
    assert_eq!(status.code(), Some(130), "{said}");
    assert!(url.lines().count() == 1 && url.contains("/#ticket="), "{url}");
    assert!(said.contains(&format!("ssh -N -L {port}:127.0.0.1:{port} ")), "{said}");
    assert!(said.contains(&format!("http://127.0.0.1:{port}/#ticket=")), "{said}");
}
