//! One client on the render thread: its viewer, and what it has been sent.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;

use super::client::Client;
use super::encoder::{submit, Job};
use super::outbox::File;
use super::protocol::{scaled, size_within_limits, FromServer, Kind, Link};
use super::stripes::Coding;
use crate::live::{Event, Outcome, Panel, Picture, Stage, Viewer};
use crate::ViewerError;

/// Shortest time between two pictures: no screen shows more.
const SHORTEST: Duration = Duration::from_millis(6);
/// Without input for so long, the picture is wanted at full size, and without loss once it is done.
const REST: Duration = Duration::from_millis(250);
/// Between two states that are told; sooner after a key or a click, as somebody waits for it.
const TELLING: Duration = Duration::from_millis(125);
const TELLING_SOON: Duration = Duration::from_millis(50);

/// A client's place.
pub struct Seat {
    client: Arc<Client>,
    viewer: Viewer,
    size: Size,
    /// The last input that may have moved something.
    moved: Option<Instant>,
    mark: u32,
    frame: u32,
    begun: Option<Instant>,
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
    status: String,
    panel: Option<Panel>,
}

impl Seat {
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
    pub fn take_input(&mut self, stage: &mut Stage) {
        let taken = self.client.take();
        for event in taken.events {
            self.follow(&event);
            self.told.soon |= !matches!(event, Event::Pointer { .. } | Event::Wheel { .. } | Event::Resize { .. });
            match event {
                Event::Resize { width, height } => self.size.asked = size_within_limits([width, height]),
                event => {
                    let outcomes = self.viewer.handle(stage, &event);
                    outcomes.into_iter().for_each(|outcome| self.carry_out(outcome));
                }
            }
        }
        self.mark = taken.mark.unwrap_or(self.mark);
        self.fit(stage);
    }

    /// Fewer pixels for a client that cannot keep up, while something moves.
    fn fit(&mut self, stage: &mut Stage) {
        let scale = if self.is_at_rest() { 1.0 } else { self.client.setting().scale };
        let [width, height] = if scale < 1.0 { scaled(self.size.asked, scale) } else { self.size.asked };
        if self.size.given != [width, height] {
            self.size.given = [width, height];
            self.viewer.handle(stage, &Event::Resize { width, height });
        }
    }

    fn carry_out(&self, outcome: Outcome) {
        match outcome {
            Outcome::File { name, content, media_type } => {
                let head = FromServer::File { name: &name, media_type, bytes: content.len() }.text();
                let content = Bytes::from([&[Kind::File as u8], content.as_slice()].concat());
                self.client.outbox.file(File { head, content });
            }
            Outcome::Copy(text) => self.client.outbox.copy(FromServer::Copy { text: &text }.text()),
            // A page cannot close itself, and the server is not one viewer's to end.
            Outcome::Quit => {}
        }
    }

    /// Makes a picture, or sends the last one without loss, if there is something to show and the client is ready for
    /// it. Whether anything was done.
    pub fn step(&mut self, stage: &mut Stage, now: Duration) -> Result<bool, ViewerError> {
        if self.begun.is_some_and(|begun| begun.elapsed() < SHORTEST) {
            return Ok(false);
        }
        if self.viewer.wants_frame(stage) {
            return if self.client.is_ready() { self.render(stage, now) } else { Ok(false) };
        }
        let is_due = self.owed.is_some() && self.is_at_rest() && self.client.is_idle();
        let Some(picture) = self.owed.take_if(|_| is_due) else { return Ok(false) };
        let frame = self.depart(true);
        submit(&self.client, Job { picture, coding: Coding::Lossless, frame, mark: self.mark });
        Ok(true)
    }

    fn render(&mut self, stage: &mut Stage, now: Duration) -> Result<bool, ViewerError> {
        let Some(picture) = self.viewer.frame(stage, now)? else { return Ok(false) };
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

    /// Tells status and panel where they have changed, a few times a second.
    pub fn tell(&mut self, stage: &Stage, viewers: usize) {
        let pause = if self.told.soon { TELLING_SOON } else { TELLING };
        if self.told.at.is_some_and(|at| at.elapsed() < pause) {
            return;
        }
        (self.told.at, self.told.soon) = (Some(Instant::now()), false);
        let setting = self.client.setting();
        let link = Link {
            quality: setting.jpeg,
            scale: setting.scale,
            lag_ms: setting.lag_ms,
            ping_ms: setting.ping_ms,
            viewers,
        };
        let status = FromServer::Status { status: &self.viewer.status(stage), link }.text();
        if status != self.told.status {
            self.client.outbox.status(status.clone());
            self.told.status = status;
        }
        let panel = self.viewer.panel(stage);
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
