//! The core in the hands of a test.
#![allow(dead_code, missing_docs)]

use std::sync::Arc;
use std::time::{Duration, Instant};

use raywarp::device::Device;
use raywarp::image::{png, Development};
use raywarp::render::{RenderOptions, Tracer};
use raywarp::scene::Camera;
use raywarp_viewer::live::{Button, Event, LiveScene, LiveSceneOptions, Modifiers, Outcome, Picture, Source, Viewer};

pub const SIZE: [u32; 2] = [96, 54];
pub const SPP: u32 = 4;

pub fn device() -> Device {
    let name = std::env::var("RAYWARP_TEST_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    Device::open(name.parse().expect("RAYWARP_TEST_DEVICE names a device")).expect("the device under test opens")
}

/// A viewer before a stage.
pub struct Session {
    pub live_scene: LiveScene,
    pub viewer: Viewer,
    start: Instant,
    shown: Vec<u8>,
}

impl Session {
    pub fn open(source: Source, mut options: LiveSceneOptions) -> Self {
        options.overrides.spp.get_or_insert(SPP);
        let live_scene = LiveScene::open(source, device(), options);
        let viewer = Viewer::new(SIZE);
        Self { live_scene, viewer, start: Instant::now(), shown: Vec::new() }
    }

    pub fn handle(&mut self, event: Event) -> Vec<Outcome> {
        self.viewer.handle(&mut self.live_scene, &event)
    }

    pub fn frame(&mut self) -> Option<Arc<Picture>> {
        let picture = self.viewer.frame(&mut self.live_scene, self.start.elapsed()).expect("the device works")?;
        self.shown.clone_from(&picture.rgba);
        Some(picture)
    }

    /// Pictures until one is settled.
    pub fn settle(&mut self) -> Vec<Arc<Picture>> {
        let (mut pictures, begin) = (Vec::new(), Instant::now());
        while !pictures.last().is_some_and(|picture: &Arc<Picture>| picture.settled) {
            assert!(
                begin.elapsed() < Duration::from_secs(60),
                "it never settles: {:?}",
                self.viewer.status(&self.live_scene)
            );
            match self.frame() {
                Some(picture) => pictures.push(picture),
                None => std::thread::sleep(Duration::from_millis(1)),
            }
        }
        pictures
    }

    pub fn key(&mut self, key: &str, down: bool) -> Vec<Outcome> {
        self.handle(Event::Key { key: key.to_owned(), down, modifiers: Modifiers::default() })
    }

    pub fn drag(&mut self, x: f32) {
        self.handle(Event::Pointer { x: 0.5, y: 0.5 });
        self.handle(left(true));
        self.handle(Event::Pointer { x, y: 0.5 });
    }

    pub fn drop_it(&mut self) {
        self.handle(left(false));
    }

    /// The pixels of the last picture.
    pub fn shown(&self) -> Vec<u8> {
        self.shown.clone()
    }
}

pub fn left(down: bool) -> Event {
    Event::Button { button: Button::Left, down, modifiers: Modifiers::default() }
}

pub fn pixels(tracer: &Tracer, camera: &Camera, options: &RenderOptions) -> Vec<u8> {
    developed(tracer, camera, options, &Development::default())
}

/// A picture as a screen shows it.
pub fn developed(tracer: &Tracer, camera: &Camera, options: &RenderOptions, development: &Development) -> Vec<u8> {
    let picture = tracer.render(camera, options, &mut |_| ()).unwrap().picture;
    png::tone_map(&picture, development).pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect()
}
