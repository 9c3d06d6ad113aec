//! From an error to a sentence and an exit code.

use std::process::ExitCode;

use raywarp::device::DeviceError;
use raywarp::query::QueryError;
use raywarp::render::RenderError;
use raywarp::write::WriteError;
use raywarp_viewer::serve::ServeError;
use raywarp_viewer::ViewerError;

use crate::{messages, serve};

/// A usage or scene error, or a picture that cannot be written.
const USAGE: u8 = 2;
/// No such device, or one that fails.
const DEVICE: u8 = 3;

/// Says what went wrong and returns what the shell is told. That a reader left early is no failure.
pub fn exit_code(error: &anyhow::Error) -> ExitCode {
    if error.chain().any(is_broken_pipe) {
        return ExitCode::SUCCESS;
    }
    messages::line(&format!("error: {}", sentence(error)));
    ExitCode::from(if error.chain().any(is_of_device) { DEVICE } else { USAGE })
}

/// Says what is wrong with the options, or shows the help that they ask for.
pub fn of_options(error: &clap::Error) -> ExitCode {
    let Some(sentence) = serve::advise(error) else { error.exit() };
    messages::line(&format!("error: {sentence}"));
    ExitCode::from(USAGE)
}

/// The error and its causes, without those that an error above them has quoted already.
fn sentence(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

fn is_broken_pipe(cause: &(dyn std::error::Error + 'static)) -> bool {
    let is_broken = |error: &std::io::Error| error.kind() == std::io::ErrorKind::BrokenPipe;
    cause.downcast_ref().is_some_and(is_broken) || cause.downcast_ref().is_some_and(WriteError::is_broken_pipe)
}

fn is_of_device(cause: &(dyn std::error::Error + 'static)) -> bool {
    cause.is::<DeviceError>()
        || matches!(cause.downcast_ref(), Some(RenderError::Device(_)))
        || matches!(cause.downcast_ref(), Some(error) if is_viewers_device(error))
        || matches!(cause.downcast_ref(), Some(ServeError::Viewer(error)) if is_viewers_device(error))
        || matches!(cause.downcast_ref(), Some(QueryError::Device(_)))
}

fn is_viewers_device(error: &ViewerError) -> bool {
    matches!(error, ViewerError::Device(_) | ViewerError::Render(RenderError::Device(_)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_fails_under_a_viewer_is_a_device_error() {
        let of_device = |error: ServeError| anyhow::Error::from(error).chain().any(is_of_device);
        let device = || DeviceError::NoDevice;
        assert!(of_device(ViewerError::Device(device()).into()));
        assert!(of_device(ViewerError::Render(RenderError::Device(device())).into()));
        assert!(!of_device(ViewerError::Lost("reading").into()));
        assert!(anyhow::Error::from(ViewerError::Device(device())).chain().any(is_of_device));
    }

    #[test]
    fn no_cause_is_said_twice() {
        let error = anyhow::anyhow!("disk on fire").context("cannot read a.obj: disk on fire").context("no scene");
        assert_eq!(sentence(&error), "no scene: cannot read a.obj: disk on fire");
    }
}
