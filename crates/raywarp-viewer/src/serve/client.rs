//! One client, as its socket and the render thread both see it.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::Mutex;
use std::time::Duration;

use tokio::sync::Notify;

use super::encoder::Encoder;
use super::inbox::{Inbox, Taken};
use super::outbox::Outbox;
use super::pace::Pace;
use super::quality::{Quality, Setting};
use super::registry::lock;
use crate::live::Event;

/// What the two sides share. Nothing in it grows: input waits for room, and of output only the latest is kept.
#[derive(Debug)]
pub struct Client {
    /// Of the picture at first.
    pub size: [u32; 2],
    pub outbox: Outbox,
    pub encoder: Encoder,
    inbox: Mutex<Inbox>,
    room: Notify,
    flow: Mutex<Flow>,
    /// Why the last file could not be made, until the render thread tells.
    failure: Mutex<Option<String>>,
    arrived: Notify,
    newest: AtomicU32,
    visible: AtomicBool,
    gone: AtomicBool,
}

#[derive(Debug, Default)]
struct Flow {
    pace: Pace,
    quality: Quality,
}

impl Client {
    pub fn new(size: [u32; 2]) -> Self {
        Self {
            outbox: Outbox::default(),
            size,
            encoder: Encoder::default(),
            inbox: Mutex::default(),
            room: Notify::new(),
            flow: Mutex::default(),
            failure: Mutex::default(),
            arrived: Notify::new(),
            newest: AtomicU32::new(0),
            visible: AtomicBool::new(true),
            gone: AtomicBool::new(false),
        }
    }

    /// Takes input; waits while too much of it is waiting, so that a flood waits in the network.
    pub async fn input(&self, event: Event) {
        while lock(&self.inbox).is_full() {
            self.room.notified().await;
        }
        lock(&self.inbox).push(event);
    }

    /// The client wants to know which picture is the first after this.
    pub fn mark(&self, mark: u32) {
        lock(&self.inbox).mark(mark);
    }

    /// All input so far.
    pub fn take(&self) -> Taken {
        let taken = lock(&self.inbox).take();
        self.room.notify_one();
        taken
    }

    /// Whether another picture may leave.
    pub fn is_ready(&self) -> bool {
        let flow = lock(&self.flow);
        self.visible.load(Ordering::Relaxed) && flow.pace.is_ready(flow.quality.is_late())
    }

    /// Whether nothing is on its way.
    pub fn is_idle(&self) -> bool {
        self.visible.load(Ordering::Relaxed) && lock(&self.flow).pace.is_idle()
    }

    /// A picture is about to be made; those before it that are sent without loss need not arrive any more.
    pub fn depart(&self, frame: u32, lossless: bool) {
        self.newest.store(frame, Ordering::Release);
        lock(&self.flow).pace.depart(frame, lossless);
        // Whoever holds an older picture back until there is room learns that it is of no use now.
        self.arrived.notify_one();
    }

    /// Whether a newer picture is being made.
    pub fn is_old(&self, frame: u32) -> bool {
        self.newest.load(Ordering::Acquire) > frame
    }

    /// The first bytes of a picture go out, of so many.
    pub fn sent(&self, frame: u32, bytes: usize) {
        lock(&self.flow).pace.sent(frame, bytes);
    }

    /// A picture that will not arrive.
    pub fn abandon(&self, frame: u32) {
        lock(&self.flow).pace.abandon(frame);
    }

    /// The client shows a picture.
    pub fn acknowledge(&self, frame: u32) {
        let flow = &mut *lock(&self.flow);
        if let Some(shown) = flow.pace.acknowledge(frame) {
            flow.quality.shown(shown.time);
            shown.delivery.iter().for_each(|delivery| flow.quality.delivered(delivery));
        }
        self.arrived.notify_one();
    }

    /// All of a picture has arrived at the client's machine.
    pub fn landed(&self, frame: u32) {
        let flow = &mut *lock(&self.flow);
        flow.pace.landed(frame).iter().for_each(|delivery| flow.quality.delivered(delivery));
    }

    /// The client has so many bytes of a picture.
    pub fn received(&self, frame: u32, bytes: u64) {
        lock(&self.flow).pace.received(frame, bytes);
        self.arrived.notify_one();
    }

    /// Waits until so much of a picture has arrived that the network holds no more than it takes in a moment; or until
    /// the picture is old.
    pub async fn wait_for_room(&self, frame: u32, sent: u64) {
        loop {
            let held = {
                let flow = lock(&self.flow);
                sent.saturating_sub(flow.pace.arrived(frame)) > flow.quality.window()
            };
            if !held || self.is_old(frame) {
                return;
            }
            self.arrived.notified().await;
        }
    }

    pub fn pinged(&self, round_trip: Duration) {
        lock(&self.flow).quality.pinged(round_trip);
    }

    /// How pictures are to be encoded now.
    pub fn setting(&self) -> Setting {
        lock(&self.flow).quality.setting()
    }

    /// A file that was asked for could not be made.
    pub fn file_failed(&self, why: String) {
        *lock(&self.failure) = Some(why);
    }

    pub fn take_file_failure(&self) -> Option<String> {
        lock(&self.failure).take()
    }

    pub fn set_visible(&self, visible: bool) {
        self.visible.store(visible, Ordering::Relaxed);
    }

    pub fn leave(&self) {
        self.gone.store(true, Ordering::Release);
    }

    pub fn is_gone(&self) -> bool {
        self.gone.load(Ordering::Acquire)
    }
}
