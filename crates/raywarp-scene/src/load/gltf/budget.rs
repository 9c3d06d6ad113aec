//! Memory in proportion to the file: many objects may point at the same bytes.

use super::super::LoadError;
use super::origin::Origin;

/// What decoded geometry may take for each byte of the file and its buffers. The most that an honest primitive takes is
/// about 20: a strip of one-byte indices makes a triangle of 16 bytes from each.
const BYTES_PER_BYTE: usize = 32;
/// What is allowed whatever the size of the file.
const FREE_BYTES: usize = 64 << 20;

/// Bytes that may still be allocated.
pub(super) struct Budget {
    left: usize,
    limit: usize,
    input: usize,
}

impl Budget {
    /// A budget for so many bytes of files.
    pub fn new(input: usize) -> Self {
        let limit = input.saturating_mul(BYTES_PER_BYTE).saturating_add(FREE_BYTES);
        Self { left: limit, limit, input }
    }

    /// Takes room for some elements, or says that there is none.
    pub fn take(&mut self, origin: Origin, count: usize, bytes_each: usize) -> Result<(), LoadError> {
        let left = count.checked_mul(bytes_each).and_then(|bytes| self.left.checked_sub(bytes));
        self.left = left.ok_or_else(|| {
            let (input, limit) = (self.input, self.limit);
            origin.too_large(format!("{input} bytes of files unfold to more than the limit of {limit} bytes"))
        })?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spent_bytes_do_not_come_back() {
        let origin = Origin { path: "f.glb".as_ref() };
        let mut budget = Budget { left: 10, limit: 10, input: 3 };
        assert!(budget.take(origin, 2, 4).is_ok());
        assert!(budget.take(origin, usize::MAX, 2).is_err());
        assert_eq!(
            budget.take(origin, 3, 1).unwrap_err().to_string(),
            "f.glb: 3 bytes of files unfold to more than the limit of 10 bytes. The file is damaged or made to exhaust \
             memory: export the model again."
        );
        assert!(budget.take(origin, 2, 1).is_ok());
    }
}
