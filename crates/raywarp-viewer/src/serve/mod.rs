//! The viewer in a browser: a server for one scene, with its page inside.
//!
//! One thread, the `render_thread`, owns the [`LiveScene`] and renders for every client in turn. Each client has a task for its
//! WebSocket, and the two meet in a `client`: input one way, pictures and state the other, neither ever more than a
//! few items. Pictures are cut in `stripes` and encoded beside the render thread. `protocol` says what goes over the
//! wire; the page is its other side.

mod address;
mod client;
mod connections;
mod encoder;
mod error;
mod files;
mod http;
mod inbox;
mod input;
mod invitations;
mod outbox;
mod pace;
mod protocol;
mod quality;
mod registry;
mod render_thread;
mod session;
mod socket;
mod stripes;
mod token;

use std::net::{SocketAddr, TcpListener};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::Arc;
use std::time::Duration;

pub use error::ServeError;
pub use invitations::Addresses;
pub use protocol::VERSION as PROTOCOL;
pub use stripes::{messages, Coding, StripeError};
pub use token::Token;

use crate::live::LiveScene;
use invitations::Invitations;
use registry::{ClientRegistry, Ending};

/// Longest time that the end waits for clients to have heard of it.
const PARTING: Duration = Duration::from_millis(100);

/// How to serve.
#[derive(Clone, Debug)]
pub struct ServeOptions {
    /// Address to listen at: an IP address, or a name of this machine.
    pub host: String,
    /// Port; 0 lets the system choose.
    pub port: u16,
    /// What clients must know. Needed unless the address is loopback.
    pub token: Option<Token>,
    /// Most clients at a time, at least 1.
    pub viewers: usize,
    /// Most connections that have not become a client's: requests, idle ones, and sockets without a greeting, at least 1.
    /// One more closes another. A browser opens six.
    pub connections: usize,
    /// How long to wait for clients.
    pub patience: Patience,
}

impl Default for ServeOptions {
    fn default() -> Self {
        let (host, patience) = ("127.0.0.1".to_owned(), Patience::default());
        // Most systems give a process 1024 files.
        Self { host, port: 8787, token: None, viewers: 64, connections: 512, patience }
    }
}

/// How long to wait for clients before they are dropped.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// For the head of a request, the wait for its first byte included.
    pub head: Duration,
    /// For all HTTP requests of a connection; then it is closed.
    pub request: Duration,
    /// For the greeting on a WebSocket.
    pub hello: Duration,
    /// For any sign of life of a client.
    pub silence: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        let seconds = Duration::from_secs;
        Self { head: seconds(5), request: seconds(20), hello: seconds(5), silence: seconds(15) }
    }
}

/// A server that holds its port and does not answer yet.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    at: SocketAddr,
    options: ServeOptions,
    registry: Arc<ClientRegistry>,
    invitations: Arc<Invitations>,
}

impl Server {
    /// Takes the port. A token is made where one is needed and none is given.
    ///
    /// # Errors
    /// [`ServeError`] where the address is none of this machine's or the port is taken.
    pub fn bind(mut options: ServeOptions) -> Result<Self, ServeError> {
        let (listener, at) = address::bind(&options.host, options.port)?;
        if options.token.is_none() && !at.ip().is_loopback() {
            options.token = Some(Token::random()?);
        }
        let registry = Arc::new(ClientRegistry::new(options.viewers.max(1)));
        let invitations = Arc::new(Invitations::new(at, options.token.is_some())?);
        Ok(Self { listener, at, options, registry, invitations })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.at
    }

    /// What to open in a browser. With a token, each address holds a ticket that can be used once: see
    /// [`tell_addresses`](Self::tell_addresses).
    pub fn addresses(&self) -> Addresses {
        self.invitations.addresses()
    }

    /// Has the next addresses told whenever a ticket was used, on a thread of the server; the first call counts.
    pub fn tell_addresses(&self, tell: impl Fn(&Addresses) + Send + Sync + 'static) {
        self.invitations.tell(Box::new(tell));
    }

    /// The command that brings the port to another machine, for people to run there.
    pub fn ssh_line(&self) -> String {
        address::ssh_line(self.at)
    }

    /// Something that ends [`run`](Self::run) from any thread.
    pub fn stopper(&self) -> Stopper {
        Stopper(Arc::clone(&self.registry))
    }

    /// Serves until it is stopped or something fails. The live scene is opened on this thread and stays on it; clients are
    /// answered meanwhile, and told how it ended.
    ///
    /// # Errors
    /// [`ServeError`] where the scene cannot be read, the device fails, or rendering panics.
    pub fn run(self, open: impl FnOnce() -> LiveScene) -> Result<(), ServeError> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("raywarp-serve")
            .enable_all()
            .build()
            .map_err(ServeError::Threads)?;
        let listener = {
            let _inside = runtime.enter();
            tokio::net::TcpListener::from_std(self.listener).map_err(ServeError::Threads)?
        };
        let Self { registry, options, invitations, .. } = self;
        let state = http::AppState::new(Arc::clone(&registry), options, invitations);
        runtime.spawn(http::listen(listener, Arc::new(state)));
        let done = shielded(|| render_thread::run(open(), &registry));
        registry.end(Ending::of(&done));
        runtime.block_on(registry.wait_until_empty(PARTING));
        runtime.shutdown_timeout(PARTING / 2);
        done
    }
}

/// What `work` gives, or an error if it panics.
fn shielded(work: impl FnOnce() -> Result<(), ServeError>) -> Result<(), ServeError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(ToString::to_string);
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Err(ServeError::Panic(text.unwrap_or_else(|| "no message".to_owned())))
    })
}

/// Ends a server.
#[derive(Clone, Debug)]
pub struct Stopper(Arc<ClientRegistry>);

impl Stopper {
    /// Tells the clients, lets the picture that is being rendered finish, and ends.
    pub fn stop(&self) {
        self.0.stop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_the_render_thread_is_an_error() {
        assert!(shielded(|| Ok(())).is_ok());
        let error = shielded(|| panic!("no {}", "pixels")).unwrap_err();
        assert!(matches!(&error, ServeError::Panic(text) if text == "no pixels"), "{error}");
        let error = shielded(|| std::panic::panic_any(1)).unwrap_err();
        assert!(error.to_string().contains("no message"), "{error}");
    }
}
