//! The server and its protocol, by a client that is no browser.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use crate::common::{event, hello, impatient, own_stage, wheel, House, News, LONG, SIZE};
use raywarp_viewer::live::Viewer;
use raywarp_viewer::serve::{ServeError, ServeOptions, Server, Token, PROTOCOL};
use raywarp_viewer::ViewerError;
use serde_json::{json, Value};
use tungstenite::{Error, Message};

/// What the core shows once nothing more is coming.
fn settled_pixels() -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let mut live_scene = own_stage(&directory);
    let mut viewer = Viewer::new(SIZE);
    let start = Instant::now();
    while start.elapsed() < LONG {
        live_scene.poll();
        match viewer.frame(&mut live_scene, start.elapsed()).unwrap() {
            Some(picture) if picture.settled => return picture.rgba.clone(),
            _ => {}
        }
    }
    panic!("it never settles");
}

#[test]
fn a_lossy_picture_comes_first_and_then_the_very_pixels_of_the_core() {
    let house = House::open();
    let mut client = house.enter();
    let (mut lossy, mut lossless) = (None, None);
    while lossless.is_none() {
        let shown = client.picture();
        client.ack(shown.first.frame);
        assert_eq!(shown.rgba.len(), 4 * (shown.first.size[0] * shown.first.size[1]) as usize);
        let place = if shown.first.lossless { &mut lossless } else { &mut lossy };
        *place = Some(shown);
    }
    let (lossy, lossless) = (lossy.unwrap(), lossless.unwrap());
    assert_eq!((lossless.first.size, lossless.first.settled), (SIZE, true));
    assert_eq!(lossless.rgba, settled_pixels());
    let far = lossy.rgba.iter().zip(&lossless.rgba).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
    assert!(far / (lossy.rgba.len() as f64) < 4.0, "{far}");
    // It follows once, and then there is nothing to send.
    assert!(client.picture_within(Duration::from_millis(700)).is_none());
}

#[test]
fn the_greeting_has_the_help_and_state_follows() {
    let house = House::open();
    let mut client = house.connect();
    client.send(&hello(""));
    let greeting = client.text("hello");
    assert_eq!((&greeting["protocol"], &greeting["name"]), (&json!(PROTOCOL), &json!("raywarp")));
    assert!(greeting["help"].as_array().is_some_and(|groups| !groups.is_empty()), "{greeting}");
    let status = client.text("status");
    assert_eq!(status["status"]["scene"], "scene.toml");
    assert_eq!(status["link"]["viewers"], 1);
    let mut client = house.enter();
    assert!(client.text("panel")["panel"]["sections"].is_array());
}

#[test]
fn without_acknowledgements_two_pictures_come_and_no_third() {
    let house = House::open();
    let mut client = house.enter();
    let mut frames = vec![client.picture().first.frame];
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(2) {
        client.send(&wheel());
        frames.extend(client.picture_within(Duration::from_millis(50)).map(|shown| shown.first.frame));
    }
    assert_eq!(frames.len(), 2, "{frames:?}");
    client.ack(frames[1]);
    client.send(&wheel());
    assert!(client.picture().first.frame > frames[1]);
}

#[test]
fn acknowledgements_of_what_was_never_sent_do_nothing() {
    let house = House::open();
    let mut client = house.enter();
    for frame in [0, 7, u32::MAX] {
        client.ack(frame);
        client.send(&json!({"type": "received", "frame": frame, "bytes": u64::MAX}));
    }
    assert!(!client.picture().rgba.is_empty());
}

#[test]
fn a_mark_comes_back_with_the_first_picture_after_it() {
    let house = House::open();
    let mut client = house.enter();
    let first = client.picture();
    assert_eq!(first.first.mark, 0);
    client.send(&wheel());
    client.send(&json!({"type": "mark", "mark": 41}));
    client.send(&wheel());
    client.send(&json!({"type": "mark", "mark": 42}));
    client.ack(first.first.frame);
    let start = Instant::now();
    while start.elapsed() < LONG {
        let shown = client.picture();
        client.ack(shown.first.frame);
        if shown.first.mark == 42 {
            return;
        }
    }
    panic!("the mark never came");
}

#[test]
fn sizes_follow_the_page_within_limits() {
    let house = House::open();
    let mut client = house.enter();
    for (asked, given) in [([320, 240], [320, 240]), ([0, 40], [1, 40])] {
        client.send(&event(json!({"kind": "resize", "width": asked[0], "height": asked[1]})));
        let start = Instant::now();
        loop {
            let shown = client.picture();
            client.ack(shown.first.frame);
            if shown.first.size == given {
                break;
            }
            assert!(start.elapsed() < LONG, "{:?}", shown.first.size);
        }
    }
}

#[test]
fn nothing_is_made_for_a_page_that_nobody_sees() {
    let house = House::open();
    let mut client = house.enter();
    loop {
        let shown = client.picture();
        client.ack(shown.first.frame);
        if shown.first.lossless {
            break;
        }
    }
    client.send(&json!({"type": "visible", "visible": false}));
    client.send(&wheel());
    assert!(client.picture_within(Duration::from_millis(500)).is_none());
    client.send(&json!({"type": "visible", "visible": true}));
    assert!(!client.picture().rgba.is_empty());
}

#[test]
fn a_file_comes_whole_after_its_head() {
    let house = House::open();
    let mut client = house.enter();
    let shown = client.picture();
    client.ack(shown.first.frame);
    client.send(&event(json!({"kind": "key", "key": "F12", "down": true})));
    let head = client.text("file");
    loop {
        match client.next(LONG) {
            Some(News::File(content)) => {
                assert_eq!((&head["bytes"], &head["media_type"]), (&json!(content.len()), &json!("image/png")));
                assert!(image::load_from_memory(&content).is_ok());
                return;
            }
            Some(News::Closed(code, reason)) => panic!("{code} {reason}"),
            _ => {}
        }
    }
}

#[test]
fn two_clients_have_a_camera_each() {
    let house = House::open();
    let (mut one, mut other) = (house.enter(), house.enter());
    let lossless = |client: &mut crate::common::Client| loop {
        let shown = client.picture();
        client.ack(shown.first.frame);
        if shown.first.lossless {
            return shown.rgba;
        }
    };
    let (first, second) = (lossless(&mut one), lossless(&mut other));
    assert_eq!(first, second);
    one.send(&event(json!({"kind": "wheel", "notches": 4})));
    let moved = lossless(&mut one);
    assert_ne!(moved, first);
    assert!(other.picture_within(Duration::from_millis(500)).is_none());
    // It is told again what has changed, before the first one, which says nothing any more, is taken to be gone.
    other.send(&event(json!({"kind": "wheel", "notches": 1})));
    assert_eq!(other.text("status")["link"]["viewers"], 2);
}

#[test]
fn only_who_has_the_token_comes_in() {
    let token = Token::chosen("open-sesame").unwrap();
    let house = House::new(ServeOptions { token: Some(token), ..ServeOptions::default() });
    for wrong in ["", "open-sesamf", "open-sesame-and-more"] {
        let mut client = house.connect();
        client.send(&hello(wrong));
        let (code, reason) = client.closed();
        assert!(code == 4001 && reason.contains("token"), "{code} {reason}");
    }
    let mut client = house.connect();
    client.send(&hello("open-sesame"));
    client.text("hello");
}

#[test]
fn any_other_address_than_loopback_needs_a_token() {
    let server = |host: &str| Server::bind(ServeOptions { host: host.to_owned(), port: 0, ..ServeOptions::default() });
    assert!(!server("127.0.0.1").unwrap().addresses().here.contains('#'));
    let url = server("0.0.0.0").unwrap().addresses().here;
    let ticket = url.split_once("/#ticket=").unwrap().1;
    assert!(ticket.len() == 32 && ticket.bytes().all(|byte| byte.is_ascii_hexdigit()), "{url}");
}

#[test]
fn a_ticket_is_exchanged_for_the_token_once() {
    let token = Token::chosen("open-sesame").unwrap();
    let house = House::new(ServeOptions { token: Some(token), ..ServeOptions::default() });
    let ticket = house.url.split_once("/#ticket=").unwrap().1.to_owned();
    let mut first = hello("");
    first["ticket"] = ticket.into();
    // Another version of the page does not use it up.
    let mut old = first.clone();
    old["protocol"] = 0.into();
    let mut client = house.connect();
    client.send(&old);
    assert_eq!(client.closed().0, 4003);
    let mut client = house.connect();
    client.send(&first);
    assert_eq!(client.text("hello")["token"], "open-sesame");
    let mut again = house.connect();
    again.send(&first);
    assert_eq!(again.closed().0, 4001);
    let mut with_token = house.connect();
    with_token.send(&hello("open-sesame"));
    assert!(with_token.text("hello").get("token").is_none(), "it is told for a ticket alone");
}

#[test]
fn other_pages_and_foreign_names_are_refused() {
    let house = House::open();
    let status = |headers: &[(&'static str, &str)]| {
        let mut request = house.request();
        headers.iter().for_each(|(name, value)| drop(request.headers_mut().insert(*name, value.parse().unwrap())));
        match house.connect_by(request) {
            Ok(_) => 101,
            Err(error) => match *error {
                Error::Http(response) => response.status().as_u16(),
                other => panic!("{other}"),
            },
        }
    };
    let own = format!("http://{}", house.at);
    assert_eq!((status(&[]), status(&[("origin", &own)])), (101, 101));
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1"] {
        assert_eq!(status(&[("origin", origin)]), 403, "{origin}");
    }
    assert_eq!(status(&[("host", "evil.example")]), 403);
    assert_eq!(status(&[("host", "evil.example"), ("origin", "http://evil.example")]), 403);
}

#[test]
fn what_cannot_be_read_ends_the_connection_with_a_reason() {
    let house = House::open();
    let texts = [
        "",
        "garbage",
        "{}",
        "[1, 2]",
        r#"{"type": "nothing"}"#,
        r#"{"type": "ack", "frame": -1}"#,
        r#"{"type": "event", "event": {"kind": "pointer", "x": 1e999, "y": 0}}"#,
        r#"{"type": "event", "event": {"kind": "wheel", "notches": 1e300}}"#,
        r#"{"type": "hello", "protocol": 1, "width": 1, "height": 1}"#,
    ];
    let deep = format!("{{\"type\": {}", "[".repeat(10_000));
    for text in texts.into_iter().chain([deep.as_str()]) {
        let mut client = house.enter();
        client.write(Message::text(text));
        let (code, reason) = client.closed();
        assert!(code == 4000 && !reason.is_empty(), "{text}: {code} {reason}");
    }
    for first in [Message::text("garbage"), Message::binary(vec![0; 10]), Message::text(wheel().to_string())] {
        let mut client = house.connect();
        client.write(first);
        assert_eq!(client.closed().0, 4000);
    }
    let mut client = house.enter();
    client.write(Message::binary(vec![1, 2, 3]));
    assert_eq!(client.closed().0, 4000);
    // The others are still served.
    assert!(!house.enter().picture().rgba.is_empty());
}

#[test]
fn a_message_that_is_too_long_ends_the_connection() {
    let house = House::open();
    let mut client = house.enter();
    let _ = client.socket.send(Message::text(" ".repeat(70_000)));
    // With the rest of the message unread, the system may tell only that the connection is gone.
    let (code, reason) = client.closed();
    assert!(code == 1009 || code == 0, "{code} {reason}");
    assert!(!house.enter().picture().rgba.is_empty());
}

#[test]
fn another_version_is_told_which_one_is_spoken() {
    let house = House::open();
    let mut client = house.connect();
    client.send(&json!({"type": "hello", "protocol": PROTOCOL + 1, "width": 10, "height": 10}));
    assert_eq!(client.text("hello")["protocol"], PROTOCOL);
    let (code, reason) = client.closed();
    assert!(code == 4003 && reason.contains("reload"), "{code} {reason}");
}

#[test]
fn those_beyond_the_limit_are_told() {
    let house = House::new(ServeOptions { viewers: 2, ..ServeOptions::default() });
    let (one, _two) = (house.enter(), house.enter());
    let mut third = house.connect();
    third.send(&hello(""));
    let (code, reason) = third.closed();
    assert!(code == 4002 && reason.contains("2 places"), "{code} {reason}");
    drop(one);
    let start = Instant::now();
    loop {
        let mut next = house.connect();
        next.send(&hello(""));
        match next.next(LONG) {
            Some(News::Text(message)) if message["type"] == "hello" => return,
            _ => assert!(start.elapsed() < LONG),
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn who_says_nothing_is_dropped() {
    let house = House::new(ServeOptions { patience: impatient(), ..ServeOptions::default() });
    // No greeting on a WebSocket.
    assert_eq!(house.connect().closed().0, 4004);
    // No request, half a request, and a request byte by byte.
    let silent = TcpStream::connect(house.at).unwrap();
    let mut half = TcpStream::connect(house.at).unwrap();
    half.write_all(b"GET / HTTP/1.1\r\nHost: local").unwrap();
    let mut slow = TcpStream::connect(house.at).unwrap();
    let start = Instant::now();
    while start.elapsed() < LONG && slow.write_all(b"G").is_ok() {
        std::thread::sleep(Duration::from_millis(100));
    }
    for mut stream in [silent, half, slow] {
        stream.set_read_timeout(Some(LONG)).unwrap();
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
    }
    assert!(start.elapsed() < LONG);
}

#[test]
fn a_client_that_never_reads_is_dropped() {
    let house = House::new(ServeOptions { viewers: 1, patience: impatient(), ..ServeOptions::default() });
    let mut deaf = house.connect();
    deaf.send(&hello(""));
    let start = Instant::now();
    loop {
        std::thread::sleep(Duration::from_millis(200));
        assert!(start.elapsed() < LONG, "it keeps its place");
        let mut next = house.connect();
        next.send(&hello(""));
        if matches!(next.next(LONG), Some(News::Text(message)) if message["type"] == "hello") {
            return;
        }
    }
}

#[test]
fn clients_are_told_when_the_server_ends() {
    let house = House::open();
    let mut client = house.enter();
    client.picture();
    house.stop();
    let end = client.text("end");
    assert_eq!(end["error"], false);
    assert_eq!(client.closed().0, 1001);
    assert!(house.join().is_ok());
}

#[test]
fn a_scene_that_cannot_be_read_ends_the_server_with_a_sentence() {
    let house = House::with_scene(ServeOptions::default(), "version = 1\nnonsense = 2\n");
    let error = house.join().unwrap_err();
    assert!(
        matches!(&error, ServeError::Viewer(ViewerError::Load(_))) && error.to_string().contains("scene.toml"),
        "{error}"
    );
}

#[test]
fn the_page_is_served_with_a_strict_policy() {
    let house = House::open();
    let get = |path: &str| {
        let mut stream = TcpStream::connect(house.at).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", house.at).unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        text
    };
    let page = get("/");
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("default-src 'none'"), "{page}");
    for (path, kind) in
        [("/style.css", "text/css"), ("/viewer.js", "text/javascript"), ("/words.js", "text/javascript")]
    {
        let file = get(path);
        assert!(file.starts_with("HTTP/1.1 200") && file.contains(kind), "{path}: {file}");
    }
    assert!(get("/../Cargo.toml").starts_with("HTTP/1.1 404"));
    let files = [get("/"), get("/style.css"), get("/viewer.js"), get("/words.js")].concat();
    assert!(!files.contains("https://") && !files.contains("http://"), "nothing from elsewhere");
}

#[test]
fn the_status_is_told_at_most_a_few_times_a_second() {
    let house = House::open();
    let mut client = house.enter();
    let (start, mut told) = (Instant::now(), 0);
    let time = Duration::from_secs(2);
    while start.elapsed() < time {
        client.send(&wheel());
        match client.next(Duration::from_millis(10)) {
            Some(News::Text(Value::Object(message))) if message["type"] == "status" => told += 1,
            Some(News::Stripe(stripe)) if stripe.index + 1 == stripe.count => client.ack(stripe.frame),
            _ => {}
        }
    }
    assert!((2..=20).contains(&told), "{told} in {time:?}");
}
