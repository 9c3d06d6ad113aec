//! A Chromium without a window, by the WebDriver protocol of its chromedriver.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine;
use serde_json::{json, Value};

const CHROMIUM: [&str; 2] = ["/usr/bin/chromium", "/usr/bin/google-chrome"];
const DRIVER: &str = "/usr/bin/chromedriver";
const FLAGS: [&str; 10] = [
    "--headless=new",
    "--no-sandbox",
    // Containers give it 64 MB.
    "--disable-dev-shm-usage",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=800,600",
];
/// As long as any wait may take on a busy machine.
const LONG: Duration = Duration::from_secs(60);

/// A browser with one page.
pub struct Browser {
    agent: ureq::Agent,
    driver: Child,
    address: String,
    session: String,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// None, with a word about it, where no browser is installed and none is demanded.
    pub fn start() -> Option<Self> {
        let named = |name: &str| std::env::var(name).ok();
        let chromium = named("RAYWARP_CHROMIUM")
            .or_else(|| CHROMIUM.into_iter().find(|path| Path::new(path).exists()).map(str::to_owned));
        let driver = named("RAYWARP_CHROMEDRIVER").unwrap_or_else(|| DRIVER.to_owned());
        let (Some(chromium), true) = (chromium, Path::new(&driver).exists()) else {
            let demanded = std::env::var_os("RAYWARP_REQUIRE_BROWSER").is_some_and(|value| value == "1");
            assert!(!demanded, "RAYWARP_REQUIRE_BROWSER=1, and there is no Chromium with {DRIVER}");
            eprintln!("skipped: there is no Chromium with {DRIVER}");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let mut driver = Command::new(driver).arg("--port=0").stdout(Stdio::piped()).spawn().unwrap();
        let mut browser = Self {
            agent: ureq::Agent::new_with_config(ureq::Agent::config_builder().http_status_as_error(false).build()),
            address: format!("http://127.0.0.1:{}", port(&mut driver)),
            driver,
            session: String::new(),
            _profile: profile,
        };
        let folder = format!("--user-data-dir={}", browser._profile.path().display());
        let arguments: Vec<_> = FLAGS.into_iter().chain([folder.as_str()]).collect();
        let wanted = json!({"browserName": "chrome", "goog:loggingPrefs": {"browser": "ALL"},
            "goog:chromeOptions": {"binary": chromium, "args": arguments}});
        let session = browser.post("/session", &json!({"capabilities": {"alwaysMatch": wanted}}));
        browser.session = format!("/session/{}", session["sessionId"].as_str().unwrap());
        Some(browser)
    }

    fn post(&self, path: &str, body: &Value) -> Value {
        let request = self.agent.post(format!("{}{path}", self.address)).content_type("application/json");
        let text = request.send(body.to_string()).unwrap().body_mut().read_to_string().unwrap();
        let answer: Value = serde_json::from_str(&text).unwrap();
        assert!(answer["value"]["error"].is_null(), "{path}: {answer}");
        answer["value"].clone()
    }

    fn command(&self, name: &str, body: &Value) -> Value {
        self.post(&format!("{}/{name}", self.session), body)
    }

    /// Gives the page so many pixels, about; returns how many it has.
    pub fn resize(&self, [width, height]: [i64; 2]) -> Value {
        self.command("window/rect", &json!({"width": width, "height": height}));
        // The window has a frame, even where nobody sees it.
        let lacks = self.get("[outerWidth - innerWidth, outerHeight - innerHeight]");
        let outer = [width, height].into_iter().zip([0, 1]).map(|(side, i)| side + lacks[i].as_i64().unwrap_or(0));
        let outer: Vec<i64> = outer.collect();
        self.command("window/rect", &json!({"width": outer[0], "height": outer[1]}));
        self.get("[innerWidth, innerHeight]")
    }

    pub fn open(&self, url: &str) {
        self.command("url", &json!({"url": url}));
    }

    pub fn reload(&self) {
        self.command("refresh", &json!({}));
    }

    /// Pretends to a window of so many pixels, smaller ones than there are too.
    pub fn emulate(&self, [width, height]: [i64; 2]) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.command("goog/cdp/execute", &json!({"cmd": "Emulation.setDeviceMetricsOverride", "params": metrics}));
    }

    /// A window of its own, empty, that all further commands are for.
    pub fn window(&self) {
        let made = self.command("window/new", &json!({"type": "window"}));
        self.switch(made["handle"].as_str().unwrap());
    }

    /// All windows, by the names that [`switch`](Self::switch) takes.
    pub fn windows(&self) -> Vec<String> {
        let path = format!("{}{}/window/handles", self.address, self.session);
        let text = self.agent.get(path).call().unwrap().body_mut().read_to_string().unwrap();
        let answer: Value = serde_json::from_str(&text).unwrap();
        let names = answer["value"].as_array().unwrap().iter();
        names.map(|name| name.as_str().unwrap().to_owned()).collect()
    }

    pub fn switch(&self, window: &str) {
        self.command("window", &json!({"handle": window}));
    }

    /// What an expression of JavaScript gives on the page.
    pub fn get(&self, expression: &str) -> Value {
        self.command("execute/sync", &json!({"script": format!("return {expression};"), "args": []}))
    }

    /// Waits until an expression is true.
    #[track_caller]
    pub fn wait(&self, expression: &str) {
        let start = Instant::now();
        while self.get(&format!("!!({expression})")) != true {
            let state = "[document.body.innerText, JSON.stringify(window.raywarp)]";
            assert!(start.elapsed() < LONG, "{expression} is never true: {}", self.get(state));
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    pub fn key(&self, key: &str) {
        let actions = json!([{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]);
        self.command("actions", &json!({"actions": [{"type": "key", "id": "keys", "actions": actions}]}));
    }

    pub fn write(&self, text: &str) {
        text.chars().for_each(|key| self.key(&key.to_string()));
    }

    pub fn click(&self, id: &str) {
        self.get(&format!("document.getElementById('{id}').click()"));
    }

    /// Presses a button of the mouse, goes there in some steps, and lets it go.
    pub fn drag(&self, from: [i32; 2], to: [i32; 2]) {
        let go = |x: i32, y: i32, duration: u32| json!({"type": "pointerMove", "x": x, "y": y, "duration": duration});
        let actions = json!([
            go(from[0], from[1], 0),
            {"type": "pointerDown", "button": 0},
            go((from[0] + to[0]) / 2, (from[1] + to[1]) / 2, 100),
            go(to[0], to[1], 100),
            {"type": "pointerUp", "button": 0},
        ]);
        let mouse =
            json!({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions});
        self.command("actions", &json!({"actions": [mouse]}));
    }

    pub fn wheel(&self, pixels: i32) {
        let scroll = json!({"type": "scroll", "x": 300, "y": 200, "deltaX": 0, "deltaY": pixels});
        self.command("actions", &json!({"actions": [{"type": "wheel", "id": "wheel", "actions": [scroll]}]}));
    }

    /// Keeps a picture of the page for people to look at, where RAYWARP_TEST_PICTURES names a folder.
    pub fn picture(&self, name: &str) {
        let Some(folder) = std::env::var_os("RAYWARP_TEST_PICTURES") else { return };
        let path = format!("{}{}/screenshot", self.address, self.session);
        let text =
            self.agent.get(path).call().unwrap().body_mut().with_config().limit(64 << 20).read_to_string().unwrap();
        let answer: Value = serde_json::from_str(&text).unwrap();
        let bytes = base64::prelude::BASE64_STANDARD.decode(answer["value"].as_str().unwrap()).unwrap();
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes).unwrap();
    }

    /// What the page complained about, without connections that were refused.
    pub fn complaints(&self) -> Vec<String> {
        let log = self.command("se/log", &json!({"type": "browser"}));
        let lines = log.as_array().into_iter().flatten().map(|entry| entry["message"].to_string());
        lines.filter(|line| !line.contains("WebSocket connection")).collect()
    }
}

/// The port that a driver says it has.
fn port(driver: &mut Child) -> String {
    let lines = BufReader::new(driver.stdout.take().unwrap()).lines();
    let said = lines.map_while(Result::ok).find_map(|line| {
        let port = line.split_once("started successfully on port ")?.1;
        Some(port.trim_end_matches('.').to_owned())
    });
    said.expect("chromedriver says no port")
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() {
            let _ = self.agent.delete(format!("{}{}", self.address, self.session)).call();
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
