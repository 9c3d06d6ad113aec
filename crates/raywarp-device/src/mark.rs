//! Points in what a device is told, to wait for and to take the time by.

use std::time::Instant;

use crate::kernels::Launchable;
use crate::{cuda, Device, DeviceError, Stream};

/// A point in the order of what a device or a stream has been told.
#[derive(Debug)]
pub struct Mark(Point);

#[derive(Debug)]
pub(crate) enum Point {
    /// On the CPU all was done when it was made.
    Passed(Instant),
    Cuda(cuda::CudaMark),
}

impl Mark {
    pub(crate) fn new(point: Point) -> Self {
        Self(point)
    }

    /// Waits until all that was told before has been done.
    ///
    /// # Errors
    /// [`DeviceError`] where a kernel failed.
    pub fn wait(&self) -> Result<(), DeviceError> {
        match &self.0 {
            Point::Passed(_) => Ok(()),
            Point::Cuda(mark) => mark.wait(),
        }
    }

    /// Waits, and returns the seconds since an earlier mark of the same device or stream.
    ///
    /// # Errors
    /// [`DeviceError`] where a kernel failed, or the marks are not of the same device.
    pub fn seconds_since(&self, earlier: &Self) -> Result<f64, DeviceError> {
        self.wait()?;
        match (&self.0, &earlier.0) {
            (Point::Passed(now), Point::Passed(then)) => Ok(now.saturating_duration_since(*then).as_secs_f64()),
            (Point::Cuda(now), Point::Cuda(then)) => now.seconds_since(then),
            _ => Err(DeviceError::OtherDevice { device: "the CPU".to_owned(), what: "marks" }),
        }
    }
}

/// A launch between two marks: for whoever wants to wait for it, or to know the seconds that it took.
#[derive(Debug)]
pub struct Timed {
    start: Mark,
    end: Mark,
}

impl Timed {
    /// Enqueues a kernel with its marks.
    ///
    /// # Safety
    /// As for [`Device::launch`].
    ///
    /// # Errors
    /// [`DeviceError`] where the launch fails.
    pub unsafe fn launch(device: &Device, kernel: &dyn Launchable, extent: [u32; 2]) -> Result<Self, DeviceError> {
        let start = device.mark()?;
        // SAFETY: the caller's promise.
        unsafe { kernel.launch(device, extent) }?;
        Ok(Self { start, end: device.mark()? })
    }

    /// What is enqueued by a function, between two marks.
    ///
    /// # Errors
    /// Those of the function, and where the device fails.
    pub fn around<E: From<DeviceError>>(device: &Device, enqueue: impl FnOnce() -> Result<(), E>) -> Result<Self, E> {
        let start = device.mark()?;
        enqueue()?;
        Ok(Self { start, end: device.mark()? })
    }

    /// The same on a stream, after all that the device was told before.
    ///
    /// # Safety
    /// As for [`Stream::launch`].
    ///
    /// # Errors
    /// [`DeviceError`] where the launch fails.
    pub unsafe fn launch_on(stream: &Stream, kernel: &dyn Launchable, extent: [u32; 2]) -> Result<Self, DeviceError> {
        stream.follow()?;
        let start = stream.mark()?;
        // SAFETY: the caller's promise.
        unsafe { kernel.launch_on(stream, extent) }?;
        Ok(Self { start, end: stream.mark()? })
    }

    /// Waits for the kernel; returns the seconds it took on the device.
    ///
    /// # Errors
    /// [`DeviceError`] where the kernel failed.
    pub fn wait(&self) -> Result<f64, DeviceError> {
        self.end.seconds_since(&self.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DeviceChoice;

    #[test]
    fn marks_of_the_cpu_are_passed_in_order() {
        let device = Device::open(DeviceChoice::Cpu).unwrap();
        let (first, second) = (device.mark().unwrap(), device.stream().unwrap().mark().unwrap());
        assert!(second.seconds_since(&first).unwrap() >= 0.0);
        assert_eq!(first.seconds_since(&second).unwrap(), 0.0);
    }
}
