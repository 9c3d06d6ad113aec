//! From what the link takes to the quality of pictures. What tracing, encoding and decoding take does not count: fewer
//! bytes would not help them.

use std::collections::VecDeque;
use std::time::Duration;

use super::pace::Delivery;

/// Bounds of the quality of JPEG.
const WORST: f32 = 40.0;
pub(super) const BEST: f32 = 90.0;
/// Smallest share of each side that is asked for.
const SMALLEST: f32 = 0.35;
/// Beyond the bare way there and back: within the first all is well, beyond the second something has to give.
const SMOOTH: f64 = 0.045;
const LATE: f64 = 0.090;
/// Most steps that one late picture counts for.
const MOST_STEPS: f64 = 4.0;
/// Round trips that the bare way is the shortest of.
const PINGS: usize = 32;

/// Follows a client's link. Quality of JPEG gives first, then the number of pixels; they recover in the other order, and
/// more slowly.
#[derive(Clone, Debug)]
pub struct Quality {
    jpeg: f32,
    scale: f32,
    late: bool,
    lag: f64,
    rate: f64,
    pings: VecDeque<f64>,
}

/// How to make pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Quality of JPEG, 40 to 90.
    pub jpeg: u8,
    /// Share of each side while the camera moves, up to 1.
    pub scale: f32,
    /// From the first byte of a picture to its acknowledgement, in milliseconds, averaged.
    pub lag_ms: f64,
    /// Of an empty message, in whole milliseconds: the least of the last ones.
    pub ping_ms: f64,
}

impl Default for Quality {
    fn default() -> Self {
        Self { jpeg: 75.0, scale: 1.0, late: false, lag: 0.0, rate: 2e6, pings: VecDeque::with_capacity(PINGS) }
    }
}

impl Quality {
    pub fn pinged(&mut self, round_trip: Duration) {
        if self.pings.len() == PINGS {
            self.pings.pop_front();
        }
        self.pings.push_back(round_trip.as_secs_f64());
    }

    /// A picture is shown, so long after its first byte was sent.
    pub fn shown(&mut self, time: Duration) {
        let time = time.as_secs_f64();
        self.lag = if self.lag == 0.0 { time } else { self.lag + 0.2 * (time - self.lag) };
    }

    pub fn delivered(&mut self, delivery: &Delivery) {
        if delivery.lossless {
            return;
        }
        let time = delivery.time.as_secs_f64();
        let rate = delivery.bytes as f64 / (time - self.way()).max(1e-3);
        self.rate += 0.2 * (rate - self.rate);
        let over = time - self.way();
        self.late = over > LATE;
        if self.late {
            self.yield_some((over / LATE).min(MOST_STEPS) as f32);
        } else if over < SMOOTH {
            self.recover();
        }
    }

    /// The later, the more: on a slow link pictures, and so steps, are few.
    fn yield_some(&mut self, steps: f32) {
        if self.jpeg > WORST {
            self.jpeg = (self.jpeg - 8.0 * steps).max(WORST);
        } else {
            self.scale = (self.scale * 0.85_f32.powf(steps)).max(SMALLEST);
        }
    }

    /// Whether the last picture was late: a second one under way would only wait behind it.
    pub fn is_late(&self) -> bool {
        self.late
    }

    fn recover(&mut self) {
        if self.scale < 1.0 {
            self.scale = (self.scale * 1.03).min(1.0);
        } else {
            self.jpeg = (self.jpeg + 1.0).min(BEST);
        }
    }

    /// The way there and back of an empty message, in seconds.
    fn way(&self) -> f64 {
        self.pings.iter().copied().reduce(f64::min).unwrap_or(0.0)
    }

    /// Bytes that may be under way besides pictures that the client waits for: about a tenth of a second's.
    pub fn window(&self) -> u64 {
        ((self.rate * (0.1 + self.way())) as u64).clamp(64 << 10, 4 << 20)
    }

    pub fn setting(&self) -> Setting {
        // In steps, as each change of size starts a picture anew.
        let scale = (self.scale * 8.0).round() / 8.0;
        // Whole: no two pings take the same time, and a page where nothing happens is not told of each.
        let ping_ms = (self.way() * 1e3).round();
        Setting { jpeg: self.jpeg as u8, scale, lag_ms: self.lag * 1e3, ping_ms }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(seconds: f64, count: usize, mut quality: Quality) -> Quality {
        for _ in 0..count {
            let time = Duration::from_secs_f64(seconds);
            quality.delivered(&Delivery { time, bytes: 100_000, lossless: false });
        }
        quality
    }

    #[test]
    fn it_yields_quality_then_pixels_and_gets_both_back() {
        let first = after(0.12, 3, Quality::default()).setting();
        assert!(first.jpeg < 60 && first.scale == 1.0, "{first:?}");
        let slow = after(0.5, 100, Quality::default());
        assert!(slow.is_late() && !after(0.01, 1, slow.clone()).is_late());
        assert_eq!((slow.setting().jpeg, slow.setting().scale), (40, 0.375));
        let better = after(0.01, 20, slow.clone()).setting();
        assert!(better.jpeg == 40 && better.scale > 0.5, "{better:?}");
        let well = after(0.01, 200, slow).setting();
        assert_eq!((well.jpeg, well.scale), (90, 1.0));
    }

    #[test]
    fn a_long_way_is_no_reason_to_yield() {
        let mut far = Quality::default();
        far.pinged(Duration::from_millis(300));
        far.pinged(Duration::from_millis(250));
        let setting = after(0.27, 100, far).setting();
        assert_eq!((setting.jpeg, setting.scale, setting.ping_ms), (90, 1.0, 250.0));
    }

    #[test]
    fn the_window_follows_the_rate() {
        assert_eq!(after(100.0, 100, Quality::default()).window(), 64 << 10);
        assert_eq!(after(0.0, 100, Quality::default()).window(), 4 << 20);
    }
}
