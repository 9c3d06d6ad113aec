//! What can go wrong with a server.

use std::io;

use crate::ViewerError;

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The host is no address.
    #[error("'{host}' is no address of this machine: {reason}")]
    Host {
        /// As it was given.
        host: String,
        /// The system's words.
        reason: io::Error,
    },
    /// Somebody else has the port.
    #[error("port {port} of {host} is taken")]
    PortTaken {
        /// The host.
        host: String,
        /// The port.
        port: u16,
    },
    /// The system does not give the port.
    #[error("cannot listen at port {port} of {host}: {reason}")]
    Port {
        /// The host.
        host: String,
        /// The port.
        port: u16,
        /// The system's words.
        reason: io::Error,
    },
    /// A token that cannot be used.
    #[error(
        "a token has 8 to 128 characters, none of them a control character, and no space at either end; this has {0}"
    )]
    Token(String),
    /// The system has no random numbers.
    #[error("the system gives no random numbers for a token: {0}")]
    Random(getrandom::Error),
    /// The threads of the server cannot be started.
    #[error("cannot start the threads of the server: {0}; the limit of processes may be reached")]
    Threads(io::Error),
    /// Rendering fails.
    #[error(transparent)]
    Viewer(#[from] ViewerError),
    /// Rendering panicked.
    #[error("rendering stopped by a defect of raywarp: {0}; please report it with the scene and what was done last")]
    Panic(String),
}
