//! What is put aside for later: nodes while a ray descends, rays while another is followed.

use core::mem::MaybeUninit;

/// Room for at most `N` items, not initialised: on the GPU that would be `N` stores to memory for every ray.
///
/// It is apart from the [`Stack`] so that the stack's length stays in a register: an array that is indexed lies in
/// memory, with all of the object that it belongs to.
pub struct Storage<T, const N: usize>([MaybeUninit<T>; N]);

impl<T, const N: usize> Storage<T, N> {
    /// Without an item.
    #[inline(always)]
    pub fn new() -> Self {
        Self([const { MaybeUninit::uninit() }; N])
    }
}

impl<T, const N: usize> Default for Storage<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A stack within a [`Storage`].
pub struct Stack<'a, T, const N: usize> {
    items: &'a mut [MaybeUninit<T>; N],
    len: u32,
}

impl<'a, T: Copy, const N: usize> Stack<'a, T, N> {
    /// Without an item.
    #[inline(always)]
    pub fn new(storage: &'a mut Storage<T, N>) -> Self {
        Self { items: &mut storage.0, len: 0 }
    }

    /// An item beyond the last place is dropped. Trees are never that deep (`validate` sees to it); see `shade::whitted`
    /// for rays.
    #[inline(always)]
    pub fn push(&mut self, item: T) {
        if let Some(place) = self.items.get_mut(self.len as usize) {
            place.write(item);
            self.len += 1;
        }
    }

    /// Number of items.
    #[inline(always)]
    pub fn len(&self) -> u32 {
        self.len
    }

    /// Whether nothing is left.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// As [`push`](Self::push), then moves the item down, not below place `base`, as long as it is `before` the one below.
    #[inline(always)]
    pub fn insert(&mut self, item: T, base: u32, before: impl Fn(&T, &T) -> bool) {
        if self.len as usize >= N {
            return;
        }
        let mut place = self.len;
        while place > base {
            // SAFETY: below the length, which is below `N`: an item is there.
            let below = unsafe { self.items.get_unchecked(place as usize - 1).assume_init() };
            if !before(&below, &item) {
                break;
            }
            self.items[place as usize].write(below);
            place -= 1;
        }
        self.items[place as usize].write(item);
        self.len += 1;
    }

    /// The item that was put aside last; none where there is none left.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: `push` wrote every item below the former length, which never exceeds `N`.
        Some(unsafe { self.items.get_unchecked(self.len as usize).assume_init() })
    }
}
