//! Structures of the host, lent to the kernels' traversal.

use std::marker::PhantomData;

use raywarp_core::ray::Ray;
use raywarp_core::traversal::{Counter, Structure, Visitor};
use raywarp_core::view::View;

/// A kernels' structure whose views point into arrays that are borrowed for `'a`.
#[derive(Clone, Copy, Debug)]
pub struct Borrowed<'a, S> {
    structure: S,
    arrays: PhantomData<&'a ()>,
}

impl<'a, S: Structure> Borrowed<'a, S> {
    /// Of views made by [`lend`] from arrays that live for `'a`.
    pub(super) fn new(structure: S) -> Self {
        Self { structure, arrays: PhantomData }
    }

    /// Of views that others made.
    ///
    /// # Safety
    /// They point into arrays that live for `'a`, and the indices there are in range.
    pub unsafe fn of(structure: S) -> Self {
        Self::new(structure)
    }

    /// The structure itself, for a kernel's parameters.
    ///
    /// # Safety
    /// Nothing traverses it or a copy of it after `'a`.
    pub unsafe fn get(self) -> S {
        self.structure
    }
}

impl<S: Structure> Structure for Borrowed<'_, S> {
    const NAME: &'static str = S::NAME;
    type Space = S::Space;

    #[inline(always)]
    fn traverse(&self, ray: &Ray, counter: &mut impl Counter, visitor: &mut impl Visitor) {
        self.structure.traverse(ray, counter, visitor)
    }
}

/// A view of a slice of the host. Builders keep every array below 2^32 items.
pub(super) fn lend<T: Copy>(items: &[T]) -> View<T> {
    debug_assert!(u32::try_from(items.len()).is_ok());
    // SAFETY: the slice is valid, and `Borrowed` keeps it borrowed while safe code can reach the view. Its indices are
    // right because only this module's builders fill the arrays.
    unsafe { View::new(items.as_ptr(), items.len() as u32) }
}
