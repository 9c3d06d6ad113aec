//! What waits to be sent to a client.

use std::collections::VecDeque;
use std::sync::Mutex;

use axum::body::Bytes;
use tokio::sync::Notify;

use super::registry::lock;
use crate::live::Ticket;

/// Text of which only the latest counts, files, and pictures.
#[derive(Debug, Default)]
pub struct Outbox {
    waiting: Mutex<Waiting>,
    filled: Notify,
}

#[derive(Debug, Default)]
struct Waiting {
    failure: Option<String>,
    status: Option<String>,
    panel: Option<String>,
    copy: Option<String>,
    file: Option<File>,
    frames: VecDeque<Frame>,
}

/// A file and the message that announces it. Until it is dropped, the viewer makes no other.
#[derive(Debug)]
pub struct File {
    pub head: String,
    pub content: Bytes,
    pub ticket: Ticket,
}

/// An encoded picture.
#[derive(Debug)]
pub struct Frame {
    pub number: u32,
    /// Whether it is sent in small portions and dropped for newer ones.
    pub lossless: bool,
    /// From top to bottom, with their heads.
    pub stripes: Vec<Bytes>,
}

/// The next thing to send.
#[derive(Debug)]
pub enum Outgoing {
    /// The last one: why there is nothing more.
    Failure(String),
    Text(String),
    File(File),
    Frame(Frame),
}

impl Outbox {
    pub fn status(&self, text: String) {
        lock(&self.waiting).status = Some(text);
        self.filled.notify_one();
    }

    pub fn panel(&self, text: String) {
        lock(&self.waiting).panel = Some(text);
        self.filled.notify_one();
    }

    pub fn copy(&self, text: String) {
        lock(&self.waiting).copy = Some(text);
        self.filled.notify_one();
    }

    /// Adds a file: the only one, as a viewer makes no other before it is sent.
    pub fn file(&self, file: File) {
        lock(&self.waiting).file = Some(file);
        self.filled.notify_one();
    }

    /// Adds a picture. Their number is bounded by who makes them, as none is made before the last but one has arrived.
    pub fn frame(&self, frame: Frame) {
        lock(&self.waiting).frames.push_back(frame);
        self.filled.notify_one();
    }

    /// The client can get no more.
    pub fn fail(&self, text: String) {
        lock(&self.waiting).failure = Some(text);
        self.filled.notify_one();
    }

    /// The next thing, as soon as there is one: pictures first, as they age fastest.
    pub async fn next(&self) -> Outgoing {
        loop {
            if let Some(message) = lock(&self.waiting).take() {
                return message;
            }
            self.filled.notified().await;
        }
    }
}

impl Waiting {
    fn take(&mut self) -> Option<Outgoing> {
        let failure = self.failure.take().map(Outgoing::Failure);
        let frame = || self.frames.pop_front().map(Outgoing::Frame);
        if let Some(message) = failure.or_else(frame) {
            return Some(message);
        }
        let text = self.status.take().or_else(|| self.panel.take()).or_else(|| self.copy.take());
        text.map(Outgoing::Text).or_else(|| self.file.take().map(Outgoing::File))
    }
}
