//! Ctrl-C between two files, never within one.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What the shell expects of a program that SIGINT ended.
const INTERRUPTED: i32 = 130;

/// Ends the program on Ctrl-C or SIGTERM, but not while a file is being written.
pub struct Interrupt {
    writing: Arc<Mutex<()>>,
}

impl Interrupt {
    /// From here on the program ends with exit code 130, after the file that is being written.
    pub fn install() -> Self {
        let writing = Arc::new(Mutex::new(()));
        let waiting = Arc::clone(&writing);
        // Where no handler can be set, the system's own still ends the program.
        let _ = ctrlc::set_handler(move || {
            let _written = waiting.lock();
            std::process::exit(INTERRUPTED);
        });
        Self { writing }
    }

    /// Holds interruptions off while it lives.
    pub fn hold(&self) -> MutexGuard<'_, ()> {
        self.writing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
