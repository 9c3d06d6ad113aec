//! One client on the render thread: its viewer, and what it has been sent.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::client::Client;
use super::encoder::{submit, Job};
use super::files::Files;
use super::protocol::{scaled, size_within_limits, FromServer, Link};
use super::quality::Setting;
use super::stripes::Coding;
use crate::live::{Event, LiveScene, LiveSceneVersion, Outcome, Panel, Picture, Viewer};
use crate::ViewerError;

/// Shortest time between two pictures: no screen shows more.
const SHORTEST: Duration = Duration::from_millis(6);
/// Without input for so long, the picture is wanted at full size, and without loss once it is done.
const REST: Duration = Duration::from_millis(250);
/// Between two states that are told; sooner after a key or a click, as somebody waits for it.
const TELLING: Duration = Duration::from_millis(125);
const TELLING_SOON: Duration = Duration::from_millis(50);

/// What a picture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// Somebody moves something.
    Motion,
    /// More samples of what is there.
    Refinement,
}

/// What the render thread knows of one client.
pub struct Session {
    client: Arc<Client>,
    viewer: Viewer,
    size: Size,
    /// The last input that may have moved something.
    moved: Option<Instant>,
    mark: u32,
    frame: u32,
    begun: Option<Instant>,
    /// Time of the render thread that its pictures took.
    had: Duration,
    /// The last picture if it was settled and has not been sent without loss.
    owed: Option<Arc<Picture>>,
    told: Told,
}

/// Pixels that the page has room for, and those that the viewer makes.
struct Size {
    asked: [u32; 2],
    given: [u32; 2],
}

#[derive(Default)]
struct Told {
    at: Option<Instant>,
    soon: bool,
    /// Whether the viewer may have something new to tell.
    stale: bool,
    /// What else the telling depends on, as it was.
    news: Option<News>,
    status: String,
    panel: Option<Panel>,
}

/// What is told that does not come from the client's own viewer.
#[derive(Clone, Debug, PartialEq)]
struct News {
    live_scene: LiveSceneVersion,
    setting: Setting,
    viewers: usize,
}

impl Session {
    pub fn new(client: Arc<Client>) -> Self {
        let size = size_within_limits(client.size);
        Self {
            viewer: Viewer::new(size),
            client,
            size: Size { asked: size, given: size },
            moved: None,
            mark: 0,
            frame: 0,
            begun: None,
            had: Duration::ZERO,
            owed: None,
            told: Told::default(),
        }
    }

    pub fn is_gone(&self) -> bool {
        self.client.is_gone()
    }

    /// Sends the client away, with the reason, as its picture cannot be made.
    pub fn refuse(&self, error: &ViewerError) -> bool {
        self.client.outbox.fail(error.to_string());
        self.client.leave();
        true
    }

    /// Hands all input to the viewer.
    pub fn take_input(&mut self, live_scene: &mut LiveScene, files: &Files) {
        let taken = self.client.take();
        if let Some(why) = self.client.take_file_failure() {
            self.viewer.export_failed(why);
            self.told.stale = true;
        }
        self.told.stale |= !taken.events.is_empty();
        for event in taken.events {
            self.follow(&event);
            self.told.soon |= !matches!(event, Event::Pointer { .. } | Event::Wheel { .. } | Event::Resize { .. });
            match event {
                Event::Resize { width, height } => self.size.asked = size_within_limits([width, height]),
                event => {
                    let outcomes = self.viewer.handle(live_scene, &event);
                    outcomes.into_iter().for_each(|outcome| self.carry_out(outcome, files));
                }
            }
        }
        self.mark = taken.mark.unwrap_or(self.mark);
        self.fit(live_scene);
    }

    /// Fewer pixels for a client that cannot keep up, while something moves.
    fn fit(&mut self, live_scene: &mut LiveScene) {
        let scale = if self.is_at_rest() { 1.0 } else { self.client.setting().scale };
        let [width, height] = if scale < 1.0 { scaled(self.size.asked, scale) } else { self.size.asked };
        if self.size.given != [width, height] {
            self.size.given = [width, height];
            self.viewer.handle(live_scene, &Event::Resize { width, height });
        }
    }

    fn carry_out(&self, outcome: Outcome, files: &Files) {
        match outcome {
            Outcome::File(export) => files.order(&self.client, export),
            Outcome::Copy(text) => self.client.outbox.copy(FromServer::Copy { text: &text }.text()),
            // A page cannot close itself, and the server is not one viewer's to end.
            Outcome::Quit => {}
        }
    }

    /// Whether there is something to show and the client is ready for it.
    pub fn is_due(&self, live_scene: &LiveScene) -> bool {
        if self.begun.is_some_and(|begun| begun.elapsed() < SHORTEST) {
            return false;
        }
        if self.viewer.wants_frame(live_scene) {
            return self.client.is_ready();
        }
        self.owed.is_some() && self.is_at_rest() && self.client.is_idle()
    }

    pub fn urgency(&self) -> Urgency {
        if self.is_at_rest() {
            Urgency::Refinement
        } else {
            Urgency::Motion
        }
    }

    /// Whether there has been a picture.
    pub fn has_shown(&self) -> bool {
        self.frame > 0
    }

    /// Time of the render thread that it has had, at least as much as is said: what was not used is not saved up.
    pub fn had(&self, least: Duration) -> Duration {
        self.had.max(least)
    }

    pub fn charge(&mut self, had: Duration) {
        self.had = had;
    }

    /// Makes a picture, or sends the last one without loss. Whether anything was done.
    pub fn step(&mut self, live_scene: &mut LiveScene, now: Duration) -> Result<bool, ViewerError> {
        let worked =
            if self.viewer.wants_frame(live_scene) { self.render(live_scene, now)? } else { self.send_lossless() };
        self.told.stale |= worked;
        Ok(worked)
    }

    fn send_lossless(&mut self) -> bool {
        let Some(picture) = self.owed.take() else { return false };
        let frame = self.depart(true);
        submit(&self.client, Job { picture, coding: Coding::Lossless, frame, mark: self.mark });
        true
    }

    fn render(&mut self, live_scene: &mut LiveScene, now: Duration) -> Result<bool, ViewerError> {
        let Some(picture) = self.viewer.frame(live_scene, now)? else { return Ok(false) };
        let frame = self.depart(false);
        self.owed = picture.settled.then(|| Arc::clone(&picture));
        let quality = self.client.setting().jpeg;
        submit(&self.client, Job { picture, coding: Coding::Lossy { quality }, frame, mark: self.mark });
        Ok(true)
    }

    fn depart(&mut self, lossless: bool) -> u32 {
        self.frame = self.frame.wrapping_add(1);
        self.begun = Some(Instant::now());
        self.client.depart(self.frame, lossless);
        self.frame
    }

    /// Tells status and panel where they have changed, a few times a second. A page where nothing happens costs nothing.
    pub fn tell(&mut self, live_scene: &LiveScene, viewers: usize) {
        let pause = if self.told.soon { TELLING_SOON } else { TELLING };
        if self.told.at.is_some_and(|at| at.elapsed() < pause) {
            return;
        }
        let news = Some(News { live_scene: live_scene.version(), setting: self.client.setting(), viewers });
        if !self.told.stale && self.told.news == news {
            return;
        }
        (self.told.at, self.told.soon, self.told.stale, self.told.news) = (Some(Instant::now()), false, false, news);
        self.tell_now(live_scene, viewers);
    }

    fn tell_now(&mut self, live_scene: &LiveScene, viewers: usize) {
        let setting = self.client.setting();
        let link = Link {
            quality: setting.jpeg,
            scale: setting.scale,
            lag_ms: setting.lag_ms,
            ping_ms: setting.ping_ms,
            viewers,
        };
        let status = FromServer::Status { status: &self.viewer.status(live_scene), link }.text();
        if status != self.told.status {
            self.client.outbox.status(status.clone());
            self.told.status = status;
        }
        let panel = self.viewer.panel(live_scene);
        if self.told.panel.as_ref() != Some(&panel) {
            self.client.outbox.panel(FromServer::Panel { panel: &panel }.text());
            self.told.panel = Some(panel);
        }
    }

    fn follow(&mut self, event: &Event) {
        let passes_by = matches!(event, Event::Pointer { .. }) && !self.viewer.is_moving();
        if !passes_by && !matches!(event, Event::Resize { .. }) {
            self.moved = Some(Instant::now());
        }
    }

    fn is_at_rest(&self) -> bool {
        !self.viewer.is_moving() && self.moved.is_none_or(|moved| moved.elapsed() > REST)
    }
}
