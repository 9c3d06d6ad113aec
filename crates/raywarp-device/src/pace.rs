//! How much work to launch at once: enough to fill the device, little enough to report on.

/// Seconds that a launch should take: two of them, one that runs and one that waits, are over within 0.2 s.
const TARGET: f64 = 0.08;

/// Items of the first launch: nothing is known yet.
const FIRST_ON_CPU: f64 = 65_536.0;
const FIRST_ON_GPU: f64 = 4_194_304.0;

/// Learns from each launch how large the next should be.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    items: f64,
}

impl Pace {
    /// For the CPU or a GPU, of which nothing is known yet.
    pub fn new(gpu: bool) -> Self {
        Self { items: if gpu { FIRST_ON_GPU } else { FIRST_ON_CPU } }
    }

    /// Items that the next launch should have, at least one.
    pub fn items(&self) -> f64 {
        self.items
    }

    /// So many items took so many seconds.
    pub fn took(&mut self, items: u64, seconds: f64) {
        let wanted = items as f64 * TARGET / seconds.max(1e-6);
        self.items = wanted.clamp(self.items / 8.0, self.items * 4.0).max(1.0);
    }
}
