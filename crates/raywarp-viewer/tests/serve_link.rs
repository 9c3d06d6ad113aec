//! What the server takes for a slow link, and what a page sees meanwhile.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use crate::common::{event, hello, wheel, Client, House, Shown, LONG};
use serde_json::json;

/// Reads for so long, and shows nothing: as a browser whose page is busy.
fn read_on(client: &mut Client, time: Duration) {
    let start = Instant::now();
    while let Some(left) = time.checked_sub(start.elapsed()).filter(|left| !left.is_zero()) {
        client.next(left);
    }
}

#[test]
fn a_page_that_is_busy_is_not_taken_for_a_slow_link() {
    let house = House::open();
    let mut client = house.enter();
    for _ in 0..10 {
        client.send(&wheel());
        let shown = client.picture();
        // Decoding takes that long, say, while the scene is traced on the same cores.
        read_on(&mut client, Duration::from_millis(250));
        client.ack(shown.first.frame);
    }
    let link = &client.status["link"];
    assert!(link["quality"].as_u64() >= Some(75) && link["scale"] == 1.0, "{link}");
    assert!(link["lag_ms"].as_f64() > Some(100.0), "{link}");
}

/// A way to a server that passes on so many bytes of its answers a second.
fn slow_way(to: SocketAddr, bytes_per_second: usize) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let at = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        let (client, _) = listener.accept().unwrap();
        let server = TcpStream::connect(to).unwrap();
        let (mut from, mut into) = (client.try_clone().unwrap(), server.try_clone().unwrap());
        std::thread::spawn(move || std::io::copy(&mut from, &mut into));
        pass_slowly(server, client, bytes_per_second);
    });
    at
}

fn pass_slowly(mut from: TcpStream, mut to: TcpStream, bytes_per_second: usize) {
    let mut portion = vec![0; bytes_per_second / 100];
    while let Ok(read) = from.read(&mut portion) {
        if read == 0 || to.write_all(&portion[..read]).is_err() {
            break;
        }
        std::thread::sleep(Duration::from_secs_f64(read as f64 / bytes_per_second as f64));
    }
    let _ = to.shutdown(Shutdown::Both);
}

/// Share of a picture's pixels that are black: the scene has none.
fn black(shown: &Shown) -> f32 {
    let dark = shown.rgba.chunks_exact(4).filter(|pixel| pixel[..3].iter().all(|&channel| channel < 24)).count();
    4.0 * dark as f32 / shown.rgba.len() as f32
}

#[test]
fn after_a_move_over_a_slow_link_the_coarse_picture_stays_until_better_pixels_come() {
    const WIDE: [u32; 2] = [1600, 1200];
    let house = House::open();
    let at = slow_way(house.at, 300_000);
    let mut client = House::connect_through(at, house.request()).unwrap();
    let mut greeting = hello("");
    (greeting["width"], greeting["height"]) = (WIDE[0].into(), WIDE[1].into());
    client.send(&greeting);
    client.text("hello");
    client.send(&event(json!({"kind": "set", "id": "look.spp", "value": 2})));

    // Moves until there are fewer pixels than were asked for, and what is traced is that.
    let begin = Instant::now();
    while client.status["link"]["scale"].as_f64().is_none_or(|scale| scale > 0.9) {
        client.send(&wheel());
        let shown = client.picture();
        client.ack(shown.first.frame);
        assert!(black(&shown) < 0.001, "{:?}", shown.first);
        assert!(begin.elapsed() < LONG, "{}", client.status);
    }
    // At rest the whole picture comes, and never a part of one.
    let mut sizes = Vec::new();
    loop {
        let shown = client.picture();
        client.ack(shown.first.frame);
        assert!(black(&shown) < 0.001, "{:?} after {sizes:?}", shown.first);
        sizes.push(shown.first.size);
        if shown.first.lossless && shown.first.size == WIDE {
            break;
        }
        assert!(begin.elapsed() < 2 * LONG);
    }
}
