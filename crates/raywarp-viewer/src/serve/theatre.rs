//! The render thread: one stage, and a seat for each client.

use std::time::{Duration, Instant};

use super::hall::Hall;
use super::seat::Seat;
use super::ServeError;
use crate::live::Stage;
use crate::ViewerError;

/// Longest sleeps: with clients, for what happens by time alone; without, to see what the stage has ready.
const NAP: Duration = Duration::from_millis(25);
const SLEEP: Duration = Duration::from_millis(100);

/// Shows the stage to whoever comes, until the server is stopped.
///
/// # Errors
/// [`ServeError`] where the scene cannot be read at first, or the device fails.
pub fn run(stage: Stage, hall: &Hall) -> Result<(), ServeError> {
    let mut theatre = Theatre { stage, seats: Vec::new(), opened: Instant::now() };
    while !hall.is_stopping() {
        theatre.stage.poll();
        theatre.look_at_the_stage()?;
        theatre.seat(hall);
        if !theatre.turn(hall)? {
            hall.bell.wait(if theatre.seats.is_empty() { SLEEP } else { NAP });
        }
    }
    Ok(())
}

struct Theatre {
    stage: Stage,
    seats: Vec<Seat>,
    opened: Instant,
}

impl Theatre {
    /// A first scene that is not coming is the end.
    fn look_at_the_stage(&mut self) -> Result<(), ServeError> {
        self.stage.take_failure().map_or(Ok(()), |error| Err(ViewerError::into(error)))
    }

    fn seat(&mut self, hall: &Hall) {
        self.seats.retain(|seat| !seat.is_gone());
        let arrivals = hall.arrivals().into_iter().filter(|client| !client.is_gone());
        self.seats.extend(arrivals.map(Seat::new));
    }

    /// One picture for each client that is ready for one. Whether there was any.
    fn turn(&mut self, hall: &Hall) -> Result<bool, ServeError> {
        let (mut worked, viewers) = (false, hall.taken());
        for index in 0..self.seats.len() {
            // All input is taken before each picture: what is rendered for one may depend on what another changed.
            for seat in &mut self.seats {
                seat.take_input(&mut self.stage);
            }
            let is_alone = self.seats.len() == 1;
            let Some(seat) = self.seats.get_mut(index) else { break };
            worked |= match seat.step(&mut self.stage, self.opened.elapsed()) {
                // One page too many is not the end for the others.
                Err(error) if error.is_memory() && !is_alone => seat.refuse(&error),
                done => done?,
            };
            seat.tell(&self.stage, viewers);
            if hall.is_stopping() {
                break;
            }
        }
        Ok(worked)
    }
}
