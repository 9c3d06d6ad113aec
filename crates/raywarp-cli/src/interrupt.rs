//! Ctrl-C between two files, never within one.

use std::io::{self, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What the shell expects of a program that SIGINT ended.
pub const INTERRUPTED: i32 = 130;

/// On Ctrl-C or SIGTERM does this; the second time the program ends at once.
pub fn once(end: impl Fn() + Send + 'static) {
    let asked = AtomicBool::new(false);
    // Where no handler can be set, the system's own still ends the program.
    let _ = ctrlc::set_handler(move || {
        if asked.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
        end();
    });
}

/// Ends the program on Ctrl-C or SIGTERM, but not while a file is being written.
pub struct Interrupt {
    writing: Arc<Mutex<()>>,
    asked: Arc<AtomicBool>,
    unfinished: Arc<Mutex<Vec<PathBuf>>>,
}

impl Interrupt {
    /// From here on the program ends with exit code 130, after the file that is being written.
    pub fn install() -> Self {
        let writing = Arc::new(Mutex::new(()));
        let asked = Arc::new(AtomicBool::new(false));
        let unfinished = Arc::new(Mutex::new(Vec::new()));
        let (waiting, told, left) = (Arc::clone(&writing), Arc::clone(&asked), Arc::clone(&unfinished));
        // Where no handler can be set, the system's own still ends the program.
        let _ = ctrlc::set_handler(move || {
            told.store(true, Ordering::Relaxed);
            let _written = waiting.lock();
            remove(&left);
            std::process::exit(INTERRUPTED);
        });
        Self { writing, asked, unfinished }
    }

    /// A file or a folder that goes if the program is ended: it is of no use then.
    pub fn unfinished(&self, path: PathBuf) {
        self.unfinished.lock().unwrap_or_else(PoisonError::into_inner).push(path);
    }

    /// Holds interruptions off while it lives.
    pub fn hold(&self) -> MutexGuard<'_, ()> {
        self.writing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// An output that fails once an end is asked for: what takes long to write need not be waited for.
    pub fn stop<'a, W>(&'a self, output: &'a mut W) -> Stopping<'a, W> {
        Stopping { output, asked: &self.asked }
    }
}

fn remove(files: &Mutex<Vec<PathBuf>>) {
    for path in files.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        // One that is gone or cannot go: nothing better can be done.
        let _ = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    }
}

/// See [`Interrupt::stop`].
pub struct Stopping<'a, W> {
    output: &'a mut W,
    asked: &'a AtomicBool,
}

impl<W: Write> Write for Stopping<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.asked.load(Ordering::Relaxed) {
            return Err(io::Error::other("interrupted"));
        }
        self.output.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}

impl<W: Seek> Seek for Stopping<'_, W> {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.output.seek(place)
    }
}
