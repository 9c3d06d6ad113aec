//! The render thread: one stage, and a seat for each client.

use std::time::{Duration, Instant};

use super::files::Files;
use super::hall::Hall;
use super::seat::{Seat, Urgency};
use super::ServeError;
use crate::live::Stage;
use crate::ViewerError;

/// Longest sleeps: with clients, for what happens by time alone; without, to see what the stage has ready.
const NAP: Duration = Duration::from_millis(25);
const SLEEP: Duration = Duration::from_millis(100);

/// Time that who asked for little lately may be ahead of the others.
const CREDIT: Duration = Duration::from_millis(250);

/// Shows the stage to whoever comes, until the server is stopped.
///
/// # Errors
/// [`ServeError`] where the scene cannot be read at first, or the device fails.
pub fn run(stage: Stage, hall: &Hall) -> Result<(), ServeError> {
    let (files, opened) = (Files::start(), Instant::now());
    let mut theatre =
        Theatre { stage, seats: Vec::new(), files, opened, level: Duration::ZERO, last: Urgency::Refinement };
    while !hall.is_stopping() {
        theatre.stage.poll();
        theatre.look_at_the_stage()?;
        theatre.seat(hall);
        theatre.take_input();
        let worked = theatre.work(hall)?;
        theatre.tell(hall);
        if !worked {
            hall.bell.wait(if theatre.seats.is_empty() { SLEEP } else { NAP });
        }
    }
    Ok(())
}

struct Theatre {
    stage: Stage,
    seats: Vec<Seat>,
    files: Files,
    opened: Instant,
    /// Time that each client has had of the render thread, about: that of the last one served.
    level: Duration,
    /// What the last of them was for.
    last: Urgency,
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

    /// All input is taken before each picture: what is rendered for one may depend on what another changed.
    fn take_input(&mut self) {
        for seat in &mut self.seats {
            seat.take_input(&mut self.stage, &self.files);
        }
    }

    /// One picture, for whoever needs it most. Whether there was any to make.
    fn work(&mut self, hall: &Hall) -> Result<bool, ServeError> {
        let others = self.seats.len() > 1;
        for index in self.order() {
            let Some(seat) = self.seats.get_mut(index) else { break };
            let (urgency, had, start) = (seat.urgency(), seat.had(self.level.saturating_sub(CREDIT)), Instant::now());
            let worked = match seat.step(&mut self.stage, self.opened.elapsed()) {
                // One page too many is not the end for the others.
                Err(error) if error.is_memory() && others => seat.refuse(&error),
                done => done?,
            };
            if worked {
                seat.charge(had + start.elapsed());
                (self.last, self.level) = (urgency, self.level.max(had));
                return Ok(true);
            }
            if hall.is_stopping() {
                break;
            }
        }
        Ok(false)
    }

    /// Those who are due: first who has seen nothing yet; then in turns who moves something and who refines, so that
    /// neither waits for all of the other; and of each who has had least time, so that a large picture of one does not
    /// count as a small one of another.
    fn order(&self) -> Vec<usize> {
        let mut due: Vec<_> = (0..self.seats.len()).filter(|&index| self.seats[index].is_due(&self.stage)).collect();
        let least = self.level.saturating_sub(CREDIT);
        due.sort_by_key(|&index| {
            let seat = &self.seats[index];
            (seat.has_shown(), seat.urgency() == self.last, seat.had(least))
        });
        due
    }

    fn tell(&mut self, hall: &Hall) {
        let viewers = hall.taken();
        self.seats.iter_mut().for_each(|seat| seat.tell(&self.stage, viewers));
    }
}
