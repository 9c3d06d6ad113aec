//! What events do: to the camera, the options, the scene.

use super::{Lacks, Viewer, MOST};
use crate::live::edits::Touched;
use crate::live::export::{Content, Export, Ticket};
use crate::live::keys::{self, Action};
use crate::live::look::Changed;
use crate::live::panel_rows::{CommandContext, Effect};
use crate::live::pick::{self, Pick};
use crate::live::stage::Ready;
use crate::live::{Button, Event, Notice, Outcome, Stage};

impl Viewer {
    /// Takes an event; returns what the front end has to do.
    pub fn handle(&mut self, stage: &mut Stage, event: &Event) -> Vec<Outcome> {
        if self.generation != stage.generation() {
            // What was picked is of another scene, which the picture may still show.
            self.pick = None;
        }
        if matches!(
            event,
            Event::Key { down: true, .. } | Event::Button { down: true, .. } | Event::Set { .. } | Event::Reset { .. }
        ) {
            self.notice = None;
            // What went wrong stays until it is mended, or put aside.
            let aside = keys::action(event) == Some(Action::Escape);
            if aside || stage.notice().is_some_and(|notice| !notice.error) {
                self.read = stage.told();
            }
        }
        match event {
            Event::Resize { width, height } => {
                self.size = [*width, *height].map(|side| side.clamp(1, MOST));
                self.ask(Lacks::Everything);
            }
            Event::Set { id, value } => match self.with_context(stage, |context| context.set(id, value)) {
                Ok(effect) => return self.see_to(stage, effect),
                Err(why) => self.refuse(why),
            },
            Event::Reset { id } => {
                let effects = self.with_context(stage, |context| context.reset(id));
                return effects.into_iter().flat_map(|effect| self.see_to(stage, effect)).collect();
            }
            _ => return self.point_or_press(stage, event),
        }
        Vec::new()
    }

    /// Pointer and keys.
    fn point_or_press(&mut self, stage: &mut Stage, event: &Event) -> Vec<Outcome> {
        let click = self.clicks.handle(event, self.aspect());
        if self.drag_object(stage, event) {
            // Without a button, all that the camera learns is where the pointer is.
            if matches!(event, Event::Pointer { .. }) {
                self.steer(event);
            }
            return Vec::new();
        }
        match click {
            Some(Button::Left) => self.pick = self.under_pointer(stage),
            Some(Button::Middle) => self.focus(stage),
            Some(Button::Right) | None => {}
        }
        let Some(action) = keys::action(event) else {
            self.steer(event);
            return Vec::new();
        };
        match self.look.act(action) {
            Changed::No => self.act(stage, action, event),
            Changed::Overlay => Vec::new(),
            Changed::Development => self.see_to(stage, Effect::Develop),
            Changed::Picture => self.see_to(stage, Effect::Picture),
        }
    }

    fn aspect(&self) -> f32 {
        self.size[0] as f32 / self.size[1] as f32
    }

    /// Hands an event to the camera.
    fn steer(&mut self, event: &Event) {
        let aspect = self.aspect();
        if let Some(control) = &mut self.control {
            let before = control.camera().clone();
            control.handle(event, aspect);
            if *control.camera() != before {
                self.restart();
            }
        }
    }

    /// Moves the picked object; whether the event was for it.
    fn drag_object(&mut self, stage: &mut Stage, event: &Event) -> bool {
        let (aspect, Some(control)) = (self.aspect(), &self.control) else { return false };
        let dragged = self.object_drag.handle(event, aspect, self.pick.as_ref().map(|pick| pick.position), control);
        if let (Some(by), Some(pick), Some(edits)) = (dragged.by, &self.pick, stage.edits_mut()) {
            let touched = edits.shift_instance(pick.instance, by, !dragged.begins);
            stage.bring(&touched);
            self.follow_pick(stage);
        }
        dragged.consumed
    }

    /// Keeps the picked point where it is on its object.
    fn follow_pick(&mut self, stage: &Stage) {
        if let (Some(pick), Some(ready)) = (&mut self.pick, stage.ready()) {
            pick.follow(&ready.scene.meshes, ready.edits.scene());
        }
    }

    fn with_context<T>(&mut self, stage: &mut Stage, work: impl FnOnce(&mut CommandContext) -> T) -> T {
        let tree = stage.builds();
        let (camera, edits) = (self.control.as_mut(), stage.edits_mut());
        work(&mut CommandContext { look: &mut self.look, usual: &self.usual, tree, camera, edits })
    }

    /// Sees to what remains to be done after a change.
    fn see_to(&mut self, stage: &mut Stage, effect: Effect) -> Vec<Outcome> {
        match effect {
            Effect::Overlay => {}
            Effect::Develop => self.ask(Lacks::Developing),
            Effect::Picture => self.restart(),
            Effect::Build(build) => stage.choose(build),
            Effect::Scene(touched) => {
                stage.bring(&touched);
                self.follow_pick(stage);
            }
            Effect::Act(action) => return self.act(stage, action, &Event::Blur),
        }
        Vec::new()
    }

    /// What keys ask of others than the options.
    fn act(&mut self, stage: &mut Stage, action: Action, event: &Event) -> Vec<Outcome> {
        let outcome = match action {
            Action::Screenshot => self.screenshot(),
            Action::CopyCamera => self.copy_camera(),
            Action::Quit => Some(Outcome::Quit),
            Action::Reload => (stage.reload(), None).1,
            Action::Undo => self.change_back(stage, |edits| edits.undo()),
            Action::Redo => self.change_back(stage, |edits| edits.redo()),
            Action::Save => self.save(stage),
            Action::Escape => (self.pick = None, None).1,
            Action::Focus => (self.focus(stage), None).1,
            Action::Frame if self.pick.is_some() => (self.frame_picked(stage), None).1,
            _ => (self.steer(event), None).1,
        };
        outcome.into_iter().collect()
    }

    fn change_back(
        &mut self,
        stage: &mut Stage,
        step: impl FnOnce(&mut crate::live::edits::Edits) -> Vec<Touched>,
    ) -> Option<Outcome> {
        let touched = stage.edits_mut().map(step).unwrap_or_default();
        stage.bring(&touched);
        self.follow_pick(stage);
        None
    }

    /// What the pixel under the pointer shows.
    fn under_pointer(&mut self, stage: &Stage) -> Option<Pick> {
        let (ready, camera, at) = (stage.ready()?, self.camera()?.clone(), self.clicks.at()?);
        let pixel = [0, 1].map(|i| ((at[i] * self.size[i] as f32) as u32).min(self.size[i] - 1));
        // Where the device has things, which is what is seen.
        let Ready { tracer, scene, placed, .. } = ready;
        let shown = raywarp::scene::Scene { instances: placed.clone(), ..ready.edits.scene().clone() };
        match Pick::at(tracer, &scene.meshes, &shown, &camera, self.size, pixel) {
            Ok(pick) => pick,
            Err(error) => (self.refuse(error), None).1,
        }
    }

    /// Orbits about what is under the pointer.
    fn focus(&mut self, stage: &Stage) {
        let (pick, Some(control)) = (self.under_pointer(stage), &mut self.control) else { return };
        if let Some(pick) = pick {
            control.set_focus(pick.position);
            self.restart();
        }
    }

    fn frame_picked(&mut self, stage: &Stage) {
        let (Some(ready), Some(pick), Some(control)) = (stage.ready(), &self.pick, &mut self.control) else { return };
        if let Some(bounds) = pick::instance_bounds(&ready.scene.meshes, ready.edits.scene(), pick.instance) {
            control.frame(bounds);
            self.restart();
        }
    }

    fn copy_camera(&mut self) -> Option<Outcome> {
        let flags = self.control.as_ref()?.flags();
        self.notice = Some(Notice { text: format!("copied: {flags}"), error: false });
        Some(Outcome::Copy(flags))
    }

    fn screenshot(&mut self) -> Option<Outcome> {
        let picture = self.frames.shown()?;
        let ticket = self.ticket()?;
        let content = Content::Picture(picture);
        Some(Outcome::File(Export { name: "raywarp.png".to_owned(), media_type: "image/png", content, ticket }))
    }

    fn save(&mut self, stage: &Stage) -> Option<Outcome> {
        let (ready, camera) = (stage.ready()?, self.camera()?.clone());
        let ticket = self.ticket()?;
        Some(Outcome::File(super::save::scene_file(stage, ready, &self.look, camera, self.size, ticket)))
    }

    /// For the next file, if none is on its way.
    fn ticket(&mut self) -> Option<Ticket> {
        if self.exported.strong_count() > 0 {
            self.refuse("the last file is still on its way: ask again once it is there");
            return None;
        }
        let (ticket, watched) = Ticket::new();
        self.exported = watched;
        Some(ticket)
    }

    /// Tells that a file could not be made.
    pub fn export_failed(&mut self, why: impl ToString) {
        self.refuse(why);
    }

    /// Tells why something was not done.
    fn refuse(&mut self, why: impl ToString) {
        self.notice = Some(Notice { text: why.to_string(), error: true });
    }
}
