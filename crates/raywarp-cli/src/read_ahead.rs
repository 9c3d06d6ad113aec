//! Rays that are read while the ones before them are answered.

use std::sync::mpsc::{channel, sync_channel, Receiver, Sender};
use std::thread;

use raywarp::query::files::{RayFileError, RayReader};
use raywarp::Ray;

/// The pieces of a file, one of which is read ahead.
pub struct ReadAhead {
    pieces: Receiver<Result<Vec<Ray>, RayFileError>>,
    /// Room that is not needed any more.
    used: Sender<Vec<Ray>>,
}

impl ReadAhead {
    /// Begins to read, so many rays at once. Nobody waits for the thread that does: it may itself wait for a pipe.
    pub fn new(mut reader: RayReader, piece: usize) -> Self {
        let (send, pieces) = sync_channel(1);
        let (used, room) = channel::<Vec<Ray>>();
        thread::spawn(move || loop {
            let mut rays = room.try_recv().unwrap_or_default();
            let read = reader.read(piece, &mut rays).map(|()| rays);
            let is_last = read.as_ref().map_or(true, Vec::is_empty);
            if send.send(read).is_err() || is_last {
                return;
            }
        });
        Self { pieces, used }
    }

    /// The next piece; none at the end, once.
    ///
    /// # Errors
    /// Those of [`RayReader::read`], after which there is nothing more.
    pub fn next(&self) -> Result<Option<Vec<Ray>>, RayFileError> {
        let rays = self.pieces.recv().expect("the thread ends after an empty piece or an error")?;
        Ok((!rays.is_empty()).then_some(rays))
    }

    /// Gives the room of a piece back.
    pub fn done(&self, rays: Vec<Ray>) {
        // Where the file has ended nobody needs it.
        let _ = self.used.send(rays);
    }
}
