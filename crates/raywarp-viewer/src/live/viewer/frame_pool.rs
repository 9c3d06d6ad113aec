//! Pictures that were shown, and their memory for the next ones: fresh memory costs more than the copy into it.

use std::sync::Arc;

use rayon::prelude::*;

use super::Picture;

/// Front ends hold on to one picture while they make the next one theirs, and one may be on its way.
const KEPT: usize = 3;

/// Pixels that a thread copies at once.
const PART: usize = 1 << 16;

/// The last picture, and those before it.
#[derive(Default)]
pub(super) struct FramePool {
    shown: Option<Arc<Picture>>,
    before: Vec<Arc<Picture>>,
}

impl FramePool {
    /// The last picture.
    pub fn shown(&self) -> Option<Arc<Picture>> {
        self.shown.clone()
    }

    /// Takes the next one.
    pub fn show(&mut self, picture: Picture) -> Arc<Picture> {
        let picture = Arc::new(picture);
        self.before.extend(self.shown.replace(Arc::clone(&picture)));
        if self.before.len() > KEPT {
            self.before.remove(0);
        }
        picture
    }

    /// Bytes of pixels, the lowest first.
    pub fn bytes(&mut self, pixels: &[u32]) -> Vec<u8> {
        let mut bytes = self.unused();
        bytes.resize(4 * pixels.len(), 0);
        bytes.par_chunks_mut(4 * PART).zip(pixels.par_chunks(PART)).for_each(|(to, from)| {
            to.chunks_exact_mut(4).zip(from).for_each(|(to, pixel)| to.copy_from_slice(&pixel.to_le_bytes()));
        });
        bytes
    }

    /// The bytes of a picture that nobody else holds.
    fn unused(&mut self) -> Vec<u8> {
        let index = self.before.iter().position(|picture| Arc::strong_count(picture) == 1);
        let picture = index.map(|index| self.before.remove(index));
        picture.and_then(Arc::into_inner).map(|picture| picture.rgba).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(rgba: Vec<u8>) -> Picture {
        Picture { size: [1, rgba.len() as u32 / 4], rgba, settled: false }
    }

    #[test]
    fn memory_is_used_again_once_nobody_looks() {
        let mut pool = FramePool::default();
        let first = pool.bytes(&[0x0403_0201; 9]);
        assert_eq!(first[..5], [1, 2, 3, 4, 1]);
        let at = first.as_ptr();
        let held = pool.show(picture(first));
        pool.show(picture(vec![7; 36]));
        let other = pool.bytes(&[5; 9]);
        assert_ne!(other.as_ptr(), at, "somebody holds the first");
        assert_eq!(held.rgba[..4], [1, 2, 3, 4]);
        drop(held);
        let again = pool.bytes(&[5; 3]);
        assert_eq!((again.as_ptr(), again.as_slice()), (at, &[5, 0, 0, 0].repeat(3)[..]));
        assert_eq!(pool.shown().unwrap().rgba[0], 7);
    }

    #[test]
    fn pictures_that_are_all_held_are_not_kept_for_ever() {
        let mut pool = FramePool::default();
        let _held: Vec<_> = (0..20).map(|_| pool.show(picture(vec![0; 4]))).collect();
        assert_eq!(pool.before.len(), KEPT);
    }
}
