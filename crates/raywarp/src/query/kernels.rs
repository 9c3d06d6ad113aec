//! The kernels of queries, over a structure whose type is not known where they are launched.

use std::any::Any;

use raywarp_core::kernels::{All, Closest, Count, Occluded};
use raywarp_core::ray::HitArrays;
use raywarp_core::traversal::QuantizedBvh2;
use raywarp_core::view::{View, ViewMut};
use raywarp_device::kernels::Launchable;

use crate::accel::Resident;
use crate::Ray;

/// A structure on a device, with a kernel for each question. What is dynamic ends where a kernel is launched: each is compiled
/// for its structure.
pub(crate) trait QueryKernels: Any + Send + Sync {
    /// See [`Closest`].
    fn closest(&self, rays: View<Ray>, hits: HitArrays) -> Box<dyn Launchable>;

    /// See [`Occluded`].
    fn occluded(&self, rays: View<Ray>, occluded: ViewMut<u32>) -> Box<dyn Launchable>;

    /// See [`Count`].
    fn count(&self, rays: View<Ray>, limit: u32, counts: ViewMut<u32>) -> Box<dyn Launchable>;

    /// See [`All`], whose hits go where `offsets` says.
    fn all(
        &self,
        rays: View<Ray>,
        offsets: View<u32>,
        limit: u32,
        counts: ViewMut<u32>,
        hits: HitArrays,
    ) -> Box<dyn Launchable>;

    /// See [`Resident::persistent`].
    fn quantized(&self) -> Option<QuantizedBvh2>;
}

impl<R: Resident> QueryKernels for R {
    fn closest(&self, rays: View<Ray>, hits: HitArrays) -> Box<dyn Launchable> {
        Box::new(Closest { structure: self.short(), rays, hits })
    }

    fn occluded(&self, rays: View<Ray>, occluded: ViewMut<u32>) -> Box<dyn Launchable> {
        Box::new(Occluded { structure: self.short(), rays, occluded })
    }

    fn count(&self, rays: View<Ray>, limit: u32, counts: ViewMut<u32>) -> Box<dyn Launchable> {
        Box::new(Count { structure: self.long(), rays, limit, counts })
    }

    fn all(
        &self,
        rays: View<Ray>,
        offsets: View<u32>,
        limit: u32,
        counts: ViewMut<u32>,
        hits: HitArrays,
    ) -> Box<dyn Launchable> {
        Box::new(All { structure: self.long(), rays, offsets, limit, counts, hits })
    }

    fn quantized(&self) -> Option<QuantizedBvh2> {
        self.persistent()
    }
}
