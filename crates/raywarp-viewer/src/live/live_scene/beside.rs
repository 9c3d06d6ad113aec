//! What takes long, on a thread of its own.

use std::sync::mpsc::{self, Receiver, TryRecvError};

/// Work under way.
pub struct Beside<T>(Receiver<T>);

/// How far it is.
pub enum Progress<T> {
    Running,
    Done(T),
    /// It ended without a result: it panicked.
    Lost,
}

impl<T: Send + 'static> Beside<T> {
    /// Starts it, with half of the threads: among those that trace frames it would hold a frame up.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Self {
        let (sender, receiver) = mpsc::channel();
        std::thread::spawn(move || {
            let threads = (rayon::current_num_threads() / 2).max(1);
            let result = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
                Ok(pool) => pool.install(work),
                // Without threads of its own it still gets done.
                Err(_) => work(),
            };
            // Whoever asked may be gone.
            let _ = sender.send(result);
        });
        Self(receiver)
    }

    pub fn poll(&self) -> Progress<T> {
        match self.0.try_recv() {
            Ok(result) => Progress::Done(result),
            Err(TryRecvError::Empty) => Progress::Running,
            Err(TryRecvError::Disconnected) => Progress::Lost,
        }
    }
}

/// Takes the result out of its place, if there is one; nothing while it runs.
///
/// # Errors
/// What `lost` gives where the work ended without a result.
pub fn take<T: Send + 'static, E>(place: &mut Option<Beside<T>>, lost: impl FnOnce() -> E) -> Option<Result<T, E>> {
    let result = match place.as_ref()?.poll() {
        Progress::Running => return None,
        Progress::Done(result) => Ok(result),
        Progress::Lost => Err(lost()),
    };
    *place = None;
    Some(result)
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn wait(mut place: Option<Beside<u32>>) -> Result<u32, &'static str> {
        let start = Instant::now();
        loop {
            if let Some(result) = take(&mut place, || "lost") {
                assert!(place.is_none() && take(&mut place, || "lost").is_none());
                return result;
            }
            assert!(start.elapsed() < Duration::from_secs(10));
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn results_come_once_and_panics_are_told() {
        assert_eq!(wait(Some(Beside::start(|| 7))), Ok(7));
        assert_eq!(wait(Some(Beside::start(|| panic!("on purpose")))), Err("lost"));
    }
}
