//! Bands that a device has been told and that nobody has waited for yet.

use std::collections::VecDeque;

use raywarp_device::kernels::Timed;

use super::bands::{Band, Bands};
use super::Progress;
use crate::device::DeviceError;

/// Bands under way at most: a GPU is told the next one while it is at one, so that it never waits for the host, and no more,
/// so that a picture that nobody wants any more is left within two launches. A CPU is done when it was told.
const AHEAD_ON_GPU: usize = 2;

/// Launches of a picture, in order.
pub(super) struct BandQueue<'a> {
    bands: Bands,
    under_way: VecDeque<(Band, Timed)>,
    most: usize,
    progress: &'a mut dyn FnMut(Progress),
    /// Seconds that the kernels ran, of those that were waited for.
    pub kernel_seconds: f64,
    /// Kernels launched.
    pub launches: u32,
}

impl<'a> BandQueue<'a> {
    pub fn new(bands: Bands, is_gpu: bool, progress: &'a mut dyn FnMut(Progress)) -> Self {
        let most = if is_gpu { AHEAD_ON_GPU } else { 1 };
        Self { bands, under_way: VecDeque::new(), most, progress, kernel_seconds: 0.0, launches: 0 }
    }

    /// The band to launch next, once there is room for it; when there is none, all are done.
    pub fn next(&mut self) -> Result<Option<Band>, DeviceError> {
        while self.under_way.len() >= self.most {
            self.wait()?;
        }
        let next = self.bands.next();
        while next.is_none() && !self.under_way.is_empty() {
            self.wait()?;
        }
        Ok(next)
    }

    /// The launch of a band.
    pub fn push(&mut self, band: Band, launch: Timed) {
        self.under_way.push_back((band, launch));
        self.launches += 1;
    }

    /// Waits for the first of them.
    fn wait(&mut self) -> Result<(), DeviceError> {
        let Some((band, launch)) = self.under_way.pop_front() else { return Ok(()) };
        let seconds = launch.wait()?;
        self.kernel_seconds += seconds;
        self.bands.took(&band, seconds);
        (self.progress)(Progress { done: self.bands.done(), total: self.bands.total() });
        Ok(())
    }
}
