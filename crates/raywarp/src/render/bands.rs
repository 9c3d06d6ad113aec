//! A picture cut into launches: long enough to fill the device, short enough to report on.

use raywarp_device::kernels::Pace;

use super::options::Window;

/// Rows of a band are a multiple of this, which is a multiple of every tile and block.
const ROWS: u32 = 16;

/// One launch: rows of the window, and samples of their pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Band {
    pub origin: [u32; 2],
    pub extent: [u32; 2],
    /// First, and one after the last.
    pub samples: [u32; 2],
}

impl Band {
    fn pixel_samples(&self) -> u64 {
        let [columns, rows] = self.extent.map(u64::from);
        columns * rows * u64::from(self.samples[1] - self.samples[0])
    }
}

/// Goes down the window; all samples of a band before the next one, each pixel's in order.
#[derive(Debug)]
pub(super) struct Bands {
    window: Window,
    spp: u32,
    row: u32,
    rows: u32,
    sample: u32,
    /// In pixel samples.
    pace: Pace,
    done: u64,
    /// Pixels of a launch where they are to be as many as that, however few samples.
    pixels: Option<u32>,
}

impl Bands {
    pub fn new(window: Window, spp: u32, gpu: bool) -> Self {
        Self { window, spp, row: 0, rows: 0, sample: 0, pace: Pace::new(gpu), done: 0, pixels: None }
    }

    /// The same in launches of about so many pixels where there are, with as few samples of each as suit.
    pub fn wide(window: Window, spp: u32, gpu: bool, pixels: u32) -> Self {
        Self { pixels: Some(pixels), ..Self::new(window, spp, gpu) }
    }

    /// The next launch; none when all is done.
    pub fn next(&mut self) -> Option<Band> {
        let [width, height] = self.window.extent;
        if self.sample == 0 {
            let fitting = match self.pixels {
                Some(pixels) => f64::from(pixels / width),
                None => self.pace.items() / (width as f64 * self.spp as f64),
            };
            self.rows = (fitting as u32 / ROWS * ROWS).clamp(ROWS, height.next_multiple_of(ROWS));
            self.rows = self.rows.min(height - self.row);
        }
        if self.rows == 0 {
            return None;
        }
        let pixels = width as u64 * self.rows as u64;
        let samples = ((self.pace.items() / pixels as f64) as u32).clamp(1, self.spp - self.sample);
        let band = Band {
            origin: [self.window.origin[0], self.window.origin[1] + self.row],
            extent: [width, self.rows],
            samples: [self.sample, self.sample + samples],
        };
        self.sample += samples;
        if self.sample == self.spp {
            (self.row, self.sample) = (self.row + self.rows, 0);
        }
        Some(band)
    }

    /// Learns from the seconds that a launch took.
    pub fn took(&mut self, band: &Band, seconds: f64) {
        self.done += band.pixel_samples();
        self.pace.took(band.pixel_samples(), seconds);
    }

    pub fn done(&self) -> u64 {
        self.done
    }

    pub fn total(&self) -> u64 {
        self.window.extent[0] as u64 * self.window.extent[1] as u64 * self.spp as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_of_every_pixel_is_taken_once_and_in_order() {
        for (extent, spp, seconds) in [([7, 5], 1, 0.1), ([640, 100], 9, 0.4), ([33, 17], 1000, 3.0), ([1, 1], 1, 0.0)]
        {
            let window = Window { origin: [3, 4], extent };
            for mut bands in [Bands::new(window, spp, false), Bands::wide(window, spp, true, 2000)] {
                let mut next_sample = vec![0; extent[1] as usize];
                while let Some(band) = bands.next() {
                    assert_eq!((band.origin[0], band.extent[0]), (3, extent[0]));
                    for row in band.origin[1] - 4..band.origin[1] - 4 + band.extent[1] {
                        assert_eq!(next_sample[row as usize], band.samples[0]);
                        next_sample[row as usize] = band.samples[1];
                    }
                    bands.took(&band, seconds);
                }
                assert!(next_sample.iter().all(|&s| s == spp));
                assert_eq!(bands.done(), bands.total());
            }
        }
    }
}
