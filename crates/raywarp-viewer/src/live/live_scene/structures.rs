//! The structure that rays go through: a better one when there is time, one that can follow what moves.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

use raywarp::accel::{AccelKind, Build};
use raywarp::device_scene::Structure;

use super::beside::{take, Beside};
use super::{prepare, LiveScene, Ready};
use crate::live::edits::Touched;
use crate::ViewerError;

/// Nothing has moved for so long: worth a good tree.
const REST: Duration = Duration::from_millis(700);

/// A structure under way.
pub(super) struct Building {
    pub work: Beside<Result<Structure, ViewerError>>,
    pub what: Build,
    /// Of the motion it was begun at; none for one that takes over from whatever cannot move.
    pub shape: Option<u64>,
    /// The same, of materials.
    pub materials: u64,
}

/// What has moved on the device, or should.
#[derive(Default)]
pub(super) struct Motion {
    /// Grows with each change of the triangles.
    pub shape: u64,
    /// Instances that the device still has at their old places.
    pub pending: BTreeSet<usize>,
    /// Whether the structure does not know which triangles let light through.
    pub stale: bool,
    /// Grows with each change of materials, of which only they know whether it lets light through.
    pub materials: u64,
    /// Whether boxes were refitted since the structure was built.
    pub refitted: bool,
    pub last: Option<Instant>,
}

impl LiveScene {
    /// Takes over a structure that is done, if its triangles are still those of the scene.
    pub(super) fn take_structure(&mut self) -> Result<(), ViewerError> {
        let Some(building) = self.building.take() else { return Ok(()) };
        let Building { work, what, shape, materials } = building;
        let mut place = Some(work);
        let Some(done) = take(&mut place, || ViewerError::Lost("building a tree")) else {
            self.building = place.map(|work| Building { work, what, shape, materials });
            return Ok(());
        };
        let wanted = self.wanted();
        let Some(ready) = &mut self.ready else { return Ok(()) };
        let structure = match done.and_then(|result| result) {
            Ok(structure) => structure,
            Err(error) => {
                // Another try would end the same way: what there is has to do.
                (self.motion.refitted, self.chosen) = (false, Some(built(ready)));
                return Err(error);
            }
        };
        match shape {
            Some(shape) => {
                let is_new = shape == self.motion.shape && materials == self.motion.materials;
                let is_wanted = wanted.is_some_and(|wanted| same(what, wanted));
                if is_new && is_wanted {
                    let triangles = structure.triangles();
                    let before = ready.tracer.scene_mut()?.replace(structure);
                    // One that was flat for a while is missing in a tree of that time.
                    self.edition += u64::from(shape > 0 && before.triangles() != triangles);
                    (self.motion.refitted, self.trees) = (false, self.trees + 1);
                }
                Ok(())
            }
            None => {
                drop(ready.tracer.scene_mut()?.replace(structure));
                self.motion.stale &= materials != self.motion.materials;
                (self.edition, self.trees) = (self.edition + 1, self.trees + 1);
                self.follow()
            }
        }
    }

    /// Begins to build a better structure, where one is wanted and nothing moves.
    pub(super) fn improve(&mut self) -> Result<(), ViewerError> {
        let rests = self.motion.last.is_none_or(|last| last.elapsed() > REST);
        let settled = self.motion.pending.is_empty() && !self.motion.stale;
        let (Some(ready), Some(wanted)) = (&self.ready, self.wanted()) else { return Ok(()) };
        if ready.tracer.scene().structure().has_instances() {
            return Ok(());
        }
        let as_wanted = same(built(ready), wanted);
        if self.building.is_none() && rests && settled && (!as_wanted || self.motion.refitted) {
            // A tree of a scene that somebody arranges is seen once.
            let what = Build { cached: wanted.cached && self.motion.shape == 0, ..wanted };
            self.build(what, Some(self.motion.shape));
        }
        Ok(())
    }

    /// Builds a structure over the triangles as the device has them.
    fn build(&mut self, what: Build, shape: Option<u64>) {
        let Some(ready) = &self.ready else { return };
        let (scene, device) = (Arc::clone(&ready.scene), self.device.clone());
        let (instances, materials) = (ready.placed.clone(), ready.edits.scene().materials.clone());
        let work = Beside::start(move || prepare::structure(&scene, &instances, &materials, &device, what));
        self.building = Some(Building { work, what, shape, materials: self.motion.materials });
    }

    /// Brings what people changed to the device. Failures become a notice.
    pub(in crate::live) fn bring(&mut self, touched: &[Touched]) {
        if let Err(error) = self.change(touched) {
            self.fail(error);
        }
    }

    fn change(&mut self, touched: &[Touched]) -> Result<(), ViewerError> {
        let Some(ready) = &mut self.ready else { return Ok(()) };
        let edited = ready.edits.scene();
        for touched in touched {
            match *touched {
                Touched::Lights => {
                    if !ready.tracer.scene_mut()?.set_lights(edited) {
                        ready.tracer.scene_mut()?.set_materials(&edited.materials, &ready.scene.images)?;
                    }
                }
                Touched::Materials => {
                    // Whether the built-in lights are needed depends on what glows.
                    ready.tracer.scene_mut()?.set_lights(edited);
                    let known = ready.tracer.scene_mut()?.set_materials(&edited.materials, &ready.scene.images)?;
                    self.motion.stale |= !known;
                    self.motion.materials += 1;
                }
                Touched::Instance(index) => _ = self.motion.pending.insert(index),
            }
        }
        self.edition += u64::from(!touched.is_empty());
        self.follow()
    }

    /// Moves what should have moved, or has a structure built that can.
    fn follow(&mut self) -> Result<(), ViewerError> {
        if self.motion.pending.is_empty() && !self.motion.stale {
            return Ok(());
        }
        self.motion.shape += 1;
        self.motion.last = Some(Instant::now());
        let Some(ready) = &mut self.ready else { return Ok(()) };
        let is_instanced = ready.tracer.scene().structure().has_instances();
        if is_instanced && self.motion.stale {
            self.reload();
            return Ok(());
        }
        let follows = matches!(ready.tracer.scene().structure().kind, Some(AccelKind::Bvh2 | AccelKind::Bvh));
        if !is_instanced && (self.motion.stale || !follows) {
            if self.building.as_ref().is_none_or(|building| building.shape.is_some()) {
                self.build(prepare::movable(), None);
            }
            return Ok(());
        }
        let instances = &ready.edits.scene().instances;
        let moved: Vec<usize> = std::mem::take(&mut self.motion.pending).into_iter().collect();
        if !ready.tracer.scene_mut()?.move_instances(&ready.scene, instances, &moved)? {
            // Something has to be in world space now, or no longer: everything is made anew.
            self.reload();
            return Ok(());
        }
        moved.into_iter().for_each(|index| ready.placed[index].clone_from(&instances[index]));
        (self.motion.refitted, self.edition, self.trees) = (!is_instanced, self.edition + 1, self.trees + 1);
        Ok(())
    }

    /// Asks for another structure.
    pub(in crate::live) fn choose(&mut self, what: Build) {
        self.chosen = Some(what);
        if self.ready.as_ref().is_some_and(|ready| ready.tracer.scene().structure().has_instances()) {
            return self.reload();
        }
        if let Err(error) = self.follow() {
            self.fail(error);
        }
    }

    /// The structure that is wanted, once there is a scene.
    fn wanted(&self) -> Option<Build> {
        self.chosen.or(self.ready.as_ref().map(|ready| ready.first))
    }

    /// The structure that is wanted, and the one that was at first.
    pub(in crate::live) fn builds(&self) -> [Build; 2] {
        let first = self.ready.as_ref().map(|ready| ready.first).unwrap_or_default();
        [self.chosen.unwrap_or(first), first]
    }
}

/// Whether two builds come to the same structure.
fn same(a: Build, b: Build) -> bool {
    (a.kind, a.quality) == (b.kind, b.quality)
}

/// The structure that there is.
fn built(ready: &Ready) -> Build {
    let structure = ready.tracer.scene().structure();
    Build { kind: structure.kind.unwrap_or_default(), quality: structure.quality, ..Build::default() }
}
