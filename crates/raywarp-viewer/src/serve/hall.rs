//! Where clients and the render thread find each other.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::{watch, OwnedSemaphorePermit, Semaphore};

use super::client::Client;
use super::protocol::close;
use super::ServeError;

/// The data behind a lock. A thread that panicked while it held it is told elsewhere.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What all threads of a server share.
#[derive(Debug)]
pub struct Hall {
    /// Clients that the render thread has not seen yet.
    arrivals: Mutex<Vec<Arc<Client>>>,
    seats: Arc<Semaphore>,
    size: usize,
    pub bell: Bell,
    stopping: AtomicBool,
    ending: watch::Sender<Option<Ending>>,
}

/// How a server ended: what its clients are told.
#[derive(Clone, Debug)]
pub struct Ending {
    pub code: u16,
    pub text: String,
    pub error: bool,
}

impl Ending {
    pub fn of(done: &Result<(), ServeError>) -> Self {
        match done {
            Ok(()) => Self { code: close::AWAY, text: "the server was stopped".to_owned(), error: false },
            Err(error) => Self { code: close::FAILED, text: error.to_string(), error: true },
        }
    }
}

impl Hall {
    pub fn new(size: usize) -> Self {
        let size = size.min(Semaphore::MAX_PERMITS);
        Self {
            arrivals: Mutex::default(),
            seats: Arc::new(Semaphore::new(size)),
            size,
            bell: Bell::default(),
            stopping: AtomicBool::new(false),
            ending: watch::Sender::new(None),
        }
    }

    /// Most clients at a time.
    pub fn size(&self) -> usize {
        self.size
    }

    /// How many there are.
    pub fn taken(&self) -> usize {
        self.size.saturating_sub(self.seats.available_permits())
    }

    /// Lets a client in, for as long as the permit lives. None where all seats are taken.
    pub fn admit(&self, size: [u32; 2]) -> Option<(Arc<Client>, OwnedSemaphorePermit)> {
        let permit = Arc::clone(&self.seats).try_acquire_owned().ok()?;
        let client = Arc::new(Client::new(size));
        let mut arrivals = lock(&self.arrivals);
        arrivals.retain(|client| !client.is_gone());
        arrivals.push(Arc::clone(&client));
        drop(arrivals);
        self.bell.ring();
        Some((client, permit))
    }

    /// Those who came since the last call.
    pub fn arrivals(&self) -> Vec<Arc<Client>> {
        std::mem::take(&mut *lock(&self.arrivals))
    }

    /// Ends the rendering after the picture at hand; clients are told at once.
    pub fn stop(&self) {
        self.stopping.store(true, Ordering::Release);
        self.end(Ending::of(&Ok(())));
        self.bell.ring();
    }

    pub fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::Acquire)
    }

    /// Tells all clients, and those who come later. What was told first holds.
    pub fn end(&self, ending: Ending) {
        self.ending.send_if_modified(|told| {
            let is_first = told.is_none();
            told.get_or_insert(ending);
            is_first
        });
    }

    pub fn ending(&self) -> watch::Receiver<Option<Ending>> {
        self.ending.subscribe()
    }

    pub async fn wait_until_empty(&self, limit: Duration) {
        let all = u32::try_from(self.size).unwrap_or(u32::MAX);
        let _ = tokio::time::timeout(limit, self.seats.acquire_many(all)).await;
    }
}

/// Wakes the render thread.
#[derive(Debug, Default)]
pub struct Bell {
    rung: Mutex<bool>,
    heard: Condvar,
}

impl Bell {
    pub fn ring(&self) {
        *lock(&self.rung) = true;
        self.heard.notify_one();
    }

    /// Waits until it has rung since the last call, or the limit has passed.
    pub fn wait(&self, limit: Duration) {
        let rung = lock(&self.rung);
        let waited = self.heard.wait_timeout_while(rung, limit, |rung| !*rung);
        *waited.unwrap_or_else(PoisonError::into_inner).0 = false;
    }
}
