//! Numbers drawn into a picture.

use super::Rgb8;

/// Columns of a digit, and rows.
pub(super) const SIZE: [u32; 2] = [3, 5];

/// Three bits a row, five rows, the upper left bit first.
const GLYPHS: [u16; 10] = [
    0b111_101_101_101_111,
    0b010_110_010_010_111,
    0b111_001_111_100_111,
    0b111_001_111_001_111,
    0b101_101_111_001_001,
    0b111_100_111_001_111,
    0b111_100_111_101_111,
    0b111_001_010_010_010,
    0b111_101_111_101_111,
    0b111_101_111_001_111,
];

/// Pixels that a number takes in a row, with each dot of a glyph `scale` pixels wide.
pub(super) fn width(number: u64, scale: u32) -> u32 {
    let digits = number.to_string().len() as u32;
    (digits * (SIZE[0] + 1) - 1) * scale
}

/// Draws a number in white with its upper left corner at a pixel; what lies outside of the picture is left out.
pub(super) fn draw(picture: &mut Rgb8, number: u64, [x, y]: [u32; 2], scale: u32) {
    for (place, digit) in number.to_string().bytes().enumerate() {
        let glyph = GLYPHS[usize::from(digit - b'0')];
        let left = x + place as u32 * (SIZE[0] + 1) * scale;
        for dot in (0..SIZE[0] * SIZE[1]).filter(|dot| glyph >> (SIZE[0] * SIZE[1] - 1 - dot) & 1 == 1) {
            square(picture, [left + dot % SIZE[0] * scale, y + dot / SIZE[0] * scale], scale);
        }
    }
}

fn square(picture: &mut Rgb8, [left, top]: [u32; 2], side: u32) {
    for y in top..(top + side).min(picture.height) {
        for x in left..(left + side).min(picture.width) {
            picture.pixels[y as usize * picture.width as usize + x as usize] = [255; 3];
        }
    }
}
