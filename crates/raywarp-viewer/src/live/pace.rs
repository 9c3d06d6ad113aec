//! How large a picture can be traced in the time of a frame.

/// Share of a frame's time that kernels may take: developing, fetching and showing need the rest.
const SHARE: f64 = 0.7;

/// Steps of the side of a picture, in shares of the whole one: a few sizes, so that films are kept.
const STEPS: f64 = 24.0;

/// A size that is so much off what time allows is still kept: no flicker between two sizes.
const SLACK: f64 = 1.12;

/// Chooses the size of moving pictures from the rate of the ones before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    step: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { step: STEPS }
    }
}

impl Pace {
    /// Seconds that kernels may take of a frame.
    pub fn budget(frame_rate: f32) -> f64 {
        SHARE / f64::from(frame_rate.max(1.0))
    }

    /// Columns and rows for a picture of `full` pixels, of which `rate` are traced in a second.
    pub fn size(&mut self, full: [u32; 2], rate: f64, frame_rate: f32) -> [u32; 2] {
        let pixels = f64::from(full[0]) * f64::from(full[1]);
        let share = (rate * Self::budget(frame_rate) / pixels.max(1.0)).sqrt();
        let wanted = (share * STEPS).clamp(1.0, STEPS);
        if wanted < self.step / SLACK || wanted > self.step * SLACK || wanted >= STEPS {
            self.step = wanted.floor();
        }
        full.map(|side| ((f64::from(side) * self.step / STEPS).round() as u32).max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_the_rate_and_fit_the_frame() {
        let full = [1920, 1080];
        for rate in [1.0, 1e4, 1e6, 3e7, 1e9, 1e12] {
            let mut pace = Pace::default();
            let [width, height] = pace.size(full, rate, 60.0);
            assert!((1..=1920).contains(&width) && (1..=1080).contains(&height));
            let seconds = f64::from(width) * f64::from(height) / rate;
            let smallest = [width, height] == [80, 45];
            assert!(smallest || seconds <= Pace::budget(60.0) * SLACK * SLACK, "{rate}: {width}x{height}");
            assert!(rate < 1e9 || [width, height] == full);
        }
    }

    #[test]
    fn small_changes_of_the_rate_do_not_change_the_size() {
        let mut pace = Pace::default();
        let size = pace.size([1920, 1080], 2e7, 60.0);
        for change in [0.95, 1.05, 0.9, 1.1] {
            assert_eq!(pace.size([1920, 1080], 2e7 * change, 60.0), size);
        }
    }

    #[test]
    fn a_picture_of_one_pixel_stays_one() {
        assert_eq!(Pace::default().size([1, 1], 1.0, 240.0), [1, 1]);
    }
}
