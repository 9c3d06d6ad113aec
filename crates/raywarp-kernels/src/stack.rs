//! What is put aside for later: nodes while a ray descends, rays while another is followed.

use core::mem::MaybeUninit;

/// At most `N` items. A tree deeper than `N` is refused before it gets here.
pub(crate) struct Stack<T, const N: usize> {
    // Not initialised: on the GPU that would be `N` stores to memory for every ray.
    items: [MaybeUninit<T>; N],
    len: usize,
}

impl<T: Copy, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub fn new() -> Self {
        Self { items: [const { MaybeUninit::uninit() }; N], len: 0 }
    }

    /// An item beyond the last place is dropped. Trees are never that deep (`validate` sees to it); see `shade::whitted`
    /// for rays.
    #[inline(always)]
    pub fn push(&mut self, item: T) {
        if let Some(place) = self.items.get_mut(self.len) {
            place.write(item);
            self.len += 1;
        }
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// As [`push`](Self::push), then moves the item down, not below place `base`, as long as it is `before` the one below.
    #[inline(always)]
    pub fn insert(&mut self, item: T, base: usize, before: impl Fn(&T, &T) -> bool) {
        if self.len >= N {
            return;
        }
        let mut place = self.len;
        while place > base {
            // SAFETY: below the length, which is below `N`: an item is there.
            let below = unsafe { self.items.get_unchecked(place - 1).assume_init() };
            if !before(&below, &item) {
                break;
            }
            self.items[place].write(below);
            place -= 1;
        }
        self.items[place].write(item);
        self.len += 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: `push` wrote every item below the former length, which never exceeds `N`.
        Some(unsafe { self.items.get_unchecked(self.len).assume_init() })
    }
}
