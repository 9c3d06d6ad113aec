//! The stage after shadow rays: light that nothing stood in the way of.

use super::Path;
use crate::kernels::Thread;
use crate::math::Vec3;
use crate::view::{View, ViewMut};

/// Light that a path gets if nothing stands in the way.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct {
    /// Radiance, as the picture has it.
    pub radiance: Vec3,
    /// Makes 16 bytes.
    pub unused: u32,
}

impl Direct {
    /// No light.
    pub const NONE: Self = Self { radiance: Vec3::ZERO, unused: 0 };
}

/// Adds to each path what its shadow ray brings.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AddLight {
    /// One a slot.
    pub direct: View<Direct>,
    /// 1 a slot where something stands in the way, else 0; empty where there are shares.
    pub occluded: View<u32>,
    /// What is left of the light, one a slot.
    pub shares: View<f32>,
    /// One a slot, read and written.
    pub paths: ViewMut<Path>,
}

impl AddLight {
    #[inline(always)]
    pub(crate) fn run(&self, thread: Thread) {
        let slot = thread.x;
        if slot >= self.direct.len() {
            return;
        }
        let direct = self.direct.load(slot).radiance;
        let share = if direct.is_zero() { 0.0 } else { self.share(slot) };
        if share == 0.0 {
            return;
        }
        // SAFETY: one thread a slot.
        if let Some(path) = unsafe { self.paths.get(slot) } {
            let path = Path { radiance: direct.mul_add(share, path.radiance), ..path };
            // SAFETY: one thread a slot.
            unsafe { self.paths.set(slot, path) };
        }
    }

    #[inline(always)]
    fn share(&self, slot: u32) -> f32 {
        if self.shares.is_empty() {
            (self.occluded.at(slot) == 0) as u32 as f32
        } else {
            self.shares.at(slot)
        }
    }
}
