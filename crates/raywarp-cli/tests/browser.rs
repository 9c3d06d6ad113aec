//! `raywarp serve` and its page in a real browser. Where there is none, these tests say so and pass.

use std::sync::{Mutex, PoisonError};

use crate::common::browser::Browser;
use crate::common::server::Server;
use crate::common::{Place, SCENE};

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

/// A server whose secret has all that an address cannot hold as it is.
fn serve_secret(secret: &str) -> Server {
    let place = Place::new();
    place.write("scene.toml", SCENE);
    place.write("secret", format!("{secret}\n"));
    serve_at(place, "0", &["--token-file", "secret"])
}

const ASKED: &str = "document.getElementById('token-words').textContent.includes('token is missing or wrong') && \
                     document.activeElement.id === 'token'";

#[test]
fn a_wrong_token_is_asked_for_again() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve_secret("open + sesame = 100 % ü");
    let (plain, _) = server.url.split_once("#ticket=").unwrap();
    browser.open(&format!("{plain}#token=open-cesame"));
    browser.wait(ASKED);
    browser.write("open + sesame = 100 % ü\u{e007}");
    browser.wait(OPEN);
    browser.wait(LOSSLESS);
    assert_eq!(browser.get("document.getElementById('token-form').checkVisibility()"), false);
}

#[test]
fn the_secret_does_not_stay_in_the_address() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let (server, other) = (serve_secret("a secret of one & only"), serve_secret("another-secret"));
    let plain = |server: &Server| server.url.split_once("#ticket=").unwrap().0.to_owned();
    browser.open(&server.url);
    browser.wait(OPEN);
    assert_eq!(browser.get("location.href"), plain(&server));
    assert_eq!(browser.get("document.cookie"), "");
    // The tab knows it still: loaded anew, and by the address alone.
    browser.reload();
    browser.wait(OPEN);
    browser.open("about:blank");
    browser.open(&plain(&server));
    browser.wait(OPEN);
    // A server at another port neither gets it nor takes it away.
    browser.open(&plain(&other));
    browser.wait(ASKED);
    browser.get(&format!("location.assign('{}')", other.url));
    browser.wait(OPEN);
    assert_eq!(browser.get("location.href"), plain(&other), "an address that differs behind the # is read as well");
    browser.open(&plain(&server));
    browser.wait(OPEN);
    // Who is given the address as it stands in the bar has to know the secret.
    let copied = browser.get("location.href");
    browser.window();
    browser.open(copied.as_str().unwrap());
    browser.wait(ASKED);
    // And who finds the printed address in the history has a ticket that was used.
    browser.open("about:blank");
    browser.open(&server.url);
    browser.wait(ASKED);
    assert_eq!(browser.get("JSON.stringify(sessionStorage)"), "{}");
    browser.write("a secret of one & only\u{e007}");
    browser.wait(OPEN);
}

#[test]
fn twelve_pages_at_once_have_a_picture() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve(&[]);
    let open = format!("open('{}', '_blank', 'popup,width=320,height=240')", server.url);
    browser.get(&format!("Array.from({{length: 12}}, () => {open}).length"));
    let pages: Vec<String> = browser.windows().into_iter().skip(1).collect();
    assert_eq!(pages.len(), 12);
    let mut times = Vec::new();
    for page in &pages {
        browser.switch(page);
        browser.wait("window.raywarp?.first_picture_ms > 0");
        times.push(browser.get("Math.round(window.raywarp.first_picture_ms)").as_u64().unwrap());
    }
    eprintln!("milliseconds from the opening of each page to its first picture: {times:?}");
    browser.wait("window.raywarp.link.viewers === 12");
}

/// Whether two cards cover each other or the picture, or one leaves the window: their names.
const COVERED: &str = "(() => {
  const shown = [...document.querySelectorAll('.card, #bar, #picture')].filter((card) => card.checkVisibility());
  const boxes = shown.map((card) => ({ id: card.id, box: card.getBoundingClientRect() }));
  const outside = boxes.filter(({ box }) => box.left < 0 || box.top < 0 || box.right > innerWidth || box.bottom > innerHeight);
  const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  const pairs = boxes.flatMap((one, i) => boxes.slice(i + 1).filter((other) => meet(one.box, other.box))
    .map((other) => `${one.id} and ${other.id}`));
  return [...outside.map(({ id }) => id), ...pairs];
})()";

#[test]
fn cards_of_a_small_window_fold_and_cover_neither_each_other_nor_the_picture() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve(&[]);
    browser.open(&server.url);
    browser.wait(LOSSLESS);
    for size in [[320, 480], [499, 700], [400, 300], [700, 330]] {
        browser.emulate(size);
        browser.wait(&format!("innerWidth === {} && innerHeight === {}", size[0], size[1]));
        browser.wait("document.getElementById('picture').getBoundingClientRect().height >= 0.45 * innerHeight");
        for card in ["status", "panel", "help"] {
            let shown = format!("document.getElementById('{card}').checkVisibility()");
            if browser.get(&shown) != true {
                browser.click(&format!("toggle-{card}"));
            }
            browser.wait(&shown);
            assert_eq!(browser.get(COVERED), serde_json::json!([]), "{size:?} {card}");
            browser.picture(&format!("small-{}x{}-{card}", size[0], size[1]));
        }
    }
}

#[test]
fn the_panel_stands_beside_the_picture_and_folds_in_a_small_window() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve(&[]);
    browser.emulate([900, 600]);
    browser.open(&server.url);
    browser.wait(LOSSLESS);
    browser.click("toggle-panel");
    let beside = "document.getElementById('picture').getBoundingClientRect().right <= \
                  document.getElementById('panel').getBoundingClientRect().left";
    browser.wait(beside);
    // The picture is made for the room that it has.
    browser
        .wait("document.getElementById('picture').width === 540 && document.getElementById('picture').height === 600");
    browser.wait(LOSSLESS);
    browser.picture("panel");
    let open = "document.getElementById('panel').checkVisibility()";
    for (width, shown) in [(500, false), (900, true)] {
        browser.emulate([width, 600]);
        browser.wait(&format!("{open} === {shown}"));
    }
}

#[test]
fn the_picked_object_has_an_outline_and_a_drag_can_look_around() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(browser) = Browser::start() else { return };
    let server = serve(&[]);
    browser.open(&server.url);
    browser.wait(LOSSLESS);
    let first = browser.get(PIXELS);
    browser.drag([400, 330], [400, 330]);
    browser.wait("document.getElementById('pick').textContent.includes('triangle')");
    browser.wait(&format!("{PIXELS} !== {first} && {LOSSLESS}"));
    browser.picture("picked");
    browser.key("\u{e00c}");
    browser.wait(&format!("{PIXELS} === {first}"));
    browser.key("j");
    browser.click("toggle-panel");
    browser.wait("document.querySelector('[data-row=\"camera.turns\"]')?.dataset.value === '\"look around\"'");
    let eye = "document.querySelector('[data-row=\"camera.eye\"]').dataset.value";
    let target = "document.querySelector('[data-row=\"camera.target\"]').dataset.value";
    let (stands, looked) = (browser.get(eye), browser.get(target));
    browser.drag([200, 300], [240, 320]);
    browser.wait(&format!("{target} !== '{}'", looked.as_str().unwrap()));
    assert_eq!(browser.get(eye), stands);
}
