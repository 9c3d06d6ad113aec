//! `raywarp serve` as a program: its words, its errors, its end. The page is tested in `browser.rs`.

mod common;

use std::io::{BufRead, BufReader, Read};
use std::net::TcpListener;
use std::process::{Command, Stdio};

use common::{Place, SCENE};

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
    serve("--token=short").fails(2, "8 to 128 letters");
    serve("--token=with/slash-in-it").fails(2, "'/'");
    serve("--host=192.0.2.1").fails(2, "no address of this machine");
    serve("--viewers=0").fails(2, "0 is not in 1..=1000");
    place.run(&["serve", "--port=65536"]).fails(2, "65536");
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
    assert!(url.lines().count() == 1 && url.contains("/#token="), "{url}");
    assert!(said.contains(&format!("ssh -N -L {port}:127.0.0.1:{port} ")), "{said}");
    assert!(said.contains(&format!("http://127.0.0.1:{port}/#token=")), "{said}");
}
