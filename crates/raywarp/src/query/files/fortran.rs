//! Arrays in Fortran order: the first index runs fastest, and the numbers of a ray lie far apart.

use std::io::{BufRead, Read};

use super::error::{At, Trouble};

/// Such an array, of which rays are taken in C order, the last axis of the batch first. It is read whole.
pub struct Fortran {
    /// Length of each axis of the batch.
    shape: Vec<u64>,
    /// Where the next ray is on each.
    place: Vec<u64>,
    /// Bytes of a number.
    item: usize,
    bytes: Vec<u8>,
}

impl Fortran {
    /// Of a batch of such a shape, in numbers of `item` bytes. Nothing is read yet.
    pub fn new(shape: &[u64], item: usize) -> Self {
        Self { shape: shape.to_vec(), place: vec![0; shape.len()], item, bytes: Vec::new() }
    }

    /// Reads what is not read yet of the `len` bytes of the array, which begin at byte `start`.
    pub fn load(&mut self, input: &mut dyn BufRead, start: u64, len: u64) -> Result<(), Trouble> {
        let missing = len - self.bytes.len() as u64;
        // Grows with what there is: what the head promises may not come.
        if missing > 0 && (input.take(missing).read_to_end(&mut self.bytes)? as u64) < missing {
            let read = self.bytes.len() as u64;
            let what = format!("the data end here, {read} bytes of {len}");
            return Err(Trouble::flaw(At::Byte(start + read), what));
        }
        Ok(())
    }

    /// Appends the numbers of the next ray, `columns` of them. There is one, and the array is loaded.
    pub fn next(&mut self, columns: usize, raw: &mut Vec<u8>) {
        let (mut first, mut stride) = (0, 1);
        for (axis, place) in self.shape.iter().zip(&self.place) {
            first += place * stride;
            stride *= axis;
        }
        for column in 0..columns as u64 {
            let at = (first + column * stride) as usize * self.item;
            raw.extend_from_slice(&self.bytes[at..at + self.item]);
        }
        for (axis, place) in self.shape.iter().zip(&mut self.place).rev() {
            *place += 1;
            if *place < *axis {
                break;
            }
            *place = 0;
        }
    }
}
