//! Choice among many by Walker's alias method (1974), in constant time.

use super::Pair;
use crate::view::View;

/// An item of a table.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AliasEntry {
    /// Below this share of the item's column it is the item itself, else the alias.
    pub share: f32,
    /// Index of the alias.
    pub alias: u32,
    /// Probability of the item, or a density for who makes the table.
    pub density: f32,
}

/// Items with their probabilities.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AliasTable {
    /// One an item.
    pub entries: View<AliasEntry>,
}

impl AliasTable {
    /// The item that a point of the unit square chooses from a table that is not empty, and a point of the unit square that is
    /// as random, given the choice.
    #[inline(always)]
    pub fn sample(&self, at: Pair) -> (u32, [f32; 2]) {
        let place = u64::from(at.x) * u64::from(self.entries.len());
        let column = (place >> 32) as u32;
        let (x, y) = (crate::sample::unit(place as u32), crate::sample::unit(at.y));
        let AliasEntry { share, alias, .. } = self.entries.at(column);
        if y < share {
            (column, [x, below_one(y / share)])
        } else {
            (alias, [x, below_one((y - share) / (1.0 - share))])
        }
    }

    /// Of an item.
    #[inline(always)]
    pub fn density(&self, item: u32) -> f32 {
        self.entries.at(item).density
    }
}

#[inline(always)]
fn below_one(x: f32) -> f32 {
    crate::arch::min(x, 1.0 - f32::EPSILON)
}
