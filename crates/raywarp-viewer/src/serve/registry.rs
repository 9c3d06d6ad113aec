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
pub struct ClientRegistry {
    /// Clients that the render thread has not seen yet.
    arrivals: Mutex<Vec<Arc<Client>>>,
    places: Arc<Semaphore>,
    size: usize,
    pub waker: Waker,
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

impl ClientRegistry {
    pub fn new(size: usize) -> Self {
        let size = size.min(Semaphore::MAX_PERMITS);
        Self {
            arrivals: Mutex::default(),
            places: Arc::new(Semaphore::new(size)),
            size,
            waker: Waker::default(),
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
        self.size.saturating_sub(self.places.available_permits())
    }

    /// Lets a client in. None where all places are taken.
    pub fn admit(&self, size: [u32; 2]) -> Option<Admission> {
        let place = Arc::clone(&self.places).try_acquire_owned().ok()?;
        let client = Arc::new(Client::new(size));
        let mut arrivals = lock(&self.arrivals);
        arrivals.retain(|client| !client.is_gone());
        arrivals.push(Arc::clone(&client));
        drop(arrivals);
        self.waker.wake();
        Some(Admission { client, _place: place })
    }

    /// Those who came since the last call.
    pub fn arrivals(&self) -> Vec<Arc<Client>> {
        std::mem::take(&mut *lock(&self.arrivals))
    }

    /// Ends the rendering after the picture at hand; clients are told at once.
    pub fn stop(&self) {
        self.stopping.store(true, Ordering::Release);
        self.end(Ending::of(&Ok(())));
        self.waker.wake();
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
        let _ = tokio::time::timeout(limit, self.places.acquire_many(all)).await;
    }
}

/// A client and its place. The client leaves when this is dropped, wherever its task was at.
#[derive(Debug)]
pub struct Admission {
    pub client: Arc<Client>,
    _place: OwnedSemaphorePermit,
}

impl Drop for Admission {
    fn drop(&mut self) {
        self.client.leave();
    }
}

/// Wakes the render thread.
#[derive(Debug, Default)]
pub struct Waker {
    woken: Mutex<bool>,
    signal: Condvar,
}

impl Waker {
    pub fn wake(&self) {
        *lock(&self.woken) = true;
        self.signal.notify_one();
    }

    /// Waits until it has been woken since the last call, or the limit has passed.
    pub fn wait(&self, limit: Duration) {
        let woken = lock(&self.woken);
        let waited = self.signal.wait_timeout_while(woken, limit, |woken| !*woken);
        *waited.unwrap_or_else(PoisonError::into_inner).0 = false;
    }
}
