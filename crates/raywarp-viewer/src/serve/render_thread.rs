//! The render thread: one stage, and a session for each client.

use std::time::{Duration, Instant};

use super::files::Files;
use super::registry::ClientRegistry;
use super::session::{Session, Urgency};
use super::ServeError;
use crate::live::LiveScene;
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
pub fn run(live_scene: LiveScene, registry: &ClientRegistry) -> Result<(), ServeError> {
    let (files, opened) = (Files::start(), Instant::now());
    let mut thread = RenderThread {
        live_scene,
        sessions: Vec::new(),
        files,
        opened,
        level: Duration::ZERO,
        last: Urgency::Refinement,
    };
    while !registry.is_stopping() {
        thread.live_scene.poll();
        thread.check_scene()?;
        thread.admit(registry);
        thread.take_input();
        let worked = thread.work(registry)?;
        thread.tell(registry);
        if !worked {
            registry.waker.wait(if thread.sessions.is_empty() { SLEEP } else { NAP });
        }
    }
    Ok(())
}

struct RenderThread {
    live_scene: LiveScene,
    sessions: Vec<Session>,
    files: Files,
    opened: Instant,
    /// Time that each client has had of the render thread, about: that of the last one served.
    level: Duration,
    /// What the last of them was for.
    last: Urgency,
}

impl RenderThread {
    /// A first scene that is not coming is the end.
    fn check_scene(&mut self) -> Result<(), ServeError> {
        self.live_scene.take_failure().map_or(Ok(()), |error| Err(ViewerError::into(error)))
    }

    fn admit(&mut self, registry: &ClientRegistry) {
        self.sessions.retain(|session| !session.is_gone());
        let arrivals = registry.arrivals().into_iter().filter(|client| !client.is_gone());
        self.sessions.extend(arrivals.map(Session::new));
    }

    /// All input is taken before each picture: what is rendered for one may depend on what another changed.
    fn take_input(&mut self) {
        for session in &mut self.sessions {
            session.take_input(&mut self.live_scene, &self.files);
        }
    }

    /// One picture, for whoever needs it most. Whether there was any to make.
    fn work(&mut self, registry: &ClientRegistry) -> Result<bool, ServeError> {
        let others = self.sessions.len() > 1;
        for index in self.order() {
            let Some(session) = self.sessions.get_mut(index) else { break };
            let (urgency, had, start) =
                (session.urgency(), session.had(self.level.saturating_sub(CREDIT)), Instant::now());
            let worked = match session.step(&mut self.live_scene, self.opened.elapsed()) {
                // One page too many is not the end for the others.
                Err(error) if error.is_memory() && others => session.refuse(&error),
                done => done?,
            };
            if worked {
                session.charge(had + start.elapsed());
                (self.last, self.level) = (urgency, self.level.max(had));
                return Ok(true);
            }
            if registry.is_stopping() {
                break;
            }
        }
        Ok(false)
    }

    /// Those who are due: first who has seen nothing yet; then in turns who moves something and who refines, so that
    /// neither waits for all of the other; and of each who has had least time, so that a large picture of one does not
    /// count as a small one of another.
    fn order(&self) -> Vec<usize> {
        let mut due: Vec<_> =
            (0..self.sessions.len()).filter(|&index| self.sessions[index].is_due(&self.live_scene)).collect();
        let least = self.level.saturating_sub(CREDIT);
        due.sort_by_key(|&index| {
            let session = &self.sessions[index];
            (session.has_shown(), session.urgency() == self.last, session.had(least))
        });
        due
    }

    fn tell(&mut self, registry: &ClientRegistry) {
        let viewers = registry.taken();
        self.sessions.iter_mut().for_each(|session| session.tell(&self.live_scene, viewers));
    }
}
