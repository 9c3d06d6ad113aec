//! Random numbers by key: the same for a pixel and a sample on every machine, whoever computes them and when.

use crate::math::{vec3, Vec3};

/// A well-mixed 32-bit hash (the finaliser found by Wellons' hash prospector, bias 0.17).
#[inline(always)]
pub fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

/// A key from two.
#[inline(always)]
pub fn combine(a: u32, b: u32) -> u32 {
    hash(a ^ hash(b).wrapping_add(0x9e37_79b9))
}

/// The bits as a number in [0, 1).
#[inline(always)]
pub fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Where `index` goes in a random order of `0..len`, chosen by `key`.
///
/// Steps that can be undone within the next power of two mix the index; what falls beyond `len` goes round again
/// (cycle walking), so the whole is a permutation.
#[inline(always)]
fn permute(index: u32, len: u32, key: u32) -> u32 {
    let mask = len.next_power_of_two() - 1;
    let half = (32 - mask.leading_zeros()).div_ceil(2);
    let mut i = index;
    loop {
        for round in 0..3 {
            let mixer = hash(key.wrapping_add(round));
            i = i.wrapping_mul(mixer | 1).wrapping_add(mixer >> 16) & mask;
            i ^= i >> half;
        }
        if i < len {
            return i;
        }
    }
}

/// Sample `index` of `count` in the unit square: correlated multi-jittered (Kensler 2013).
///
/// The samples of one key fall one in each of `count` rows, and, where they fill a near-square grid, one in each of its
/// cells and one in each of `count` columns.
/// A single sample is the centre, so that a picture of one sample a pixel is not jagged at random.
#[inline(always)]
pub fn stratified(index: u32, count: u32, key: u32) -> (f32, f32) {
    if count <= 1 {
        return (0.5, 0.5);
    }
    let columns = crate::arch::max(crate::arch::floor(crate::arch::sqrt(count as f32)), 1.0) as u32;
    let rows = count.div_ceil(columns);
    let index = permute(index, count, combine(key, 1));
    let shuffled_column = permute(index % columns, columns, combine(key, 2));
    let shuffled_row = permute(index / columns, rows, combine(key, 3));
    let jitter_x = unit(combine(index, combine(key, 4)));
    let jitter_y = unit(combine(index, combine(key, 5)));
    (
        (shuffled_column as f32 + (shuffled_row as f32 + jitter_x) / rows as f32) / columns as f32,
        // Of the index itself: the last row of the grid may be short, and must not count as a whole one.
        (index as f32 + jitter_y) / count as f32,
    )
}

/// A number in [0, 1) by key and dimension.
#[inline(always)]
pub fn number(key: u32, dimension: u32) -> f32 {
    unit(combine(key, dimension))
}

/// A unit vector, evenly over the sphere: a point of the unit disk, found by trying, lifted (Marsaglia 1972). That
/// needs no sine, which machines round differently.
#[inline(always)]
pub fn sphere(key: u32) -> Vec3 {
    let mut dimension = 3;
    loop {
        let (x, y) = (2.0 * number(key, dimension) - 1.0, 2.0 * number(key, dimension + 1) - 1.0);
        let square = x * x + y * y;
        if square < 1.0 {
            let lift = 2.0 * crate::arch::sqrt(1.0 - square);
            return vec3(x * lift, y * lift, 1.0 - 2.0 * square);
        }
        dimension += 2;
    }
}

/// A unit vector over the hemisphere about a unit normal, as often as its cosine is large: the sphere that touches the
/// surface from above, seen from the surface.
#[inline(always)]
pub fn cosine(normal: Vec3, key: u32) -> Vec3 {
    let chord = normal + sphere(key);
    // The point opposite the normal is where the sphere touches, and gives no direction.
    if chord.length() > 1e-3 {
        chord.normalize()
    } else {
        normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_are_permutations() {
        for len in 1..70 {
            for key in [0, 1, 77, 0xdead_beef] {
                let mut seen = vec![false; len as usize];
                (0..len).for_each(|i| seen[permute(i, len, key) as usize] = true);
                assert!(seen.iter().all(|&s| s), "len {len} key {key}");
            }
        }
    }

    #[test]
    fn samples_are_stratified_in_cells_and_in_both_projections() {
        for key in 0..50 {
            let points: Vec<_> = (0..16).map(|i| stratified(i, 16, hash(key))).collect();
            for project in [|(x, _): (f32, f32)| (x * 16.0) as usize, |(_, y): (f32, f32)| (y * 16.0) as usize] {
                let mut seen = [0; 16];
                points.iter().for_each(|&p| seen[project(p)] += 1);
                assert_eq!(seen, [1; 16], "key {key}");
            }
            let mut cells = [0; 16];
            points.iter().for_each(|&(x, y)| cells[(x * 4.0) as usize + 4 * (y * 4.0) as usize] += 1);
            assert_eq!(cells, [1; 16], "key {key}");
        }
    }

    #[test]
    fn any_count_is_stratified_in_rows_and_centred() {
        for count in [2, 3, 5, 7, 10, 32, 100] {
            let (mut mean_x, mut mean_y) = (0.0, 0.0);
            for key in 0..400 {
                let mut rows = vec![0; count as usize];
                for (x, y) in (0..count).map(|i| stratified(i, count, hash(key))) {
                    rows[(y * count as f32) as usize] += 1;
                    (mean_x, mean_y) = (mean_x + x as f64, mean_y + y as f64);
                }
                assert!(rows.iter().all(|&n| n == 1), "{count} samples of key {key}: {rows:?}");
            }
            let total = 400.0 * count as f64;
            // Three standard deviations of the mean of as many independent numbers; these are not, and do better.
            let bound = 3.0 * (1.0 / 12.0f64 / total).sqrt();
            assert!((mean_x / total - 0.5).abs() < bound, "{count}: {}", mean_x / total);
            assert!((mean_y / total - 0.5).abs() < bound, "{count}: {}", mean_y / total);
        }
    }

    #[test]
    fn any_count_stays_inside_the_pixel() {
        for count in 1..40 {
            for index in 0..count {
                let (x, y) = stratified(index, count, combine(9, count));
                assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y), "{index} of {count}: {x} {y}");
            }
        }
    }
}
