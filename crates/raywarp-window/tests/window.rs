//! The window as people have it: keys, a file, the close button. On an X server of its own without a
//! screen; where there is no Xvfb the tests of the window pass without running, unless RAYWARP_REQUIRE_DISPLAY is 1.
#![cfg(target_os = "linux")]

mod place;

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use place::{Place, SCENE};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{self, ConnectionExt as _, ImageFormat, InputFocus, Window};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

const SIZE: [u16; 2] = [320, 240];
/// Far more than a busy machine needs.
const PATIENCE: Duration = Duration::from_secs(60);

#[test]
fn without_a_display_a_sentence_says_what_to_do() {
    let place = Place::new();
    let mut command = place.command(&["--device", "cpu"]);
    let output = command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    for part in ["error: cannot open a window: there is no display", "raywarp serve SCENE", "raywarp render SCENE"] {
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn a_display_that_does_not_answer_is_an_error() {
    let place = Place::new();
    let mut command = place.command(&["--device", "cpu"]);
    let output = command.env("DISPLAY", ":64999").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("error: cannot open a window: ") && !said.contains("panicked"), "{said}");
    assert!(!said.contains(".rs"), "{said}");
}

#[test]
fn people_look_keep_a_picture_and_leave() {
    let Some(screen) = Screen::open() else { return };
    let place = Place::new();
    place.write("red.toml", SCENE);
    let mut shown = screen.view(&place, &["red.toml"]);
    shown.wait_until("the picture", |picture| picture.shows_the_scene());
    assert_eq!(shown.title(), "red.toml - raywarp");

    let before = shown.at_rest();
    shown.press('h');
    shown.wait_until("the help", |picture| picture != &before && picture.differs_much_from(&before));
    shown.press('h');
    shown.wait_until("no help", |picture| !picture.differs_much_from(&before));

    for name in ["raywarp.png", "raywarp-2.png"] {
        shown.press_key(F12);
        let start = Instant::now();
        while !place.path(name).is_file() && start.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(20));
        }
        let (width, height, pixels) = place::png(&place.path(name));
        assert_eq!([width, height], SIZE.map(u32::from), "{name}");
        assert!(pixels.iter().any(is_red), "{name}");
    }

    shown.close();
    let (status, said) = shown.end();
    assert_eq!(status.code(), Some(0), "{said}");
    assert_eq!(place.names(), ["raywarp-2.png", "raywarp.png", "red.toml"]);
}

/// A grid of so many squares each way: reading it and building its tree take a while.
fn grid(side: usize) -> String {
    let mut text: String = (0..=side).flat_map(|y| (0..=side).map(move |x| format!("v {x} {y} 0\n"))).collect();
    for y in 0..side {
        for x in 1..=side {
            let (a, b) = (y * (side + 1) + x, (y + 1) * (side + 1) + x);
            text += &format!("f {a} {} {} {b}\n", a + 1, b + 1);
        }
    }
    text
}

#[test]
fn it_ends_at_once_while_a_scene_is_read_its_tree_is_built_and_it_is_shown() {
    let Some(screen) = Screen::open() else { return };
    let place = Place::new();
    place.write("grid.obj", grid(700));
    for milliseconds in [50, 1000, 3000] {
        for (by_signal, code) in [(false, 0), (true, 130)] {
            let mut shown = screen.view(&place, &["grid.obj"]);
            std::thread::sleep(Duration::from_millis(milliseconds));
            let start = Instant::now();
            if by_signal {
                Command::new("kill").args(["-INT", &shown.program.id().to_string()]).status().unwrap();
            } else {
                shown.close();
            }
            let (status, said) = shown.end();
            let time = start.elapsed();
            eprintln!("after {milliseconds} ms, by a signal {by_signal}: {time:?}");
            assert_eq!(status.code(), Some(code), "{said}");
            // A fifth of a second, and what a busy machine adds.
            assert!(time < Duration::from_millis(900), "after {milliseconds} ms, by a signal {by_signal}: {time:?}");
        }
    }
}

#[test]
fn a_window_of_another_size_gets_a_picture_of_its_size() {
    let Some(screen) = Screen::open() else { return };
    let place = Place::new();
    place.write("red.toml", SCENE);
    let mut shown = screen.view(&place, &["red.toml"]);
    shown.wait_until("the picture", |picture| picture.shows_the_scene());
    for size in [[200u16, 300], [1, 1], [410, 90]] {
        let change = xproto::ConfigureWindowAux::new().width(u32::from(size[0])).height(u32::from(size[1]));
        shown.screen.x.configure_window(shown.window, &change).unwrap().check().unwrap();
        shown.wait_until("the new size", |picture| picture.size == size && picture.pixels.iter().any(|&p| p != [0; 3]));
    }
    shown.close();
    assert_eq!(shown.end().0.code(), Some(0));
}

#[test]
fn a_first_scene_that_fails_ends_the_program() {
    let Some(screen) = Screen::open() else { return };
    let place = Place::new();
    place.write("bad.toml", "version = 1\n[[meshes]]\nvertices = [[0,0");
    for (scene, sentence) in [("bad.toml", "error: bad.toml:3:"), ("gone.obj", "gone.obj")] {
        let output = screen.command(&place, &[scene]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(sentence) && !said.contains("panicked"), "{said}");
    }
}

const F12: u32 = 0xffc9;

fn is_red(pixel: &[u8; 3]) -> bool {
    pixel[0] > 150 && pixel[1] < 20 && pixel[2] < 20
}

/// An X server without a screen.
struct Screen {
    server: Child,
    name: String,
    x: RustConnection,
    root: Window,
}

impl Screen {
    /// Nothing where there is no such server, and none has to be.
    fn open() -> Option<Self> {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp", "-noreset"]);
        let mut server = match command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn() {
            Ok(server) => server,
            Err(error) => {
                let required = std::env::var("RAYWARP_REQUIRE_DISPLAY").is_ok_and(|value| value == "1");
                assert!(!required, "RAYWARP_REQUIRE_DISPLAY is 1, and Xvfb cannot be started: {error}");
                eprintln!("not run: Xvfb cannot be started: {error}");
                return None;
            }
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let name = format!(":{}", number.trim());
        let (x, screen) = x11rb::connect(Some(&name)).unwrap();
        let root = x.setup().roots[screen].root;
        Some(Self { server, name, x, root })
    }

    fn command(&self, place: &Place, arguments: &[&str]) -> Command {
        let size = format!("{}x{}", SIZE[0], SIZE[1]);
        let mut command = place.command(&[&["--device", "cpu", "--size", &size], arguments].concat());
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }

    fn view(&self, place: &Place, arguments: &[&str]) -> Shown<'_> {
        let mut program = self.command(place, arguments).spawn().unwrap();
        let start = Instant::now();
        loop {
            if let Some(window) = self.find() {
                self.x.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME).unwrap().check().unwrap();
                return Shown { screen: self, program, window };
            }
            if start.elapsed() > PATIENCE || program.try_wait().unwrap().is_some() {
                let _ = program.kill();
                let mut said = String::new();
                let _ = program.stderr.take().unwrap().read_to_string(&mut said);
                panic!("no window: {said}");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// A window that is shown and has a title.
    fn find(&self) -> Option<Window> {
        let children = self.x.query_tree(self.root).ok()?.reply().ok()?.children;
        children.into_iter().find(|&window| {
            let attributes = self.x.get_window_attributes(window).ok().and_then(|cookie| cookie.reply().ok());
            attributes.is_some_and(|it| it.map_state == xproto::MapState::VIEWABLE) && !self.title(window).is_empty()
        })
    }

    fn title(&self, window: Window) -> String {
        let name = self.atom("_NET_WM_NAME");
        let cookie = self.x.get_property(false, window, name, self.atom("UTF8_STRING"), 0, 256).unwrap();
        cookie.reply().map(|reply| String::from_utf8_lossy(&reply.value).into_owned()).unwrap_or_default()
    }

    fn atom(&self, name: &str) -> xproto::Atom {
        self.x.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The program with its window.
struct Shown<'a> {
    screen: &'a Screen,
    program: Child,
    window: Window,
}

impl Shown<'_> {
    fn title(&self) -> String {
        self.screen.title(self.window)
    }

    /// What the window shows.
    fn picture(&self) -> Picture {
        let x = &self.screen.x;
        let place = x.get_geometry(self.window).unwrap().reply().unwrap();
        let (w, h) = (place.width, place.height);
        let image = x.get_image(ImageFormat::Z_PIXMAP, self.window, 0, 0, w, h, !0).unwrap().reply();
        let bytes = image.map(|image| image.data).unwrap_or_default();
        Picture { size: [w, h], pixels: bytes.chunks_exact(4).map(|p| [p[2], p[1], p[0]]).collect() }
    }

    #[track_caller]
    fn wait_until(&mut self, what: &str, mut holds: impl FnMut(&Picture) -> bool) {
        let start = Instant::now();
        while !holds(&self.picture()) {
            let ended = self.program.try_wait().unwrap();
            assert!(ended.is_none() && start.elapsed() < PATIENCE, "{what} does not come; {ended:?}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// What the window shows once nothing of it changes any more.
    #[track_caller]
    fn at_rest(&mut self) -> Picture {
        let mut last = self.picture();
        let mut since = Instant::now();
        self.wait_until("rest", |picture| {
            if picture != &last {
                (last, since) = (picture.clone(), Instant::now());
            }
            since.elapsed() > Duration::from_secs(1)
        });
        last
    }

    /// Presses and releases the key of a letter.
    fn press(&self, letter: char) {
        self.press_key(u32::from(letter));
    }

    /// Presses and releases the key of a symbol.
    fn press_key(&self, symbol: u32) {
        let (x, setup) = (&self.screen.x, self.screen.x.setup());
        let (low, high) = (setup.min_keycode, setup.max_keycode);
        let map = x.get_keyboard_mapping(low, high - low + 1).unwrap().reply().unwrap();
        let a_key = usize::from(map.keysyms_per_keycode);
        let index = map.keysyms.chunks(a_key).position(|symbols| symbols.first() == Some(&symbol)).unwrap();
        for kind in [xproto::KEY_PRESS_EVENT, xproto::KEY_RELEASE_EVENT] {
            let fake = x.xtest_fake_input(kind, low + index as u8, 0, self.screen.root, 0, 0, 0);
            fake.unwrap().check().unwrap();
        }
    }

    /// What a window manager sends when its close button is clicked.
    fn close(&self) {
        let (x, window) = (&self.screen.x, self.window);
        let [protocols, delete] = ["WM_PROTOCOLS", "WM_DELETE_WINDOW"].map(|name| self.screen.atom(name));
        let message = xproto::ClientMessageEvent::new(32, window, protocols, [delete, 0, 0, 0, 0]);
        x.send_event(false, window, xproto::EventMask::NO_EVENT, message).unwrap().check().unwrap();
        x.sync().unwrap();
    }

    fn end(&mut self) -> (ExitStatus, String) {
        let start = Instant::now();
        while self.program.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < PATIENCE, "the program does not end");
            std::thread::sleep(Duration::from_millis(20));
        }
        let mut said = String::new();
        self.program.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        (self.program.wait().unwrap(), said)
    }
}

impl Drop for Shown<'_> {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// Pixels of a window.
#[derive(Clone, PartialEq)]
struct Picture {
    size: [u16; 2],
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// The red triangle before its green background.
    fn shows_the_scene(&self) -> bool {
        let share = |is: &dyn Fn(&[u8; 3]) -> bool| {
            self.pixels.iter().filter(|&pixel| is(pixel)).count() as f64 / self.pixels.len().max(1) as f64
        };
        share(&is_red) > 0.02 && share(&|&[r, g, b]| g > r && g > b && g > 100) > 0.2
    }

    /// In more than numbers that change by themselves.
    fn differs_much_from(&self, other: &Self) -> bool {
        let different = self.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count();
        self.size != other.size || different > self.pixels.len() / 40
    }
}
