//! Encodes a client's pictures beside the render thread, in their order.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use super::client::Client;
use super::outbox::Frame;
use super::registry::lock;
use super::stripes::{encode, Coding};
use crate::live::Picture;

/// Pictures that wait: never more than are under way to the client.
#[derive(Debug, Default)]
pub struct Encoder {
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    waiting: VecDeque<Job>,
    running: bool,
}

/// A picture to encode.
#[derive(Debug)]
pub struct Job {
    pub picture: Arc<Picture>,
    pub coding: Coding,
    pub frame: u32,
    pub mark: u32,
}

impl Encoder {
    fn next(&self) -> Option<Job> {
        let mut state = lock(&self.state);
        let job = state.waiting.pop_front();
        state.running = job.is_some();
        job
    }

    /// Adds a picture; whether somebody has to begin.
    fn add(&self, job: Job) -> bool {
        let mut state = lock(&self.state);
        state.waiting.push_back(job);
        !std::mem::replace(&mut state.running, true)
    }
}

/// Encodes a picture on the threads of the CPU and hands it to the client's socket.
pub fn submit(client: &Arc<Client>, job: Job) {
    if client.encoder.add(job) {
        let client = Arc::clone(client);
        rayon::spawn(move || {
            while let Some(job) = client.encoder.next() {
                work(&client, &job);
            }
        });
    }
}

fn work(client: &Client, job: &Job) {
    let lossless = job.coding == Coding::Lossless;
    if client.is_gone() || lossless && client.is_old(job.frame) {
        return client.abandon(job.frame);
    }
    match encode(&job.picture, job.coding, job.frame, job.mark) {
        Ok(stripes) => client.outbox.frame(Frame { number: job.frame, lossless, stripes }),
        Err(error) => client.outbox.fail(format!("a picture cannot be encoded: {error}")),
    }
}
