//! What to do about an error of the libraries, who know what is wrong but not that they serve a command line.

use std::error::Error;
use std::io;

use raywarp::accel::{BuildError, Unhittable};
use raywarp::device::DeviceError;
use raywarp::device_scene::SceneError;
use raywarp::image::ImageError;
use raywarp::query::QueryError;
use raywarp::render::RenderError;
use raywarp::scene::{LoadError, UnknownCamera};
use raywarp::write::WriteError;
use raywarp_viewer::serve::ServeError;
use raywarp_viewer::ViewerError;

use crate::failure::Exit;

/// An error for someone at a command line.
pub trait Advise: Error {
    /// What to do, as the rest of a sentence; none where the error says it all.
    fn advice(&self) -> Option<String> {
        None
    }

    /// What the shell is told.
    fn exit(&self) -> Exit {
        Exit::Usage
    }
}

fn some(advice: &str) -> Option<String> {
    Some(advice.to_owned())
}

impl Advise for DeviceError {
    fn advice(&self) -> Option<String> {
        some(match self {
            Self::NoDriver => "install NVIDIA's driver, in a container run with --gpus all, or use --device cpu",
            Self::Driver { .. } => "`nvidia-smi` may say more, and --device cpu works without it",
            Self::NoDevice => "check `nvidia-smi` and CUDA_VISIBLE_DEVICES, or use --device cpu",
            Self::NoSuchDevice { .. } => "`raywarp doctor` lists them",
            Self::TooOld { .. } => "use another GPU, or --device cpu",
            Self::Ptx { .. } => "update the driver, or use --device cpu",
            Self::Memory { .. } => "take a smaller scene or picture, or another device",
            Self::TooMany { .. } => "split the scene",
            _ => return None,
        })
    }

    fn exit(&self) -> Exit {
        Exit::Device
    }
}

impl Advise for LoadError {
    fn advice(&self) -> Option<String> {
        match self {
            Self::Named { error, .. } => error.advice(),
            Self::Strict(_) => some("without --strict it is a warning"),
            _ => None,
        }
    }
}

impl Advise for Unhittable {
    fn advice(&self) -> Option<String> {
        some("mend the scene or leave --strict out")
    }
}

impl Advise for UnknownCamera {
    fn advice(&self) -> Option<String> {
        if self.names.is_empty() {
            some("leave --camera out, or give --eye")
        } else {
            None
        }
    }
}

impl Advise for RenderError {
    fn advice(&self) -> Option<String> {
        match self {
            Self::Camera { .. } => some("give --eye and --target, two different finite points, and --fov"),
            Self::Device(error) => error.advice(),
            _ => None,
        }
    }

    fn exit(&self) -> Exit {
        if let Self::Device(error) = self {
            error.exit()
        } else {
            Exit::Usage
        }
    }
}

/// Errors that are about the device, or about what they say.
macro_rules! of_the_device {
    ($($error:ty),* $(,)?) => {$(
        impl Advise for $error {
            fn advice(&self) -> Option<String> {
                let Self::Device(error) = self else { return None };
                error.advice()
            }

            fn exit(&self) -> Exit {
                if let Self::Device(error) = self {
                    error.exit()
                } else {
                    Exit::Usage
                }
            }
        }
    )*};
}

of_the_device!(BuildError, SceneError, QueryError);

impl Advise for ImageError {
    fn advice(&self) -> Option<String> {
        let Self::UnknownExtension(_) = self else { return None };
        some("give one of these endings, or '-' for PNG to standard output")
    }
}

impl Advise for WriteError {
    fn advice(&self) -> Option<String> {
        some(match self {
            Self::Directory(_) => "give a file name inside it",
            Self::NoDirectory { .. } => "create it first",
            Self::Denied { .. } => "choose a directory that you may write to",
            Self::Full { .. } => "make room or choose another disk",
            Self::Read { .. } | Self::Exists(_) => "give another name",
            Self::Twice { .. } => "give each its own",
            _ => return None,
        })
    }

    fn exit(&self) -> Exit {
        if self.is_broken_pipe() {
            Exit::ReaderGone
        } else {
            Exit::Usage
        }
    }
}

impl Advise for ViewerError {
    fn advice(&self) -> Option<String> {
        match self {
            Self::Load(error) => error.advice(),
            Self::Render(error) => error.advice(),
            Self::Device(error) => error.advice(),
            Self::Camera(error) => error.advice(),
            Self::Unhittable(error) => error.advice(),
            Self::Image(error) => error.advice(),
            _ => None,
        }
    }

    fn exit(&self) -> Exit {
        match self {
            Self::Render(error) => error.exit(),
            Self::Device(error) => error.exit(),
            _ => Exit::Usage,
        }
    }
}

impl Advise for ServeError {
    fn advice(&self) -> Option<String> {
        match self {
            Self::Host { .. } => some("give one as --host 127.0.0.1, or 0.0.0.0 for all"),
            Self::PortTaken { .. } => {
                some("perhaps by another `raywarp serve`: give another with --port, or --port 0 for any that is free")
            }
            Self::Port { .. } => some("give another --port or --host"),
            Self::Viewer(error) => error.advice(),
            _ => None,
        }
    }

    fn exit(&self) -> Exit {
        if let Self::Viewer(error) = self {
            error.exit()
        } else {
            Exit::Usage
        }
    }
}

impl Advise for io::Error {
    fn exit(&self) -> Exit {
        if self.kind() == io::ErrorKind::BrokenPipe {
            Exit::ReaderGone
        } else {
            Exit::Usage
        }
    }
}

/// Errors that say it all.
macro_rules! without_advice {
    ($($error:ty),* $(,)?) => { $(impl Advise for $error {})* };
}

without_advice!(
    raywarp::accel::UnknownKind,
    raywarp::query::files::RayFileError,
    raywarp_viewer::serve::StripeError,
    gif::EncodingError,
    png::EncodingError,
    rayon::ThreadPoolBuildError,
    serde_json::Error,
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure::Failure;

    #[test]
    fn a_device_that_fails_is_told_by_the_exit_code_and_with_advice_however_deep_it_is() {
        let device = || DeviceError::NoDevice;
        let failures = [
            Failure::from(device()),
            RenderError::from(device()).into(),
            SceneError::from(device()).into(),
            SceneError::from(BuildError::from(device())).into(),
            BuildError::from(device()).into(),
            QueryError::from(device()).into(),
            ViewerError::from(device()).into(),
            ServeError::from(ViewerError::from(RenderError::from(device()))).into(),
        ];
        for failure in failures {
            assert_eq!(failure.exit(), Exit::Device);
            assert!(failure
                .to_string()
                .ends_with("finds no GPU; check `nvidia-smi` and CUDA_VISIBLE_DEVICES, or use --device cpu"));
        }
        assert_eq!(Failure::from(ViewerError::Lost("reading")).exit(), Exit::Usage);
    }
}
