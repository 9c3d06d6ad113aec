//! `raywarp serve` and its page in a real browser. Where there is none, these tests say so and pass.

mod common;

use std::sync::{Mutex, PoisonError};

use common::browser::Browser;
use common::server::Server;
use common::{Place, SCENE};

/// One browser at a time: they are heavy.
static ALONE: Mutex<()> = Mutex::new(());

/// A server of a triangle, on the CPU.
fn serve(arguments: &[&str]) -> Server {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    serve_at(place, "0", arguments)
}

fn serve_at(place: Place, port: &str, arguments: &[&str]) -> Server {
    Server::at(place, port, &[&["scene.toml", "--device", "cpu"], arguments].concat())
}

const OPEN: &str = "window.raywarp?.connection === 'open'";
const LOSSLESS: &str = "document.getElementById('picture').dataset.kind === 'png'";
const FRAME: &str = "document.getElementById('picture').dataset.frame";
/// The picture as a text.
const PIXELS: &str = "document.getElementById('picture').toDataURL()";

#[test]
fn a_page_shows_the_scene_and_follows_the_user() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve(&[]);
    browser.open(&server.url);

    // A picture of the window's size comes, and at last the very pixels.
    browser.wait(OPEN);
    browser.wait(LOSSLESS);
    assert_eq!(browser.get("document.getElementById('picture').width === innerWidth"), true);
    let first = browser.get(PIXELS);

    // The picture follows the pointer, and the page knows how long that took.
    browser.drag([300, 200], [420, 260]);
    browser.wait(&format!("{PIXELS} !== {first}"));
    browser.wait(LOSSLESS);
    browser.wait("window.raywarp.stats.latency_ms.median > 0 && window.raywarp.stats.frames > 2");

    // The lines over it.
    browser.wait("document.getElementById('stat-scene').textContent.startsWith('scene.toml · 1 triangle')");
    browser.wait("/^[0-9.]+ ms/.test(document.getElementById('stat-frame').textContent)");
    browser.wait("/^[0-9]+ fps$/.test(document.getElementById('stat-fps').textContent)");
    browser.wait("document.getElementById('stat-device').textContent.includes('CPU')");

    // Help by its key, panel by its button, and both away.
    let shown = |id: &str| format!("document.getElementById('{id}').checkVisibility()");
    assert_eq!(browser.get(&shown("help")), false);
    browser.key("h");
    browser.wait(&shown("help"));
    assert!(browser.get("document.querySelectorAll('#help kbd').length").as_u64().unwrap() >= 2);
    browser.key("h");
    browser.wait(&format!("!{}", shown("help")));
    let panel = browser.get(&shown("panel"));
    browser.click("toggle-panel");
    browser.wait(&format!("{} !== {panel}", shown("panel")));

    // A file is downloaded.
    browser.key("\u{e03c}");
    browser.wait("window.raywarp.downloaded?.bytes > 100");
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn a_page_comes_back_after_the_server_has_been_away() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve(&[]);
    browser.open(&server.url);
    browser.wait(LOSSLESS);
    let (port, place) = (server.port(), server.kill());

    browser.wait("window.raywarp.connection === 'lost'");
    browser.wait("document.getElementById('connection').textContent.startsWith('Connection lost')");
    assert_eq!(browser.get("document.getElementById('picture').dataset.kind"), "png", "the picture stays");

    let server = serve_at(place, &port, &[]);
    let before = browser.get("window.raywarp.stats.frames");
    browser.wait(OPEN);
    browser.wait("!document.getElementById('connection').checkVisibility()");
    browser.wait(&format!("window.raywarp.stats.frames > {before}"));
    // And a page that is loaded anew is served as well.
    browser.open("about:blank");
    browser.open(&server.url);
    browser.wait(LOSSLESS);
}

#[test]
fn two_pages_look_at_once() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let (Some(one), Some(other)) = (Browser::start(), Browser::start()) else { return };
    let server = serve(&[]);
    for page in [&one, &other] {
        page.open(&server.url);
        page.wait(LOSSLESS);
    }
    one.wait("window.raywarp.link.viewers === 2");
    let (first, frame) = (one.get(PIXELS), other.get(FRAME));
    assert!(other.get(PIXELS) == first);
    one.wheel(-300);
    one.wait(&format!("{PIXELS} !== {first}"));
    assert!(other.get(PIXELS) == first && other.get(FRAME) == frame);
}

#[test]
fn a_wrong_token_is_asked_for_again() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve(&["--token=open-sesame"]);
    assert!(server.url.ends_with("/#token=open-sesame"), "{}", server.url);
    browser.open(&server.url.replace("open-sesame", "open-cesame"));
    browser.wait("document.getElementById('token-words').textContent.includes('token is missing or wrong')");
    browser.wait("document.activeElement.id === 'token'");
    browser.write("open-sesame\u{e007}");
    browser.wait(OPEN);
    browser.wait(LOSSLESS);
    assert_eq!(browser.get("document.getElementById('token-form').checkVisibility()"), false);
}
