//! Lines over a picture.

/// A straight line with soft sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// In pixels from the upper left corner; finite, and at most a few pixels beside the picture.
    pub ends: [[f32; 2]; 2],
    pub color: [u8; 3],
    /// In pixels.
    pub width: f32,
    /// How much it hides, from 0 to 1.
    pub strength: f32,
}

/// Some whole rows of a picture.
pub(super) struct Band<'a> {
    /// Four bytes each, the first three of which are drawn on.
    pub pixels: &'a mut [u8],
    /// Pixels in a row.
    pub columns: usize,
    /// Which row of the picture comes first.
    pub first: usize,
}

impl Line {
    /// Draws what is in a band. Cut into bands in any way, the picture is the same.
    ///
    /// Along its main direction a line takes each pixel whose middle it passes, up to but without its end: of lines that
    /// follow each other, only one takes it. Across, it takes as much of a pixel as it covers of the pixel's middle.
    pub fn draw(&self, band: &mut Band) {
        let [from, to] = self.ends;
        let [columns, rows] = band.extent();
        // Most lines are in few bands; a line is at most so much wider along an axis than across.
        let reach = 1.0 + self.width;
        if from[1].max(to[1]) + reach < rows[0] as f32 || from[1].min(to[1]) - reach > rows[1] as f32 {
            return;
        }
        let is_steep = (to[1] - from[1]).abs() > (to[0] - from[0]).abs();
        // `u` runs along the line, `v` across.
        let (u, v) = if is_steep { (1, 0) } else { (0, 1) };
        let [from, to] = if from[u] <= to[u] { [from, to] } else { [to, from] };
        if from[u] >= to[u] {
            return;
        }
        let slope = (to[v] - from[v]) / (to[u] - from[u]);
        let half = 0.5 * self.width * (1.0 + slope * slope).sqrt();
        let extent = [columns, rows];
        for along in pixels(near([from[u], to[u]], from[v], slope, extent[v], half), extent[u]) {
            let middle = from[v] + slope * (along as f32 + 0.5 - from[u]);
            let (low, high) = (middle - half, middle + half);
            // Cut towards zero: a pixel too many at either end is not covered. Rounding would be a call of a function.
            for across in whole([low, high + 1.0], extent[v]) {
                let covered = high.min(across as f32 + 1.0) - low.max(across as f32);
                let [column, row] = if is_steep { [across, along] } else { [along, across] };
                band.blend(column, row, self.color, self.strength * covered.clamp(0.0, 1.0));
            }
        }
    }
}

/// The part of a line from `u[0]` to `u[1]`, at `v` there, that may reach into an extent across it: cut off between the
/// middles of pixels.
fn near(u: [f32; 2], v: f32, slope: f32, extent: [usize; 2], half: f32) -> [f32; 2] {
    let [low, high] = [extent[0] as f32 - half - 1.0, extent[1] as f32 + half + 1.0];
    if slope == 0.0 {
        return if low <= v && v <= high { u } else { [0.0, 0.0] };
    }
    let crossings = [low, high].map(|bound| u[0] + (bound - v) / slope);
    let [first, last] = if slope > 0.0 { crossings } else { [crossings[1], crossings[0]] };
    [u[0].max(first.floor() - 1.0), u[1].min(last.ceil() + 1.0)]
}

/// Pixels of an extent whose middles are in a half-open range.
fn pixels(range: [f32; 2], extent: [usize; 2]) -> std::ops::Range<usize> {
    whole(range.map(|x| (x - 0.5).ceil()), extent)
}

/// What an extent and a range, each end cut towards zero, have in common.
fn whole(range: [f32; 2], extent: [usize; 2]) -> std::ops::Range<usize> {
    let [first, end] = range.map(|x| (x as i32).max(0) as usize);
    first.max(extent[0])..end.min(extent[1])
}

impl Band<'_> {
    /// First and end of its columns, and of its rows.
    fn extent(&self) -> [[usize; 2]; 2] {
        let rows = self.pixels.len() / (4 * self.columns.max(1));
        [[0, self.columns], [self.first, self.first + rows]]
    }

    /// Mixes a share of a colour into a pixel within the extent.
    fn blend(&mut self, column: usize, row: usize, color: [u8; 3], share: f32) {
        let at = 4 * ((row - self.first) * self.columns + column);
        let share = (256.0 * share) as u32;
        let Some(pixel) = self.pixels.get_mut(at..at + 4).and_then(|bytes| <&mut [u8; 4]>::try_from(bytes).ok()) else {
            return;
        };
        let [r, g, b] = color;
        let (new, old) = (u32::from_le_bytes([r, g, b, 0]), u32::from_le_bytes(*pixel));
        // Red and blue at once: neither reaches the other, as the shares add up to 256.
        let mixed = |mask: u32| ((new & mask) * share + (old & mask) * (256 - share)) >> 8 & mask;
        *pixel = (mixed(0x00ff_00ff) | mixed(0x0000_ff00) | old & 0xff00_0000).to_le_bytes();
    }
}
