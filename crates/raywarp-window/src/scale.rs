//! A picture scaled to the size of the window.
//!
//! Bilinear: while the camera moves the picture is small, and its pixels blown up to squares would crawl along every
//! edge. Weights are whole numbers of 1/256, and all four bytes of a pixel are weighed in two multiplications.

use raywarp_viewer::live::Picture;

/// How a picture is spread over columns and rows of a window.
pub struct Scaling<'a> {
    texels: &'a [u8],
    size: [usize; 2],
    shown: [usize; 2],
    columns: Vec<Tap>,
}

/// Two neighbours, and what the second of them weighs, of 256.
#[derive(Clone, Copy)]
struct Tap {
    first: usize,
    second: usize,
    weight: u32,
}

impl Tap {
    /// For pixel `i` of `shown` that show `size`.
    fn new(i: usize, shown: usize, size: usize) -> Self {
        let last = size.saturating_sub(1);
        let place = ((i as f64 + 0.5) * size as f64 / shown as f64 - 0.5).clamp(0.0, last as f64);
        let first = place as usize;
        Self { first, second: (first + 1).min(last), weight: ((place - first as f64) * 256.0) as u32 }
    }
}

impl<'a> Scaling<'a> {
    /// Of a picture to `shown` pixels; nothing if the picture has none or not as many as it says.
    pub fn new(picture: &'a Picture, shown: [usize; 2]) -> Option<Self> {
        let size = picture.size.map(|side| side as usize);
        let whole = size.iter().all(|&side| side > 0) && picture.rgba.len() == 4 * size[0] * size[1];
        whole.then(|| Self {
            texels: &picture.rgba,
            size,
            shown,
            columns: (0..shown[0]).map(|x| Tap::new(x, shown[0], size[0])).collect(),
        })
    }

    /// Fills row `y` of the window with `0x00RRGGBB`. `between` is room for one row of the picture.
    pub fn row(&self, y: usize, row: &mut [u32], between: &mut Vec<u32>) {
        let texels = |row: usize| {
            let bytes = &self.texels[4 * row * self.size[0]..4 * (row + 1) * self.size[0]];
            bytes.chunks_exact(4).map(|p| u32::from_be_bytes([0, p[0], p[1], p[2]]))
        };
        if self.size == self.shown {
            row.iter_mut().zip(texels(y)).for_each(|(pixel, texel)| *pixel = texel);
            return;
        }
        let tap = Tap::new(y, self.shown[1], self.size[1]);
        between.clear();
        between.extend(texels(tap.first).zip(texels(tap.second)).map(|(a, b)| mix(a, b, tap.weight)));
        for (pixel, tap) in row.iter_mut().zip(&self.columns) {
            *pixel = mix(between[tap.first], between[tap.second], tap.weight);
        }
    }
}

/// Between two pixels, channel by channel, rounded down.
fn mix(a: u32, b: u32, weight: u32) -> u32 {
    const ODD: u32 = 0x00ff_00ff;
    let pair = |shift: u32| {
        let (a, b) = ((a >> shift) & ODD, (b >> shift) & ODD);
        ((a * (256 - weight) + b * weight) >> 8) & ODD
    };
    pair(0) | pair(8) << 8
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn picture(size: [u32; 2], pixel: impl Fn(u32, u32) -> [u8; 3]) -> Picture {
        let all = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let rgba = all.flat_map(|(x, y)| [pixel(x, y).as_slice(), &[255]].concat()).collect();
        Picture { size, rgba, settled: false }
    }

    fn scaled(picture: &Picture, shown: [usize; 2]) -> Vec<u32> {
        let scaling = Scaling::new(picture, shown).unwrap();
        let mut pixels = vec![0; shown[0] * shown[1]];
        let mut between = Vec::new();
        for (y, row) in pixels.chunks_mut(shown[0]).enumerate() {
            scaling.row(y, row, &mut between);
        }
        pixels
    }

    #[test]
    fn the_same_size_is_the_same_picture() {
        let pixels = scaled(&picture([3, 2], |x, y| [x as u8, y as u8, 9]), [3, 2]);
        assert_eq!(pixels, [0x000009, 0x010009, 0x020009, 0x000109, 0x010109, 0x020109]);
    }

    #[test]
    fn twice_the_size_lies_between_its_neighbours() {
        let pixels = scaled(&picture([2, 1], |x, _| [100 * x as u8, 0, 200]), [4, 2]);
        assert_eq!(pixels[..4], [0x0000c8, 0x1900c8, 0x4b00c8, 0x6400c8]);
        assert_eq!(pixels[..4], pixels[4..]);
    }

    #[test]
    fn a_picture_that_is_not_whole_is_none() {
        assert!(Scaling::new(&Picture::default(), [4, 4]).is_none());
        assert!(Scaling::new(&Picture { size: [2, 2], rgba: vec![0; 15], settled: true }, [4, 4]).is_none());
    }

    proptest! {
        #[test]
        fn no_size_leaves_the_range_of_the_picture(w in 1u32..9, h in 1u32..9, to in [1usize..40, 1usize..40], seed: u8) {
            let low = seed / 2;
            let original = picture([w, h], |x, y| [low + ((x * 7 + y * 13) % 90) as u8; 3]);
            for pixel in scaled(&original, to) {
                let channel = (pixel & 255) as u8;
                prop_assert!(pixel == u32::from_be_bytes([0, channel, channel, channel]));
                prop_assert!((low..low + 90).contains(&channel));
            }
        }
    }
}
