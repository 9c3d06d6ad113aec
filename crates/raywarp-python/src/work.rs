//! Work beside Python: other threads of Python run meanwhile, and Ctrl-C ends it.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// How often Python is asked whether Ctrl-C was pressed.
const LOOK: Duration = Duration::from_millis(50);

/// Whether work is to end before it is done.
#[derive(Default)]
pub struct Stop(AtomicBool);

impl Stop {
    /// Whether it is.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Does work on so many threads, all that there are if none are named, while others may use Python.
///
/// # Errors
/// What a handler of a signal raised meanwhile: `KeyboardInterrupt`. The work was asked to stop then, and has.
pub fn run<T: Send>(py: Python<'_>, threads: Option<usize>, work: impl FnOnce(&Stop) -> T + Send) -> PyResult<T> {
    let pool = pool(threads)?;
    let stop = Stop::default();
    py.detach(|| {
        let (done, result) = mpsc::channel();
        // Python handles signals on its main thread alone, so that is not one of those that work.
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                // The receiver is there until this is over.
                let _ = done.send(work(&stop));
            });
            wait(&result, &stop)
        })
    })
}

/// The result, or what the handler of a signal raised before it was there.
fn wait<T>(result: &mpsc::Receiver<T>, stop: &Stop) -> PyResult<T> {
    let mut raised = None;
    loop {
        match result.recv_timeout(LOOK) {
            Ok(result) => return raised.map_or(Ok(result), Err),
            Err(RecvTimeoutError::Disconnected) => {
                // The scope passes the panic on when this returns.
                return Err(raised.unwrap_or_else(|| PyRuntimeError::new_err("the work ended without a result")));
            }
            Err(RecvTimeoutError::Timeout) if raised.is_none() => {
                raised = Python::attach(|py| py.check_signals()).err();
                stop.0.store(raised.is_some(), Ordering::Relaxed);
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Pools of a process, by their number of threads.
struct Pools {
    process: u32,
    by_threads: HashMap<usize, Arc<ThreadPool>>,
}

static POOLS: Mutex<Option<Pools>> = Mutex::new(None);

/// A pool of so many threads. A process that was forked has none of its parent's threads, so it makes its own.
fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if pools.as_ref().is_some_and(|pools| pools.process != process) {
        // Not dropped: that would wait for threads of another process.
        std::mem::forget(pools.take());
    }
    let pools = pools.get_or_insert_with(|| Pools { process, by_threads: HashMap::new() });
    // None of them is the number that the machine, or RAYON_NUM_THREADS, says.
    let threads = threads.unwrap_or(0);
    if let Some(pool) = pools.by_threads.get(&threads) {
        return Ok(Arc::clone(pool));
    }
    let built = ThreadPoolBuilder::new().num_threads(threads).thread_name(|index| format!("raywarp-{index}")).build();
    let pool = built.map_err(|error| PyRuntimeError::new_err(format!("cannot start {threads} threads: {error}")))?;
    Ok(Arc::clone(pools.by_threads.entry(threads).or_insert(Arc::new(pool))))
}
