//! Many at the door at once: browsers with their six connections, idle ones, strangers, and who asks for files.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use crate::common::{event, hello, wheel, Client, House, News, LONG};
use raywarp_viewer::serve::{Patience, ServeOptions, Token, PROTOCOL};
use serde_json::json;

const SECRET: &str = "open-sesame";

/// A server that waits for a silent connection longer than any test does.
fn patient() -> ServeOptions {
    let (head, request, hello) = (10 * LONG, 10 * LONG, 10 * LONG);
    ServeOptions { patience: Patience { head, request, hello, ..Patience::default() }, ..ServeOptions::default() }
}

fn secret() -> ServeOptions {
    ServeOptions { token: Some(Token::chosen(SECRET).unwrap()), connections: 32, ..patient() }
}

/// A request whose connection stays open, as browsers have it; how much came.
fn get(stream: &mut TcpStream, path: &str) -> usize {
    let host = stream.peer_addr().unwrap();
    stream.set_read_timeout(Some(LONG)).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte).unwrap();
        head.extend(byte);
    }
    let head = String::from_utf8(head).unwrap().to_lowercase();
    assert!(head.starts_with("http/1.1 200"), "{head}");
    let length = head.lines().find_map(|line| line.strip_prefix("content-length: ")).unwrap().parse().unwrap();
    let mut content = vec![0; length];
    stream.read_exact(&mut content).unwrap();
    length
}

/// Loads the page by six connections, all of which stay open, and waits for the first picture.
fn browse(house: &House) -> usize {
    let paths = ["/", "/style.css", "/viewer.js", "/input.js", "/link.js", "/panel.js"];
    let mut connections: Vec<_> = paths.map(|_| TcpStream::connect(house.at).unwrap()).into();
    for (stream, path) in connections.iter_mut().zip(paths) {
        assert!(get(stream, path) > 100);
    }
    let mut client = house.enter();
    let shown = client.picture();
    client.ack(shown.first.frame);
    shown.bytes
}

#[test]
fn fifty_browsers_at_once_all_have_a_picture() {
    let house = House::new(patient());
    let start = Instant::now();
    let pictures = thread::scope(|scope| {
        let browsers: Vec<_> = (0..50).map(|_| scope.spawn(|| browse(&house))).collect();
        browsers.into_iter().filter_map(|browser| browser.join().ok()).count()
    });
    eprintln!("{pictures} pictures in {:?}", start.elapsed());
    assert_eq!(pictures, 50);
}

/// Whether the server has closed a connection.
fn is_closed(stream: &mut TcpStream) -> bool {
    stream.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
    match stream.read(&mut [0; 512]) {
        Ok(0) => true,
        Ok(_) => false,
        Err(error) => error.kind() == std::io::ErrorKind::ConnectionReset,
    }
}

/// Connections that say nothing, half of a request, and nothing after the WebSocket is there.
fn strangers(house: &House) -> Vec<TcpStream> {
    let kinds = [
        String::new(),
        "GET / HTTP/1.1\r\nHo".to_owned(),
        format!(
            "GET /live HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n",
            house.at
        ),
    ];
    let open = |index: usize| {
        let mut stream = TcpStream::connect(house.at).unwrap();
        stream.write_all(kinds[index % kinds.len()].as_bytes()).unwrap();
        stream
    };
    (0..120).map(open).collect()
}

fn enter(house: &House) -> Client {
    let mut client = house.connect();
    client.send(&hello(SECRET));
    client.text("hello");
    client
}

#[test]
fn strangers_do_not_hold_the_door() {
    let house = House::new(secret());
    let mut guest = enter(&house);
    let first = guest.picture();
    let mut strangers = strangers(&house);
    // They hold all there is to hold, and everybody who knows the secret comes in.
    let mut clients: Vec<_> = (0..10).map(|_| enter(&house)).collect();
    assert!(clients.iter_mut().all(|client| !client.picture().rgba.is_empty()));
    // Who was there before they came still is.
    guest.ack(first.first.frame);
    guest.send(&wheel());
    assert!(guest.picture().first.frame > first.first.frame);

    let start = Instant::now();
    loop {
        strangers.retain_mut(|stream| !is_closed(stream));
        if strangers.len() <= 32 {
            return;
        }
        assert!(start.elapsed() < LONG, "{} of 120 strangers are still connected", strangers.len());
    }
}

#[test]
fn a_page_where_nothing_happens_is_told_nothing() {
    let house = House::open();
    let mut client = house.enter();
    loop {
        let shown = client.picture();
        client.ack(shown.first.frame);
        if shown.first.lossless {
            break;
        }
    }
    while client.next(Duration::from_millis(500)).is_some() {}
    // Long enough for the next pings.
    let told = client.next(Duration::from_secs(5));
    assert!(told.is_none(), "{told:?}");
}

/// Reads until a file is there; bytes of it.
fn file(client: &mut Client) -> usize {
    loop {
        match client.next(LONG) {
            Some(News::File(content)) => return content.len(),
            Some(News::Closed(code, reason)) => panic!("{code} {reason}"),
            None => panic!("no file came"),
            _ => {}
        }
    }
}

/// Pictures that one client is sent before the other has its file.
fn pictures_during_a_file(small: &mut Client, mut large: Client) -> (usize, Client) {
    let reader = thread::spawn(move || (file(&mut large), large));
    let mut pictures = 0;
    while !reader.is_finished() {
        small.send(&wheel());
        let shown = small.picture();
        small.ack(shown.first.frame);
        pictures += 1;
    }
    let (bytes, large) = reader.join().unwrap();
    eprintln!("{pictures} pictures during a file of {bytes} bytes");
    (pictures, large)
}

#[test]
fn a_file_of_a_4k_picture_is_made_while_another_viewer_goes_on() {
    let house = House::open();
    let mut large = house.connect();
    large.send(&json!({"type": "hello", "protocol": PROTOCOL, "token": "", "width": 4096, "height": 2160}));
    let shown = large.picture();
    large.ack(shown.first.frame);
    let mut small = house.enter();
    small.picture();

    let key = event(json!({"kind": "key", "key": "F12", "down": true}));
    // Where the machine has little else to do a file is soon made, so it may take more than one.
    let mut at_once = 0;
    for _ in 0..8 {
        (0..64).for_each(|_| large.send(&key));
        let pictures;
        (pictures, large) = pictures_during_a_file(&mut small, large);
        at_once = at_once.max(pictures);
        if at_once >= 2 {
            break;
        }
    }
    assert!(at_once >= 2, "{at_once} pictures meanwhile");

    // Of 64 there was one: what comes next is the answer to another key.
    let later = Instant::now();
    while later.elapsed() < Duration::from_secs(1) {
        match large.next(Duration::from_millis(100)) {
            Some(News::File(_)) => panic!("a second file"),
            Some(News::Stripe(stripe)) if stripe.index + 1 == stripe.count => large.ack(stripe.frame),
            _ => {}
        }
    }
    large.send(&key);
    assert!(file(&mut large) > 1000);
}
