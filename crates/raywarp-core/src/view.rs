//! Arrays in the memory of the device that runs the kernel.

use crate::arch;

/// Read-only array: an address and a length, the same on host and device.
#[repr(C)]
#[derive(Debug)]
pub struct View<T> {
    address: *const T,
    len: u32,
}

impl<T> Clone for View<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for View<T> {}

// SAFETY: a view is a shared borrow of plain data, whose lifetime whoever launches a kernel vouches for.
unsafe impl<T: Sync> Send for View<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Sync for View<T> {}

impl<T: Copy> View<T> {
    /// No items.
    pub const EMPTY: Self = Self { address: core::ptr::null(), len: 0 };

    /// The array at an address of the device.
    ///
    /// # Safety
    /// `len` valid items lie there, and outlive every launch that the view is given to, unwritten. Whoever fills them
    /// vouches for the indices among them: kernels follow links without looking, so a structure is `validate`d first.
    pub unsafe fn new(address: *const T, len: u32) -> Self {
        Self { address, len }
    }

    /// Number of items.
    #[inline(always)]
    pub fn len(&self) -> u32 {
        self.len
    }

    /// Whether there are no items.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Where they are, in the memory of the device.
    pub fn address(&self) -> *const T {
        self.address
    }

    /// Some of the items, which whoever made the view vouches to be in range.
    #[inline(always)]
    pub fn part(&self, first: u32, len: u32) -> Self {
        debug_assert!(first.checked_add(len).is_some_and(|end| end <= self.len), "{len} from {first} of {}", self.len);
        Self { address: self.address.wrapping_add(first as usize), len }
    }

    /// The first items, at most so many.
    #[inline(always)]
    pub fn first(&self, len: u32) -> Self {
        Self { len: core::cmp::min(len, self.len), ..*self }
    }

    /// The item at `index`, which whoever made the view vouches to be in range.
    #[inline(always)]
    pub fn at(&self, index: u32) -> T {
        debug_assert!(index < self.len, "index {index} of {}", self.len);
        // SAFETY: `new` was promised valid items and that indices are in range.
        unsafe { *self.address.add(index as usize) }
    }

    /// The item at `index` where it lies: for large items of which only parts are read.
    #[inline(always)]
    pub fn item(&self, index: u32) -> &T {
        debug_assert!(index < self.len, "index {index} of {}", self.len);
        // SAFETY: as for `at`; nothing writes the items while a kernel runs.
        unsafe { &*self.address.add(index as usize) }
    }

    /// As [`at`](Self::at), by 128-bit loads; for items of 16-byte granules whose every bit pattern is valid.
    #[inline(always)]
    pub fn load(&self, index: u32) -> T {
        debug_assert!(index < self.len, "index {index} of {}", self.len);
        // SAFETY: as for `at`; `arch::load` checks the granules when it is compiled.
        unsafe { arch::load(arch::item(self.address, index)) }
    }

    /// Has the item at `index` brought closer, for another thread that will read it soon; nothing beyond the end.
    #[inline(always)]
    pub(crate) fn prefetch(&self, index: u32) {
        if index < self.len {
            arch::prefetch(self.address.wrapping_add(index as usize));
        }
    }

    /// As [`load`](Self::load), of a part of the item: what is not asked for is not read.
    #[inline(always)]
    pub fn load_part<P: Copy>(&self, index: u32, part: impl FnOnce(&T) -> &P) -> P {
        // SAFETY: the part is valid as the item is; `arch::load` checks the granules when it is compiled.
        unsafe { arch::load(part(self.item(index))) }
    }
}

/// Writable array, of which each thread writes only its own items.
#[repr(C)]
#[derive(Debug)]
pub struct ViewMut<T> {
    address: *mut T,
    len: u32,
}

impl<T> Clone for ViewMut<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for ViewMut<T> {}

// SAFETY: threads touch disjoint items, as every kernel promises, so sharing the array is sharing nothing.
unsafe impl<T: Send> Send for ViewMut<T> {}
// SAFETY: as above.
unsafe impl<T: Send> Sync for ViewMut<T> {}

impl<T: Copy> ViewMut<T> {
    /// No items: what is written is dropped.
    pub const EMPTY: Self = Self { address: core::ptr::null_mut(), len: 0 };

    /// The array at an address of the device.
    ///
    /// # Safety
    /// `len` valid items lie there, and outlive every launch that the view is given to, touched by nothing else.
    pub unsafe fn new(address: *mut T, len: u32) -> Self {
        Self { address, len }
    }

    /// Number of items.
    #[inline(always)]
    pub fn len(&self) -> u32 {
        self.len
    }

    /// Whether there are no items.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The first items, at most so many.
    #[inline(always)]
    pub fn first(&self, len: u32) -> Self {
        Self { len: core::cmp::min(len, self.len), ..*self }
    }

    /// The item at `index`, or nothing beyond the end.
    ///
    /// # Safety
    /// No other thread of the launch touches this index.
    #[inline(always)]
    pub unsafe fn get(&self, index: u32) -> Option<T> {
        // SAFETY: in range; exclusive by the caller's promise.
        (index < self.len).then(|| unsafe { *self.address.add(index as usize) })
    }

    /// Where the item at `index` is, for what several threads touch at once. Whoever made the view vouches that it is in
    /// range.
    #[inline(always)]
    pub fn shared(&self, index: u32) -> *mut T {
        debug_assert!(index < self.len, "index {index} of {}", self.len);
        // SAFETY: in range, as `new` was promised.
        unsafe { self.address.add(index as usize) }
    }

    /// Writes the item at `index`; nothing beyond the end.
    ///
    /// # Safety
    /// No other thread of the launch touches this index.
    #[inline(always)]
    pub unsafe fn set(&self, index: u32, value: T) {
        if index < self.len {
            // SAFETY: in range; exclusive by the caller's promise.
            unsafe { self.address.add(index as usize).write(value) }
        }
    }
}

/// Data that a device may hold: bytes without padding, of which every pattern is a value, zeros included.
///
/// # Safety
/// As the sentence says.
pub unsafe trait Plain: Copy + Send + Sync + 'static {}

macro_rules! plain {
    ($($item:ty),* $(,)?) => {$(
        // SAFETY: a `repr(C)` or primitive type of 4-byte numbers that fill it without gaps.
        unsafe impl Plain for $item {}
    )*};
}

plain!(
    u32,
    [u32; 2],
    f32,
    [f32; 2],
    [f32; 4],
    crate::build::node::Node,
    crate::build::survey::Findings,
    crate::bsdf::MetallicRoughness,
    crate::film::Pixel,
    crate::kernels::FirstHit,
    crate::light::Light,
    crate::material::Material,
    crate::math::Vec3,
    crate::ray::MeshHit,
    crate::ray::Ray,
    crate::sampling::AliasEntry,
    crate::surface::Instance,
    crate::surface::Primitive,
    crate::texture::Texture,
    crate::traversal::Tests,
    crate::traversal::bvh2::Node,
    crate::traversal::bvh2_quantized::Node,
    crate::traversal::two_level::Instance,
    crate::traversal::bvh8f::Block,
    crate::traversal::bvh8f::Node,
    crate::traversal::kdtree::KdPart,
    crate::traversal::kdtree::Node,
    crate::triangle::Triangle,
    crate::wavefront::Path,
    crate::wavefront::add_light::Direct,
);
