//! What events do: to the camera, the options, the scene.

use super::{Lacks, Viewer};
use crate::live::edits::{Edits, Touched};
use crate::live::export::{Content, Export, Ticket};
use crate::live::keys::{self, Action};
use crate::live::live_scene::Ready;
use crate::live::panel_rows::{CommandContext, Effect};
use crate::live::pick::{self, Pick};
use crate::live::view_settings::Changed;
use crate::live::{Button, Event, LiveScene, Notice, Outcome};

impl Viewer {
    /// Takes an event; returns what the front end has to do.
    pub fn handle(&mut self, live_scene: &mut LiveScene, event: &Event) -> Vec<Outcome> {
        if self.generation != live_scene.generation() {
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
            if aside || live_scene.notice().is_some_and(|notice| !notice.error) {
                self.read = live_scene.told();
            }
        }
        match event {
            Event::Resize { width, height } => self.resize([*width, *height]),
            Event::Set { id, value } => match self.with_context(live_scene, |context| context.set(id, value)) {
                Ok(effect) => {
                    if !matches!(effect, Effect::Act(_)) {
                        self.resets.forget_undone();
                    }
                    return self.see_to(live_scene, effect);
                }
                Err(why) => self.refuse(why),
            },
            Event::Reset { id } => return self.reset(live_scene, id),
            _ => return self.point_or_press(live_scene, event),
        }
        Vec::new()
    }

    /// Pointer and keys.
    fn point_or_press(&mut self, live_scene: &mut LiveScene, event: &Event) -> Vec<Outcome> {
        let click = self.clicks.handle(event, self.aspect());
        if self.drag_object(live_scene, event) {
            // Without a button, all that the camera learns is where the pointer is.
            if matches!(event, Event::Pointer { .. }) {
                self.steer(event);
            }
            return Vec::new();
        }
        match click {
            Some(Button::Left) => {
                let pick = self.under_pointer(live_scene);
                self.hold(pick);
            }
            Some(Button::Middle) => self.focus(live_scene),
            Some(Button::Right) | None => {}
        }
        let Some(action) = keys::action(event) else {
            self.steer(event);
            return Vec::new();
        };
        match self.view_settings.act(action) {
            Changed::No => self.act(live_scene, action, event),
            Changed::Overlay => Vec::new(),
            Changed::Development => self.see_to(live_scene, Effect::ToneMapFilm),
            Changed::Picture => self.see_to(live_scene, Effect::Picture),
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
    fn drag_object(&mut self, live_scene: &mut LiveScene, event: &Event) -> bool {
        let (aspect, Some(control)) = (self.aspect(), &self.control) else { return false };
        let dragged = self.object_drag.handle(event, aspect, self.pick.as_ref().map(|pick| pick.position), control);
        if let (Some(by), Some(pick), Some(edits)) = (dragged.by, &self.pick, live_scene.edits_mut()) {
            let touched = edits.shift_instance(pick.instance, by, !dragged.begins);
            self.resets.forget_undone();
            live_scene.bring(&touched);
            self.follow_pick(live_scene);
        }
        dragged.consumed
    }

    /// Keeps the picked point where it is on its object.
    fn follow_pick(&mut self, live_scene: &LiveScene) {
        if let (Some(pick), Some(ready)) = (&mut self.pick, live_scene.ready()) {
            pick.follow(&ready.scene.meshes, ready.edits.scene());
        }
    }

    pub(super) fn with_context<T>(
        &mut self,
        live_scene: &mut LiveScene,
        work: impl FnOnce(&mut CommandContext) -> T,
    ) -> T {
        let tree = live_scene.builds();
        let (camera, edits) = (self.control.as_mut(), live_scene.edits_mut());
        work(&mut CommandContext { view_settings: &mut self.view_settings, usual: &self.usual, tree, camera, edits })
    }

    /// Sees to what remains to be done after a change.
    pub(super) fn see_to(&mut self, live_scene: &mut LiveScene, effect: Effect) -> Vec<Outcome> {
        match effect {
            Effect::Overlay => {}
            Effect::ToneMapFilm => self.ask(Lacks::Developing),
            Effect::Picture => self.restart(),
            Effect::Build(build) => live_scene.choose(build),
            Effect::Scene(touched) => {
                live_scene.bring(&touched);
                self.follow_pick(live_scene);
            }
            Effect::Act(action) => return self.act(live_scene, action, &Event::Blur),
        }
        Vec::new()
    }

    /// What keys ask of others than the options.
    fn act(&mut self, live_scene: &mut LiveScene, action: Action, event: &Event) -> Vec<Outcome> {
        let outcome = match action {
            Action::Screenshot => self.screenshot(live_scene),
            Action::CopyCamera => self.copy_camera(),
            Action::Quit => Some(Outcome::Quit),
            Action::Reload => (live_scene.reload(), None).1,
            Action::Undo => (self.undo(live_scene), None).1,
            Action::Redo => (self.redo(live_scene), None).1,
            Action::Save => self.save(live_scene),
            Action::Escape => (self.hold(None), None).1,
            Action::Focus => (self.focus(live_scene), None).1,
            Action::Frame if self.pick.is_some() => (self.frame_picked(live_scene), None).1,
            _ => (self.steer(event), None).1,
        };
        outcome.into_iter().collect()
    }

    /// Takes a step of the edits back, or does it again.
    pub(super) fn change(&mut self, live_scene: &mut LiveScene, step: impl FnOnce(&mut Edits) -> Vec<Touched>) {
        let touched = live_scene.edits_mut().map(step).unwrap_or_default();
        live_scene.bring(&touched);
        self.follow_pick(live_scene);
    }

    /// What the pixel under the pointer shows.
    fn under_pointer(&mut self, live_scene: &LiveScene) -> Option<Pick> {
        let (ready, camera, at) = (live_scene.ready()?, self.camera()?.clone(), self.clicks.at()?);
        let pixel = [0, 1].map(|i| ((at[i] * self.size[i] as f32) as u32).min(self.size[i] - 1));
        // Where the device has things, which is what is seen.
        let Ready { tracer, scene, placed, .. } = ready;
        let shown = raywarp::scene::Scene { instances: placed.clone(), ..ready.edits.scene().clone() };
        match Pick::at(tracer, &scene.meshes, &shown, &camera, self.size, pixel) {
            Ok(pick) => pick,
            Err(error) => (self.refuse(error), None).1,
        }
    }

    /// Picks something, or lets go of it.
    fn hold(&mut self, pick: Option<Pick>) {
        if self.pick != pick {
            self.pick = pick;
            self.ask(Lacks::Developing);
        }
    }

    /// Orbits about what is under the pointer.
    fn focus(&mut self, live_scene: &LiveScene) {
        let (pick, Some(control)) = (self.under_pointer(live_scene), &mut self.control) else { return };
        if let Some(pick) = pick {
            control.set_focus(pick.position);
            self.restart();
        }
    }

    fn frame_picked(&mut self, live_scene: &LiveScene) {
        let (Some(ready), Some(pick), Some(control)) = (live_scene.ready(), &self.pick, &mut self.control) else {
            return;
        };
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

    fn screenshot(&mut self, live_scene: &LiveScene) -> Option<Outcome> {
        let picture = match self.without_outline(live_scene.ready()?) {
            Ok(picture) => picture?,
            Err(error) => return (self.refuse(error), None).1,
        };
        let ticket = self.ticket()?;
        let content = Content::Picture(picture);
        Some(Outcome::File(Export { name: "raywarp.png".to_owned(), media_type: "image/png", content, ticket }))
    }

    fn save(&mut self, live_scene: &LiveScene) -> Option<Outcome> {
        let (ready, camera) = (live_scene.ready()?, self.camera()?.clone());
        let ticket = self.ticket()?;
        Some(Outcome::File(super::save::scene_file(live_scene, ready, &self.view_settings, camera, self.size, ticket)))
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
