//! Resets of what is this viewer's own, options and camera, so that undo takes them back in their place among the steps of
//! the edits, which all viewers share.

use raywarp::scene::Camera;

use super::Viewer;
use crate::live::camera_control::Turns;
use crate::live::edits::Edits;
use crate::live::{LiveScene, Outcome, Value};

/// Resets that are kept.
const MOST: usize = 64;

/// What a reset may change beside the edits.
#[derive(Clone, Debug, Default, PartialEq)]
struct Own {
    /// Of the section of the picture's options: rows and their values.
    options: Vec<(String, Value)>,
    camera: Option<Camera>,
    turns: Turns,
}

/// A reset that changed more than the edits.
#[derive(Debug)]
struct Reset {
    sides: [Own; 2],
    /// The last step of the edits when it was done.
    step: u64,
    /// Whether that step is this reset's.
    edits: bool,
}

/// Those that can be taken back, and those that were.
#[derive(Debug, Default)]
pub(super) struct Resets {
    done: Vec<Reset>,
    undone: Vec<Reset>,
}

impl Resets {
    /// Something else was done: what was taken back is gone.
    pub fn forget_undone(&mut self) {
        self.undone.clear();
    }
}

impl Viewer {
    /// Back to the default: a row, a section, or with an empty name everything.
    pub(super) fn reset(&mut self, live_scene: &mut LiveScene, id: &str) -> Vec<Outcome> {
        let (before, step) = (self.own(live_scene), last_step(live_scene));
        let effects = self.with_context(live_scene, |context| context.reset(id));
        let outcomes = effects.into_iter().flat_map(|effect| self.see_to(live_scene, effect)).collect();
        let (after, now) = (self.own(live_scene), last_step(live_scene));
        if before != after {
            self.resets.done.push(Reset { sides: [before, after], step: now, edits: now != step });
            if self.resets.done.len() > MOST {
                self.resets.done.remove(0);
            }
        }
        self.resets.forget_undone();
        outcomes
    }

    /// Takes the last step back: of the edits, or a reset after it.
    pub(super) fn undo(&mut self, live_scene: &mut LiveScene) {
        let step = last_step(live_scene);
        let Some(reset) = self.resets.done.pop_if(|reset| reset.step >= step) else {
            return self.change(live_scene, Edits::undo);
        };
        if reset.edits && reset.step == step {
            self.change(live_scene, Edits::undo);
        }
        self.restore(live_scene, &reset.sides[0], &reset.sides[1]);
        self.resets.undone.push(reset);
    }

    /// Does the last step that was taken back again.
    pub(super) fn redo(&mut self, live_scene: &mut LiveScene) {
        let last = last_step(live_scene);
        let next = live_scene.ready().and_then(|ready| ready.edits.next_step());
        let is_next = |reset: &mut Reset| if reset.edits { next == Some(reset.step) } else { reset.step == last };
        let Some(reset) = self.resets.undone.pop_if(is_next) else { return self.change(live_scene, Edits::redo) };
        if reset.edits {
            self.change(live_scene, Edits::redo);
        }
        self.restore(live_scene, &reset.sides[1], &reset.sides[0]);
        self.resets.done.push(reset);
    }

    fn own(&self, live_scene: &LiveScene) -> Own {
        let sections = self.panel(live_scene).sections.into_iter().filter(|section| section.id == "rendering");
        Own {
            options: sections.flat_map(|section| section.rows).map(|row| (row.id, row.value)).collect(),
            camera: self.camera().cloned(),
            turns: self.control.as_ref().map(|control| control.turns()).unwrap_or_default(),
        }
    }

    /// What the reset changed becomes what it was on that side; the rest stays.
    fn restore(&mut self, live_scene: &mut LiveScene, to: &Own, from: &Own) {
        for ((id, value), _) in to.options.iter().zip(&from.options).filter(|(to, from)| to != from) {
            // A value that its row had is one that it takes, or the scene is another.
            if let Ok(effect) = self.with_context(live_scene, |context| context.set(id, value)) {
                self.see_to(live_scene, effect);
            }
        }
        let Some(control) = &mut self.control else { return };
        if to.turns != from.turns {
            control.set_turns(to.turns);
        }
        let camera = to.camera.clone().filter(|_| to.camera != from.camera);
        if camera.is_some_and(|camera| control.set(camera).is_ok()) {
            self.restart();
        }
    }
}

fn last_step(live_scene: &LiveScene) -> u64 {
    live_scene.ready().map_or(0, |ready| ready.edits.last_step())
}
