//! Owen-scrambled Sobol points, one sequence over all samples of a picture in the order of a space-filling curve.
//!
//! Every pair of dimensions is the two-dimensional Sobol sequence, shuffled and scrambled by hashes of its own (Burley 2020,
//! "Practical hash-based Owen scrambling"; the hash is that of Laine and Karras with the constants of Vegdahl 2021). Samples
//! are counted along Morton's curve through the pixels, so that neighbouring pixels share out the unit square among
//! them as the samples of a pixel do (Ahmed and Wonka 2020, "Screen-space blue-noise diffusion of Monte Carlo sampling
//! error").

use crate::sample::combine;

/// Bits of the index of a sample: pixels of a tile and samples of a pixel together.
const BITS: u32 = 32;

/// Two dimensions of a sample, as 32-bit fractions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// First dimension, in units of 2^-32.
    pub x: u32,
    /// Second dimension.
    pub y: u32,
}

impl Pair {
    /// As numbers in [0, 1).
    #[inline(always)]
    pub fn point(self) -> [f32; 2] {
        [crate::sample::unit(self.x), crate::sample::unit(self.y)]
    }
}

/// The numbers of one sample of one pixel: they depend on nothing else, whoever computes them and when.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    index: u32,
    key: u32,
}

impl Sampler {
    /// Sample `sample` of `count` of a pixel.
    #[inline(always)]
    pub fn new(pixel: [u32; 2], sample: u32, count: u32, seed: u32) -> Self {
        let sample_bits = bits(count);
        let tile_bits = (BITS - sample_bits) / 2;
        let mask = (1 << tile_bits) - 1;
        let [x, y] = pixel;
        // Beyond the index's bits begins another tile, with a sequence of its own. With one sample a pixel there is one tile.
        let [tile_x, tile_y] = [x >> tile_bits, y >> tile_bits];
        let morton = spread(x & mask) | spread(y & mask) << 1;
        let index = if sample_bits < BITS { morton << sample_bits | sample } else { sample };
        Self { index, key: combine(combine(seed, tile_x), tile_y) }
    }

    /// The pair of dimensions of a number.
    #[inline(always)]
    pub fn pair(&self, number: u32) -> Pair {
        let key = combine(self.key, number);
        let index = permute(self.index.reverse_bits(), key).reverse_bits();
        let x = permute(index, combine(key, 1)).reverse_bits();
        let y = permute(pascal(index), combine(key, 2)).reverse_bits();
        Pair { x, y }
    }
}

/// Bits that numbers below `count` take.
#[inline(always)]
fn bits(count: u32) -> u32 {
    if count <= 1 {
        0
    } else {
        BITS - (count - 1).leading_zeros()
    }
}

/// The low 16 bits, with a zero above each.
#[inline(always)]
fn spread(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// Multiplies the bits by Pascal's triangle modulo 2, which generates the second dimension: bit j becomes the sum of all
/// bits i with "i over j" odd, that is those whose number has all the ones of j (Lucas).
#[inline(always)]
fn pascal(x: u32) -> u32 {
    let x = x ^ (x & 0xaaaa_aaaa) >> 1;
    let x = x ^ (x & 0xcccc_cccc) >> 2;
    let x = x ^ (x & 0xf0f0_f0f0) >> 4;
    let x = x ^ (x & 0xff00_ff00) >> 8;
    x ^ x >> 16
}

/// A permutation in which every bit depends on those below it alone: Owen's scrambling of a number with its bits reversed.
#[inline(always)]
fn permute(x: u32, key: u32) -> u32 {
    let x = x ^ x.wrapping_mul(0x3d20_adea);
    let x = x.wrapping_add(key);
    let x = x.wrapping_mul(key >> 16 | 1);
    let x = x ^ x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether every box of a partition of the square into `count` equal ones has one of as many points.
    fn is_stratified(points: &[Pair]) -> bool {
        let power = points.len().trailing_zeros();
        (0..=power).all(|columns| {
            let mut seen = vec![false; points.len()];
            points.iter().all(|point| {
                let column = if columns == 0 { 0 } else { point.x >> (32 - columns) };
                let row = if columns == power { 0 } else { point.y >> (32 - (power - columns)) };
                let cell = column as usize | (row as usize) << columns;
                !std::mem::replace(&mut seen[cell], true)
            })
        })
    }

    #[test]
    fn samples_of_a_pixel_have_one_in_every_elementary_interval() {
        for count in [1u32, 2, 4, 16, 64, 1024] {
            for number in 0..6 {
                let points: Vec<Pair> = (0..count).map(|i| Sampler::new([13, 7], i, count, 5).pair(number)).collect();
                assert!(is_stratified(&points), "{count} samples, pair {number}");
            }
        }
    }

    #[test]
    fn so_have_those_of_a_square_of_pixels() {
        for (side, count) in [(2u32, 1u32), (8, 1), (4, 4), (8, 16)] {
            let samples = (0..side * side).flat_map(|p| (0..count).map(move |i| (p, i)));
            let points: Vec<Pair> = samples
                .map(|(p, i)| Sampler::new([3 * side + p % side, 5 * side + p / side], i, count, 1).pair(2))
                .collect();
            assert!(is_stratified(&points), "{side}x{side} pixels, {count} samples");
        }
    }

    #[test]
    fn pairs_are_not_correlated() {
        let mean = |f: &dyn Fn(u32) -> (Pair, Pair)| {
            let products = (0..4096).map(|i| {
                let (a, b) = f(i);
                (a.point()[0] as f64 - 0.5) * (b.point()[0] as f64 - 0.5)
            });
            products.sum::<f64>() / 4096.0
        };
        let of = |i: u32, pair| Sampler::new([i % 64, i / 64], 0, 1, 0).pair(pair);
        // The standard deviation of such a mean of independent numbers is (1/12) / 64.
        let bound = 4.0 / 12.0 / 64.0;
        assert!(mean(&|i| (of(i, 0), of(i, 1))).abs() < bound);
        assert!(mean(&|i| (of(i, 3), of(i, 7))).abs() < bound);
    }

    #[test]
    fn any_count_of_samples_and_any_pixel_is_legal() {
        for count in [1, 3, 65_536, u32::MAX] {
            let [x, y] = Sampler::new([16_383, 9], count - 1, count, u32::MAX).pair(0).point();
            assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
        }
    }
}
