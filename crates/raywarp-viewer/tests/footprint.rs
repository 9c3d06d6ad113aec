//! What a server needs does not grow with what clients do to it. One test, as the numbers are those of the process.

mod common;

use std::time::{Duration, Instant};

use common::{event, wheel, House, LONG};
use serde_json::json;

/// Memory and threads of this process: KiB and a count.
fn footprint() -> (u64, usize) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    let memory = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    (memory, std::fs::read_dir("/proc/self/task").unwrap().count())
}

/// A picture whole, acknowledged: all that was sent before it has been taken.
fn settle(house: &House) {
    let mut client = house.enter();
    let shown = client.picture();
    client.ack(shown.first.frame);
}

#[test]
#[cfg(target_os = "linux")]
fn memory_and_threads_are_bounded() {
    let house = House::open();
    settle(&house);
    let (memory, threads) = footprint();
    let grown = |what: &str| {
        let (now, now_threads) = footprint();
        let more = now.saturating_sub(memory);
        eprintln!("{what}: {more} KiB more, {now_threads} threads ({threads} at first)");
        assert!(more < 48 << 10, "{what}: {more} KiB more");
        assert!(now_threads <= threads + 2, "{what}: {now_threads} threads, {threads} at first");
    };

    flood(&house);
    grown("100,000 events");
    cycles(&house);
    grown("1,000 connections");
    deaf(&house);
    grown("clients that never read");
}

/// Events of every kind as fast as they go, with nothing read until the end.
fn flood(house: &House) {
    let mut client = house.enter();
    let kinds = [
        event(json!({"kind": "pointer", "x": 0.5, "y": 0.25})),
        event(json!({"kind": "button", "button": "left", "down": true})),
        event(json!({"kind": "key", "key": "x", "down": true})),
        wheel(),
        event(json!({"kind": "button", "button": "left", "down": false})),
    ];
    let texts = kinds.map(|event| tungstenite::Message::text(event.to_string()));
    for index in 0..100_000 {
        client.write(texts[index % texts.len()].clone());
    }
    client.send(&json!({"type": "mark", "mark": 9}));
    let start = Instant::now();
    loop {
        let shown = client.picture();
        client.ack(shown.first.frame);
        if shown.first.mark == 9 {
            return;
        }
        assert!(start.elapsed() < LONG);
    }
}

fn cycles(house: &House) {
    for round in 0..1000 {
        let start = Instant::now();
        let mut client = house.connect();
        client.send(&common::hello(""));
        // Some leave at once, some after the greeting, some as one should. All places may be taken for a moment.
        match round % 3 {
            0 => {}
            1 => drop(client.next(Duration::from_secs(5))),
            _ => drop(client.socket.close(None)),
        }
        assert!(start.elapsed() < LONG);
    }
    // The last ones may still hold all places.
    std::thread::sleep(Duration::from_millis(500));
    settle(house);
}

/// They ask for pictures all the time, and take none.
fn deaf(house: &House) {
    let mut clients: Vec<_> = (0..4).map(|_| house.enter()).collect();
    for _ in 0..200 {
        clients.iter_mut().for_each(|client| client.send(&wheel()));
        std::thread::sleep(Duration::from_millis(5));
    }
}
