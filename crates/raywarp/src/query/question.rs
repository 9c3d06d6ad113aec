//! From a question to the launch of its kernel.

use raywarp_kernels::kernels::{All, Closest, Count, Kernel, Occluded};
use raywarp_kernels::traverse::Structure;
use raywarp_kernels::view::{View, ViewMut};

use super::{QueryError, RayCaster};
use crate::accel::with_any_structure;
use crate::backend::{Device, DeviceError, Launch, Stream};
use crate::{Hit, Ray};

/// What a kernel is asked, and where its answers go.
#[derive(Clone, Copy)]
pub enum Question {
    Find(Find),
    Collect(Collect),
}

/// What one traversal answers.
#[derive(Clone, Copy)]
pub enum Find {
    Closest { hits: ViewMut<Hit> },
    Any { blocked: ViewMut<u32> },
}

/// What looks at every hit.
#[derive(Clone, Copy)]
pub enum Collect {
    Count { limit: u32, counts: ViewMut<u32> },
    All { offsets: View<u32>, limit: u32, counts: ViewMut<u32>, hits: ViewMut<Hit> },
}

/// What answers can do. Not for other crates: kernels trust it.
pub trait Fill {
    /// Whether the buffers fit so many rays, on this device.
    fn check(&self, device: &Device, rays: u32) -> Result<(), QueryError>;

    /// What to ask.
    fn question(&mut self) -> Question;
}

impl RayCaster {
    /// Launches the kernel of a question.
    ///
    /// # Safety
    /// As for [`Device::launch`], until the launch has been waited for.
    pub(super) unsafe fn ask(
        &self,
        rays: View<Ray>,
        question: Question,
        stream: Option<&Stream>,
    ) -> Result<Launch, DeviceError> {
        let batch = Batch { device: self.device(), rays, stream };
        // SAFETY: the caller's promise.
        unsafe {
            match question {
                Question::Find(question) => {
                    with_any_structure!(self.structure(), structure => batch.find(structure, question))
                }
                // Long kernels already: of a tree in two layouts they know one.
                Question::Collect(question) => {
                    with_any_structure!(self.structure(), structure, both => both.compact, batch.collect(structure, question))
                }
            }
        }
    }
}

struct Batch<'a> {
    device: &'a Device,
    rays: View<Ray>,
    stream: Option<&'a Stream>,
}

impl Batch<'_> {
    /// # Safety
    /// As for [`Device::launch`], until the launch has been waited for.
    unsafe fn find<S: Structure>(&self, structure: S, question: Find) -> Result<Launch, DeviceError>
    where
        Closest<S>: Kernel,
        Occluded<S>: Kernel,
    {
        let rays = self.rays;
        // SAFETY: the caller's promise, for each of them.
        unsafe {
            match question {
                Find::Closest { hits } => self.run(&Closest { structure, rays, hits }),
                Find::Any { blocked } => self.run(&Occluded { structure, rays, occluded: blocked }),
            }
        }
    }

    /// # Safety
    /// As for [`Device::launch`], until the launch has been waited for.
    unsafe fn collect<S: Structure>(&self, structure: S, question: Collect) -> Result<Launch, DeviceError>
    where
        Count<S>: Kernel,
        All<S>: Kernel,
    {
        let rays = self.rays;
        // SAFETY: the caller's promise, for each of them.
        unsafe {
            match question {
                Collect::Count { limit, counts } => self.run(&Count { structure, rays, limit, counts }),
                Collect::All { offsets, limit, counts, hits } => {
                    self.run(&All { structure, rays, offsets, limit, counts, hits })
                }
            }
        }
    }

    /// # Safety
    /// As for [`Device::launch`], until the launch has been waited for.
    unsafe fn run(&self, kernel: &impl Kernel) -> Result<Launch, DeviceError> {
        let extent = [self.rays.len(), 1];
        match self.stream {
            // SAFETY: the caller's promise.
            Some(stream) => unsafe { stream.launch(kernel, extent) },
            // SAFETY: the caller's promise.
            None => unsafe { self.device.launch(kernel, extent) }.map(Launch::done),
        }
    }
}
