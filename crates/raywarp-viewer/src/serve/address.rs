//! Where the server listens, and how people get there.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, ToSocketAddrs};

use socket2::{Domain, Socket, Type};

use super::{ServeError, Token};

/// Connections that the system holds until they are taken.
const QUEUE: i32 = 1024;

/// Takes a port; its address is known then even where the system chose it.
pub fn bind(host: &str, port: u16) -> Result<(TcpListener, SocketAddr), ServeError> {
    let unknown = |reason| ServeError::Host { host: host.to_owned(), reason };
    let places: Vec<_> = (host, port).to_socket_addrs().map_err(unknown)?.collect();
    let refused = |reason: io::Error| {
        let host = host.to_owned();
        match reason.kind() {
            io::ErrorKind::AddrInUse => ServeError::PortTaken { host, port },
            io::ErrorKind::AddrNotAvailable => ServeError::Host { host, reason },
            _ => ServeError::Port { host, port, reason },
        }
    };
    let listener = listen(&places).map_err(refused)?;
    let at = listener.local_addr().map_err(refused)?;
    Ok((listener, at))
}

/// Listens at the first place that can be had.
fn listen(places: &[SocketAddr]) -> io::Result<TcpListener> {
    let mut failed = io::Error::from(io::ErrorKind::AddrNotAvailable);
    for &place in places {
        match listen_at(place) {
            Ok(listener) => return Ok(listener),
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

/// As the standard library does, but with a longer queue: what does not fit tries again a second later.
fn listen_at(place: SocketAddr) -> io::Result<TcpListener> {
    let socket = Socket::new(Domain::for_address(place), Type::STREAM, None)?;
    // Elsewhere than on Unix this would let two programs have the same port.
    #[cfg(unix)]
    socket.set_reuse_address(true)?;
    socket.set_nonblocking(true)?;
    socket.bind(&place.into())?;
    socket.listen(QUEUE)?;
    Ok(socket.into())
}

/// What to open in a browser. The ticket is behind the `#`: browsers keep that part to themselves.
pub fn url(at: SocketAddr, ticket: Option<&Token>) -> String {
    let port = at.port();
    let place = match at.ip() {
        ip if ip.is_unspecified() => format!("{}:{port}", machine()),
        _ => at.to_string(),
    };
    let ticket = ticket.map_or(String::new(), |ticket| format!("#ticket={}", ticket.text()));
    format!("http://{place}/{ticket}")
}

/// The command that makes a port of another machine lead here.
pub fn ssh_line(at: SocketAddr) -> String {
    let here = match at.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => SocketAddr::new(Ipv4Addr::LOCALHOST.into(), at.port()),
        IpAddr::V6(ip) if ip.is_unspecified() => SocketAddr::new(Ipv6Addr::LOCALHOST.into(), at.port()),
        _ => at,
    };
    let user = std::env::var("USER").ok().filter(|name| is_plain(name));
    format!("ssh -N -L {}:{here} {}@{}", at.port(), user.as_deref().unwrap_or("USER"), machine())
}

/// This machine's name, if it tells.
fn machine() -> String {
    let told = std::fs::read_to_string("/proc/sys/kernel/hostname").ok().or_else(|| std::env::var("HOSTNAME").ok());
    let name = told.map(|name| name.trim().to_owned()).filter(|name| is_plain(name));
    name.unwrap_or_else(|| "THIS-MACHINE".to_owned())
}

/// Whether a name can stand in a command and an address as it is.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte))
}

/// Whether a request that names this `Host` and comes from a page of this `Origin` is the user's own.
///
/// Without a token, only the names of loopback count: a foreign name that leads here (DNS rebinding) is another page's
/// doing. And a page may only speak to where it came from. What has no `Origin` is no page.
pub fn is_own(host: Option<&str>, origin: Option<&str>, any_name: bool) -> bool {
    let Some(host) = host.map(str::to_ascii_lowercase) else { return false };
    if !any_name && !is_loopback(&host) {
        return false;
    }
    let Some(origin) = origin.map(str::to_ascii_lowercase) else { return true };
    let (plain, secure) = (origin.strip_prefix("http://"), origin.strip_prefix("https://"));
    let is = |from: Option<&str>, port: &str| {
        from.is_some_and(|from| from.strip_suffix(port).unwrap_or(from) == host.strip_suffix(port).unwrap_or(&host))
    };
    is(plain, ":80") || is(secure, ":443")
}

fn is_loopback(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
    let is_address = bare.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback());
    is_address || name == "localhost" || name.ends_with(".localhost")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_pages_pass_and_foreign_ones_do_not() {
        for host in ["localhost:8787", "127.0.0.1:8787", "127.9.9.9", "[::1]:9000", "LOCALHOST", "a.localhost:1"] {
            assert!(is_own(Some(host), None, false), "{host}");
            assert!(is_own(Some(host), Some(&format!("http://{host}")), false), "{host}");
        }
        for host in ["evil.example:8787", "localhost.evil.example", "127.0.0.1.evil.example", "10.0.0.1:8787", "", "::"]
        {
            assert!(!is_own(Some(host), None, false), "{host}");
            assert!(is_own(Some(host), None, true), "{host}");
        }
        for origin in ["http://evil.example", "null", "http://localhost:1", "file://", "", "http://localhost:8787.evil"]
        {
            assert!(!is_own(Some("localhost:8787"), Some(origin), true), "{origin}");
        }
        assert!(!is_own(None, None, true));
        assert!(is_own(Some("node7"), Some("https://node7:443"), true));
        assert!(is_own(Some("node7:80"), Some("http://node7"), true));
        assert!(!is_own(Some("node7"), Some("http://node7:443"), true));
    }

    #[test]
    fn addresses_are_what_a_browser_and_a_shell_take() {
        let at = |text: &str| text.parse::<SocketAddr>().unwrap();
        let ticket = Token::random().unwrap();
        assert_eq!(url(at("127.0.0.1:8787"), None), "http://127.0.0.1:8787/");
        assert_eq!(url(at("[::1]:80"), Some(&ticket)), format!("http://[::1]:80/#ticket={}", ticket.text()));
        assert!(!url(at("0.0.0.0:8787"), None).contains("0.0.0.0"));
        assert!(ssh_line(at("0.0.0.0:8787")).starts_with("ssh -N -L 8787:127.0.0.1:8787 "));
        assert!(ssh_line(at("[::]:8787")).starts_with("ssh -N -L 8787:[::1]:8787 "));
        assert!(ssh_line(at("10.1.2.3:9")).starts_with("ssh -N -L 9:10.1.2.3:9 "));
    }

    #[test]
    fn a_taken_port_is_told() {
        let (_held, at) = bind("127.0.0.1", 0).unwrap();
        let error = bind("127.0.0.1", at.port()).unwrap_err();
        assert!(matches!(error, ServeError::PortTaken { .. }), "{error}");
        assert!(matches!(bind("no such host", 0), Err(ServeError::Host { .. })));
        assert!(matches!(bind("192.0.2.1", 0), Err(ServeError::Host { .. })));
    }
}
