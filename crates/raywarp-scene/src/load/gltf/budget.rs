//! Memory in proportion to the file, as many objects may point at the same bytes; and within the scene's budget.

use super::super::LoadError;
use super::origin::Origin;
use crate::memory;

/// What decoded geometry may take for each byte of the file and its buffers. The most that an honest primitive takes is
/// about 20: a strip of one-byte indices makes a triangle of 16 bytes from each.
const BYTES_PER_BYTE: usize = 32;
/// What is allowed whatever the size of the file.
const FREE_BYTES: usize = 64 << 20;
/// What compressed streams may decode to for each byte of the file and its buffers. Smooth geometry takes a tenth of its
/// size; meshopt's first codec ends at a 64th.
const DECODED_BYTES_PER_BYTE: usize = 100;
/// What decoded geometry may take for each decoded byte: it is packed no more than an accessor, in which the smallest
/// vertices with all attributes have about 20 bytes.
const BYTES_PER_DECODED_BYTE: usize = 8;

/// Bytes that may still be allocated.
pub(super) struct Budget {
    left: usize,
    limit: usize,
    input: usize,
    decoded_left: usize,
    scene: memory::Budget,
}

impl Budget {
    /// A budget for so many bytes of files.
    pub fn new(input: usize, scene: memory::Budget) -> Self {
        let limit = input.saturating_mul(BYTES_PER_BYTE).saturating_add(FREE_BYTES);
        let decoded_left = input.saturating_mul(DECODED_BYTES_PER_BYTE).saturating_add(FREE_BYTES);
        Self { left: limit, limit, input, decoded_left, scene }
    }

    /// Bytes that may still be decoded.
    pub fn decoded_left(&self) -> usize {
        self.decoded_left.min(usize::try_from(self.scene.left()).unwrap_or(usize::MAX))
    }

    /// Takes room for some decoded elements, or says that there is none; what is made of them has room then, too.
    pub fn take_decoded(&mut self, origin: Origin, count: usize, bytes_each: usize) -> Result<(), LoadError> {
        let bytes = count.checked_mul(bytes_each).filter(|&bytes| bytes <= self.decoded_left);
        let bytes = bytes.ok_or_else(|| {
            let (input, left) = (self.input, self.decoded_left);
            origin.too_large(format!(
                "{input} bytes of files decode to {count} elements of {bytes_each} bytes, and {left} bytes are left for them"
            ))
        })?;
        self.scene
            .take(bytes as u64)
            .map_err(LoadError::memory(origin.path, "what its compressed streams decode to"))?;
        self.decoded_left -= bytes;
        let room = bytes.saturating_mul(BYTES_PER_DECODED_BYTE);
        (self.left, self.limit) = (self.left.saturating_add(room), self.limit.saturating_add(room));
        Ok(())
    }

    /// Takes room for some elements, or says that there is none.
    pub fn take(&mut self, origin: Origin, count: usize, bytes_each: usize) -> Result<(), LoadError> {
        let bytes = count.checked_mul(bytes_each).filter(|&bytes| bytes <= self.left).ok_or_else(|| {
            let (input, limit) = (self.input, self.limit);
            origin.too_large(format!("{input} bytes of files unfold to more than the limit of {limit} bytes"))
        })?;
        self.scene.take(bytes as u64).map_err(LoadError::memory(origin.path, "its geometry"))?;
        self.left -= bytes;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spent_bytes_do_not_come_back() {
        let origin = Origin { path: "f.glb".as_ref() };
        let mut budget = Budget { left: 10, limit: 10, ..Budget::new(3, memory::Budget::of(1 << 20)) };
        assert!(budget.take(origin, 2, 4).is_ok());
        assert!(budget.take(origin, usize::MAX, 2).is_err());
        assert_eq!(
            budget.take(origin, 3, 1).unwrap_err().to_string(),
            "f.glb: 3 bytes of files unfold to more than the limit of 10 bytes. The file is damaged or made to exhaust \
             memory: export the model again."
        );
        assert!(budget.take(origin, 2, 1).is_ok());
    }

    #[test]
    fn what_was_decoded_has_room() {
        let origin = Origin { path: "f.glb".as_ref() };
        let mut budget = Budget { left: 0, limit: 0, decoded_left: 10, ..Budget::new(3, memory::Budget::of(1 << 20)) };
        assert!(budget.take_decoded(origin, 2, 5).is_ok());
        assert!(budget.take(origin, 80, 1).is_ok() && budget.take(origin, 1, 1).is_err());
        assert_eq!(
            budget.take_decoded(origin, 1, 4).unwrap_err().to_string(),
            "f.glb: 3 bytes of files decode to 1 elements of 4 bytes, and 0 bytes are left for them. The file is damaged \
             or made to exhaust memory: export the model again."
        );
    }

    #[test]
    fn the_budget_of_the_scene_counts_too() {
        let origin = Origin { path: "f.glb".as_ref() };
        let scene = memory::Budget::of(100);
        let mut budget = Budget::new(3, scene.clone());
        assert!(budget.take(origin, 9, 10).is_ok() && budget.decoded_left() == 10);
        let error = budget.take(origin, 2, 6).unwrap_err();
        assert!(matches!(&error, LoadError::Memory { shortage, .. } if (shortage.needed, shortage.free) == (12, 10)));
        assert_eq!(error.to_string(), "f.glb: its geometry would not fit: 12 bytes of memory needed, 10 bytes free");
        assert!(matches!(budget.take_decoded(origin, 11, 1), Err(LoadError::Memory { .. })));
        assert_eq!(scene.left(), 10);
    }
}
