//! What a person before `raywarp serve` gets: pictures a second and the time from an input to its picture, in a browser on
//! the machine that renders. A measurement, and no test; one line of JSON a scene:
//!
//!     cargo test --release -p raywarp-cli --test sessions served -- --ignored --nocapture
//!
//! `RAYWARP_MEASURE` names scene files, with commas (none: the built-in scene), `RAYWARP_TEST_DEVICE` the device,
//! `RAYWARP_MEASURE_SIZE` the size of the page as 1920x1080.

use std::time::Duration;

use crate::common::browser::Browser;
use crate::common::server::Server;
use crate::common::Place;
use serde_json::{json, Value};

/// A drag in circles for some seconds, 125 steps a second, as a mouse makes them.
const DRAG: &str = r#"((seconds) => {
  const canvas = document.getElementById("picture");
  const box = canvas.getBoundingClientRect();
  const fire = (type, buttons, angle) =>
    canvas.dispatchEvent(new PointerEvent(type, {
      pointerId: 1, pointerType: "mouse", button: type === "pointermove" ? -1 : 0, buttons, bubbles: true,
      cancelable: true, clientX: box.left + box.width * (0.5 + 0.2 * Math.sin(angle)),
      clientY: box.top + box.height * (0.5 + 0.05 * Math.cos(angle)),
    }));
  const { raywarp } = window;
  raywarp.measured = null;
  fire("pointerdown", 1, 0);
  const start = performance.now();
  // The first second finds the size and the quality.
  let since = null;
  // How often the browser shows anything: without a GPU it does not always reach 60 times a second.
  let shown = 0;
  const count = () => {
    shown += 1;
    if (!raywarp.measured) requestAnimationFrame(count);
  };
  requestAnimationFrame(count);
  const timer = setInterval(() => {
    const now = performance.now();
    const passed = (now - start) / 1000;
    fire("pointermove", 1, 1.5 * passed);
    if (since === null && passed > 1) {
      raywarp.resetStats();
      since = { now, shown, frames: raywarp.stats.frames };
    }
    if (passed < 1 + seconds) return;
    clearInterval(timer);
    const { frames, latency_ms, bits_per_s } = raywarp.stats;
    const rate = (count) => (count * 1000) / (now - since.now);
    const pictures_per_s = rate(frames - since.frames);
    const screen_per_s = rate(shown - since.shown);
    raywarp.measured = { pictures_per_s, screen_per_s, latency_ms, bits_per_s, status: raywarp.status, link: raywarp.link };
    fire("pointerup", 0, 1.5 * passed);
  }, 8);
  return true;
})(10)"#;

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

fn size() -> [i64; 2] {
    let text = variable("RAYWARP_MEASURE_SIZE").unwrap_or_else(|| "1920x1080".to_owned());
    let (width, height) = text.split_once('x').expect("RAYWARP_MEASURE_SIZE is as 1920x1080");
    [width, height].map(|side| side.parse().expect("RAYWARP_MEASURE_SIZE is as 1920x1080"))
}

#[test]
#[ignore = "a measurement"]
fn a_drag_in_a_browser() {
    let device = variable("RAYWARP_TEST_DEVICE").unwrap_or_else(|| "cpu".to_owned());
    let scenes = variable("RAYWARP_MEASURE").unwrap_or_default();
    for scene in scenes.split(',') {
        let words: Vec<&str> = Some(scene).filter(|scene| !scene.is_empty()).into_iter().collect();
        let server = Server::at(Place::new(), "0", &[&words[..], &["--device", &device]].concat());
        let Some(browser) = Browser::start() else { return };
        let viewport = browser.resize(size());
        browser.open(&server.url);
        browser.wait("window.raywarp?.status && !raywarp.status.busy && raywarp.status.triangles > 0");
        // Clocks go up, kernels are compiled, the first pictures are sent.
        std::thread::sleep(Duration::from_secs(2));
        browser.get(DRAG);
        std::thread::sleep(Duration::from_secs(11));
        browser.wait("window.raywarp.measured");
        println!("{}", row(scene, viewport, &browser.get("window.raywarp.measured")));
    }
}

fn row(scene: &str, viewport: Value, measured: &Value) -> Value {
    let (status, link) = (&measured["status"], &measured["link"]);
    json!({
        "scene": if scene.is_empty() { "built-in" } else { scene.rsplit('/').next().unwrap_or(scene) },
        "device": status["device"],
        "accel": status["accel"],
        "page": viewport,
        "picture": status["size"],
        "traced": status["traced"],
        "pictures_per_s": measured["pictures_per_s"],
        "screen_per_s": measured["screen_per_s"],
        "latency_ms": measured["latency_ms"],
        "mbit_per_s": measured["bits_per_s"].as_f64().map(|bits| bits * 1e-6),
        "jpeg_quality": link["quality"],
        "frame_ms": status["frame_ms"],
        "kernel_ms": status["kernel_ms"],
    })
}
